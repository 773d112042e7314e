// SPDX-License-Identifier: Apache-2.0

#include "engine/deliver/flights.h"

#include "engine/handover/hold.h"
#include "engine/scene/tree_kinds.h"

namespace mujoco_impact::engine {

Flights::Flights(const mjModel* m, mjData* d, const Motion& motion, bool pulses, bool friction,
                 Scratch& scratch) {
  if (pulses) return;
  Hold* held = scratch.Take<Hold>(m->ntree);
  FindHeld(m, d, held);
  rigid_ = RigidFlights(m, d, motion, held, friction, scratch);
  arms_ = ArmFlights(m, d, motion, held, scratch);
}

void Flights::Add(mjData* d, int tree, mjtNum there, mjtNum t, const mjtNum* velocity,
                  const mjtNum* kick, const mjtNum* moment) {
  if (rigid_.Has(tree)) {
    rigid_.Add(d, tree, there, t, velocity, kick, moment);
  } else {
    arms_.Add(d, tree, there, velocity, kick, moment);
  }
}

void Flights::Place(mjData* d, mjtNum t, Motion& path) {
  arms_.Place(d, t, path);
  rigid_.Place(t, d->qpos, d->qvel, path.velocity, path.acceleration);
}

bool Flights::FlyToEnd(mjData* d) { return arms_.FlyToEnd(d); }

void Flights::Finish(const mjModel* m, State& state) {
  for (int tree = 0; tree < m->ntree; ++tree) state.flight(tree) = {};
  rigid_.Finish(state);
  arms_.Finish(state);
}

void CommitFlights(const mjModel* m, mjData* d, State& state) {
  for (int tree = 0; tree < m->ntree; ++tree) {
    const double struck = state.flight(tree).struck;
    if (struck == FlightRecord::kNotStruck) continue;
    if (struck == FlightRecord::kArm) {
      CommitArm(m, d, tree, state);
    } else {
      CommitRigidFlight(m, d, tree, state);
    }
    state.flight(tree) = {};
  }
}

}  // namespace mujoco_impact::engine
