// SPDX-License-Identifier: Apache-2.0
// Runge-Kutta steps: the forces of the first stage are held for the other three.
//
// MuJoCo computes passive forces four times in an RK4 step, at positions that are not part of the
// motion, and neither saves plugin_state nor says which stage it is in. A later stage shows itself
// by its time, half a step or a step after the first, and by another position or velocity.
//
// Where bodies are in a later stage no impact has happened yet, or only half of it: they may
// overlap deeper than their depth, and MuJoCo's contact would push. Such contacts are silenced,
// unless both bodies were held by contacts of MuJoCo when the step began.

#ifndef MUJOCO_IMPACT_ENGINE_HANDOVER_RUNGE_KUTTA_H_
#define MUJOCO_IMPACT_ENGINE_HANDOVER_RUNGE_KUTTA_H_

#include <mujoco/mujoco.h>

#include "engine/state/state.h"

namespace mujoco_impact::engine {

// Whether this is the second to fourth stage of a step whose first stage has been computed.
bool IsLaterStage(const mjModel* m, const mjData* d, const State& state);

// Remembers this computation as a first stage.
void OpenStage(const mjModel* m, const mjData* d, State& state);

// Notes which geoms MuJoCo's contacts hold in the first stage of a step with impacts.
void NoteCarried(const mjModel* m, const mjData* d, int instance, State& state);

// Adds the force of the first stage, if it had one, and silences contacts that are not real.
void ApplyHeldForce(const mjModel* m, mjData* d, int instance, State& state);

// Whether the step now ending was a Runge-Kutta step. One that mj_step1 and mj_step2 made is not,
// whatever the option says: they integrate with Euler.
inline bool WasRungeKutta(const State& state) { return state.header().later_stages != 0; }

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_HANDOVER_RUNGE_KUTTA_H_
