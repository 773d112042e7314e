// SPDX-License-Identifier: Apache-2.0
// How the scene would move through the step if no contact closed.
//
//   a = M⁻¹ (forces − bias)        free acceleration: gravity, springs, dampers, actuators and
//                                  applied forces; M̃⁻¹ and the pull of equality constraints
//                                  (mobility.h); where the integrator takes joint damping B
//                                  implicitly, (M + h B)⁻¹ M ahead
//   V = v + h/2 a                  Euler, implicit, implicitfast, discrete
//   V = v                          RK4
//   b = M⁻¹ (∂Q/∂q) V              its rate, as far as gravity and joint springs make it
//   q(τ) = q ⊕ (V τ + a τ²/2 + b τ³/6)      path within the step, τ from its start
//
// The semi-implicit integrators step q += h (v + h a) = h V + a h²/2: their v lags behind the
// velocity of the path by half a step, and impacts happen on the path.

#ifndef MUJOCO_IMPACT_ENGINE_PATH_MOTION_H_
#define MUJOCO_IMPACT_ENGINE_PATH_MOTION_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/path/mobility.h"
#include "engine/state/mocap.h"

namespace mujoco_impact::engine {

struct Motion {
  mjtNum* velocity;                    // V (nv)
  mjtNum* acceleration;                // a (nv)
  mjtNum* jerk;                        // b (nv)
  const MocapRecord* mocap = nullptr;  // how mocap bodies move meanwhile
};

// Position lag of the integrator in units of h: where within the step it thinks an impulse came
// (0 at the start, 1/2 for Runge-Kutta, which spreads it).
double ImpulseLag(const mjModel* m);

// How far the velocity of MuJoCo's bodies is behind that of their path [s].
mjtNum PathLag(const mjModel* m);

// Whether the integrator divides by M + h B, B the joint damping, instead of M.
bool ImplicitDamping(const mjModel* m);

Motion PredictMotion(const mjModel* m, mjData* d, const Mobility& mobility, Scratch& scratch);

// V + a τ + b τ²/2
void VelocityOnPath(const mjModel* m, const Motion& motion, mjtNum tau, mjtNum* velocity);

// x = M⁻¹ y (nv each, not the same array), zero for trees that sleep: MuJoCo leaves those as they
// are.
void SolveInertia(const mjModel* m, mjData* d, mjtNum* x, const mjtNum* y);

// x ← (M + t B)⁻¹ x, B the damping of the joints (nv).
void SolveDamped(const mjModel* m, const mjData* d, mjtNum time, mjtNum* x, Scratch& scratch);

// Whether MuJoCo has put the tree to sleep: no force moves it in this step.
inline bool IsAsleep(const mjData* d, int tree) { return d->tree_asleep[tree] >= 0; }

// x = M⁻¹ y for y that is zero on most trees, by the inertia of the bodies where they are (nv
// each).
void SolveTouchedTrees(const mjModel* m, const mjData* d, mjtNum* x, const mjtNum* y);

// x ← M⁻¹ x for the degrees of freedom of one kinematic tree; x is the tree's segment.
void SolveTreeInertia(const mjModel* m, const mjData* d, int tree, mjtNum* x);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_PATH_MOTION_H_
