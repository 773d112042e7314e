// SPDX-License-Identifier: Apache-2.0
// What impacts do to each owned geom: what the sensor reports.
//
// An impact of a geom is with one other geom. Where they touch in several points, as a box does
// that lands on a face, the points that begin in the same step are one impact: their impulses,
// peaks and α are added.

#ifndef MUJOCO_IMPACT_ENGINE_RECORD_H_
#define MUJOCO_IMPACT_ENGINE_RECORD_H_

#include <mujoco/mujoco.h>

namespace mujoco_impact::engine {

class Ownership;
class State;
struct Pulse;

struct GeomReading {
  // the current or last impact
  double impulse;  // Σ P [N s]
  double peak;     // Σ of the largest forces of its points [N]
  double alpha;    // Σ α [-]
  // since reset
  double count;     // impacts
  double total[3];  // ∫ F dt, world frame [N s]
  double largest;   // largest peak [N]
};

struct GeomRecord {
  GeomReading last;  // committed
  double partner;    // the other geom of the last impact, from 1
  double began;      // its step, on the clock [s]
  GeomReading next;  // with the impacts of this step; committed by advance
  double partner_next;
  double began_next;
  double force[3];  // average of this step, world frame [N]
  double carried;   // 1: one of MuJoCo's contacts holds it at the start of the step (runge_kutta.h)
};

// Starts a step in which pulses act.
void BeginRecords(State& state);

// Records the onset of a pulse. One for which there is no slot comes at once: with its force.
void RecordOnset(const mjModel* m, const Ownership& ownership, const Pulse& pulse, bool at_once,
                 State& state);

// Adds what the pulses in slots exert in the step.
void RecordForces(const mjModel* m, int instance, State& state);

void CommitRecords(State& state);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_RECORD_H_
