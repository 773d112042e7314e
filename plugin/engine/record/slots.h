// SPDX-License-Identifier: Apache-2.0
// Slots of pulses in the state: taken by `compute` as pending, made real by `advance`.

#ifndef MUJOCO_IMPACT_ENGINE_RECORD_SLOTS_H_
#define MUJOCO_IMPACT_ENGINE_RECORD_SLOTS_H_

#include <mujoco/mujoco.h>

#include "engine/island/impact.h"
#include "engine/island/island_system.h"
#include "engine/scene/ownership.h"
#include "engine/state/state.h"

namespace mujoco_impact::engine {

// Forgets what an earlier compute of the same step left pending.
void DiscardPending(const mjModel* m, State& state);

// The pulse of an impact, not yet in a slot; `tau` is the time of the row on its path.
Pulse MakePulse(const mjModel* m, const mjData* d, const ContactRow& row, mjtNum tau,
                const Impact& impact, const State& state);

// Whether `number` more pulses fit into the slots.
bool HasRoom(const State& state, int number);

// Puts the pulse into a slot that is not under way, as pending; without one only the records of its
// geoms know of it.
void AddPending(const mjModel* m, const Ownership& ownership, State& state, const Pulse& pulse,
                mjtNum delivered_next);

// Commits the pending pulses and the parts delivered.
void CommitPulses(State& state);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_RECORD_SLOTS_H_
