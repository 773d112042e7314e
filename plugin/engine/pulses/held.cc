// SPDX-License-Identifier: Apache-2.0

#include "engine/pulses/held.h"

#include "engine/handover/silent_rows.h"
#include "engine/path/motion.h"
#include "engine/path/stops.h"
#include "engine/pulses/line_of_action.h"

namespace mujoco_impact::engine {

namespace {

// add(Jᵀ P) adds what is yet to come (nv).
template <typename Add>
Mobility HeldAgainst(const mjModel* m, mjData* d, const Mobility& ties, const State& state, Add add,
                     Scratch& scratch) {
  const int nv = static_cast<int>(m->nv);
  mjtNum* none = scratch.Zeros(nv);
  const Motion still{none, none, none};
  Stops stops(m, d, still, scratch);
  if (!stops.Any()) return ties;
  mjtNum *impulse = scratch.Zeros(nv), *change = scratch.Take<mjtNum>(nv);
  add(impulse);
  ties.Solve(change, impulse);
  stops.Look(still, 0);
  stops.FindHeld(ties, d->qvel, change, ActiveEnd(state), false);
  stops.NoteStruck(d->qvel, change);
  stops.ForStruck([d](bool tendon, int id) { SilenceLimit(d, tendon, id); });
  if (!scratch.Fits(Mobility::StopBytes(m, ties, stops))) return ties;
  return Mobility(ties, stops, scratch);
}

}  // namespace

Mobility HeldNow(const mjModel* m, mjData* d, const Mobility& ties, State& state,
                 Scratch& scratch) {
  const auto add = [&](mjtNum* impulse) {
    ForPulsesUnderWay(state, [&](const Pulse& pulse) {
      const mjtNum rest = pulse.scale * pulse.impulse * (1 - pulse.delivered);
      AddPulseRow(m, d, pulse, LineNow(m, d, pulse), rest, impulse);
    });
  };
  return HeldAgainst(m, d, ties, state, add, scratch);
}

Mobility HeldAfter(const mjModel* m, mjData* d, const Mobility& ties, State& state,
                   Scratch& scratch) {
  const auto add = [&](mjtNum* impulse) {
    ForPulsesOfStep(state, [&](const Pulse& pulse) {
      AddPulseRow(m, d, pulse, pulse.line_next, pulse.remaining_next(), impulse);
    });
  };
  return HeldAgainst(m, d, ties, state, add, scratch);
}

}  // namespace mujoco_impact::engine
