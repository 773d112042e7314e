// SPDX-License-Identifier: Apache-2.0
// How gravity and joint springs change when bodies are displaced: (∂Q/∂q) u.
//
// An impact in the middle of a step bends the path, so that for the rest of the step the bodies
// feel forces other than the integrator assumed. With the impulse at time s of a step of length h,
// a displacement ΔV (t − s) for t > s adds G ΔV (h − s)²/2 to the velocity, G = ∂a/∂q; the
// integrator adds the effect of its own displacement instead:
//
//   Euler, implicit...   G ΔV h (h − s)/2     half at each end of the step, at the end from q(h)
//   RK4                  G ΔV h²/6            from the path ΔV t²/(2h) of a constant force
//
// The difference, of second order in h, goes into the impulse of the step: (∂Q/∂q) M⁻¹ Jᵀ P times
//
//   −s (h − s)/2         and         (h − s)²/2 − h²/6.
//
// Left out: the change of M, but for that of a tree that falls as a whole, and of
// velocity-dependent forces; both are zero for spheres, and for pendulums of one hinge.

#ifndef MUJOCO_IMPACT_ENGINE_PATH_WEIGHT_GRADIENT_H_
#define MUJOCO_IMPACT_ENGINE_PATH_WEIGHT_GRADIENT_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"

namespace mujoco_impact::engine {

// The factor above as weights of P, P s and P s².
struct PathWeights {
  mjtNum impulse, moment, second;
};
PathWeights DetourWeights(const mjModel* m);

// result += (∂Q/∂q) u, Q the generalized forces of gravity and joint springs (nv each). Only trees
// that u moves are visited.
void AddWeightGradient(const mjModel* m, mjData* d, const mjtNum* u, mjtNum* result);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_PATH_WEIGHT_GRADIENT_H_
