// SPDX-License-Identifier: Apache-2.0
// Contacts that MuJoCo's solver is to take for open in this step.
//
// The solver carries what rests. A contact that closes faster than at rest (rest.h) is an impact
// and ours; one that parts faster exerts no force, though MuJoCo's would: its friction acts while
// bodies overlap, and in the step after an impact they may. And where a pulse of ours presses,
// MuJoCo's contact must not push besides.

#ifndef MUJOCO_IMPACT_ENGINE_FORESEE_SILENCE_H_
#define MUJOCO_IMPACT_ENGINE_FORESEE_SILENCE_H_

#include <mujoco/mujoco.h>

#include "engine/scene/ownership.h"
#include "engine/state/state.h"

namespace mujoco_impact::engine {

// Whether a pulse between the geoms of the contact presses, or still parts them.
bool HasPulse(const State& state, const mjContact& contact, bool parting);

// Silences the owned contacts in which pulses press and, if any is `moving` (look.h), those whose
// bodies move along the normal faster than at rest.
void SilenceMoving(const mjModel* m, mjData* d, int instance, bool moving, State& state);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_FORESEE_SILENCE_H_
