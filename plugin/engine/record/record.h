// SPDX-License-Identifier: Apache-2.0
// What impacts do to each owned geom: what the sensor reports.
//
// An impact of a geom is with one other geom. Where they touch in several points, as a box does
// that lands on a face, the points that begin in the same step are one impact: their impulses,
// peaks and α are added.

#ifndef MUJOCO_IMPACT_ENGINE_RECORD_RECORD_H_
#define MUJOCO_IMPACT_ENGINE_RECORD_RECORD_H_

#include <mujoco/mujoco.h>

namespace mujoco_impact::engine {

class Ownership;
class State;
struct Pulse;

// Starts a step in which pulses act.
void BeginRecords(State& state);

// Records the onset of a pulse. One for which there is no slot comes at once: with its force.
void RecordOnset(const mjModel* m, const Ownership& ownership, const Pulse& pulse, bool at_once,
                 State& state);

// Adds what the pulses in slots exert in the step.
void RecordForces(const mjModel* m, int instance, State& state);

void CommitRecords(State& state);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_RECORD_RECORD_H_
