// SPDX-License-Identifier: Apache-2.0
// Contacts that MuJoCo's solver must leave alone in a step.
//
// The solver carries what rests. A contact that closes faster than at rest (rest.h) is an impact
// and ours; one that parts faster exerts no force, though MuJoCo's would: its friction acts while
// bodies overlap, and in the step after an impact they may. Both are made to look open.

#ifndef MUJOCO_IMPACT_ENGINE_SILENCE_H_
#define MUJOCO_IMPACT_ENGINE_SILENCE_H_

#include <mujoco/mujoco.h>

namespace mujoco_impact::engine {

// Silences all owned contacts whose bodies move along the normal faster than at rest.
void SilenceMoving(const mjModel* m, mjData* d, int instance);

// Makes the solver see the contact with this index as open, however fast it closes.
void Silence(mjData* d, int contact);

// Whether that was done.
bool IsSilent(const mjData* d, const mjContact& contact);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_SILENCE_H_
