// SPDX-License-Identifier: Apache-2.0
// How soft equality constraints are: R, and the acceleration a_ref that they ask for.
//
//   a_ref = −b J v − k (pos − margin) − J̇ v        k, b by solref and the impedance d by solimp
//   R = (1 − d)/d · A_ii, by MuJoCo's approximation of A_ii unless the flag diagexact is set
//
// The integrator `discrete` takes the spring at the end of the step, which divides both by
// s = 1 + h b + h² k, and adds −h k J v.

#ifndef MUJOCO_IMPACT_ENGINE_SCENE_SOFTNESS_H_
#define MUJOCO_IMPACT_ENGINE_SCENE_SOFTNESS_H_

#include <mujoco/mujoco.h>

namespace mujoco_impact::engine {

// Writes efc_R and efc_aref of the equality constraints as MuJoCo will write them later in the same
// step: a_ref always comes after the passive forces, with `discrete` so does R. `A` is J M⁻¹Jᵀ
// (d->ne × d->ne).
void MakeReferences(const mjModel* m, mjData* d, const mjtNum* A);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_SCENE_SOFTNESS_H_
