// SPDX-License-Identifier: Apache-2.0
// Contacts that MuJoCo's solver must leave alone in a step.
//
// The solver carries what rests. A contact that closes faster than at rest (rest.h) is an impact
// and ours; one that parts faster exerts no force, though MuJoCo's would: its friction acts while
// bodies overlap, and in the step after an impact they may. Both are made to look open.

#ifndef MUJOCO_IMPACT_ENGINE_SILENCE_H_
#define MUJOCO_IMPACT_ENGINE_SILENCE_H_

#include <mujoco/mujoco.h>

#include "engine/ownership.h"

namespace mujoco_impact::engine {

// Whether the solver acts on an offered contact whose bodies move along its normal faster than at
// rest.
bool IsOnTheMove(const mjModel* m, const mjData* d, const mjContact& contact);

// Makes the solver see the contact with this index as open, however fast it closes.
void Silence(mjData* d, int contact);

// Silences all owned contacts that are on the move.
void SilenceMoving(const mjModel* m, mjData* d, int instance);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_SILENCE_H_
