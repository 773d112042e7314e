// SPDX-License-Identifier: Apache-2.0
// Friction in the impacts of an island, off unless the attribute `friction` asks for it.
//
// The law (law/friction.h) gives the tangential impulse Q_k against the slip of contact k. It is
// delivered with the normal one, in the ratio ρ = Q_k / P_k, so the force of the pulse acts along
// n + ρ t instead of n: the rows of the island are changed to that direction, and everything that
// delivers impulses goes on as before.
//
// Equations (7)-(9) know one mass and no rotation, so what they give may speed up a ball that rolls
// off. With `passive` all tangential impulses f = Σ Jᵀ Q are scaled by the largest factor ≤ 1 with
// which they add no kinetic energy to what the normal impulses left:
//
//   s = min(1, −2 fᵀv / (fᵀ M⁻¹ f)),  0 if fᵀv ≥ 0,  v the velocity after the normal impulses

#ifndef MUJOCO_IMPACT_ENGINE_RESOLVE_FRICTION_H_
#define MUJOCO_IMPACT_ENGINE_RESOLVE_FRICTION_H_

#include <mujoco/mujoco.h>

#include <cstddef>

#include "engine/common/scratch.h"
#include "engine/island/island_system.h"
#include "engine/path/motion.h"
#include "engine/resolve/resolve.h"
#include "engine/scene/config.h"

namespace mujoco_impact::engine {

// Bytes of scratch that AddFriction takes, besides the `island` bytes of the island itself.
inline size_t FrictionBytes(const mjModel* m, size_t island) {
  return island + 3 * m->nv * sizeof(mjtNum);
}

// Turns the rows of contacts with an impulse from n to n + ρ t, and notes ρ t in their impacts.
// `velocity` is that of the bodies before the impact, at τ on the path of `motion` (nv).
void AddFriction(const mjModel* m, const mjData* d, const Config& config, const Motion& motion,
                 mjtNum tau, const mjtNum* velocity, IslandSystem& system, Impact* impacts,
                 Scratch& scratch);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_RESOLVE_FRICTION_H_
