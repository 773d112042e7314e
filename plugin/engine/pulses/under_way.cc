// SPDX-License-Identifier: Apache-2.0

#include "engine/pulses/under_way.h"

#include <algorithm>

#include "engine/pulses/held.h"
#include "engine/pulses/line_of_action.h"
#include "engine/pulses/settled_energy.h"

namespace mujoco_impact::engine {

void DeliverActive(const mjModel* m, mjData* d, const Mobility& mobility, State& state,
                   Delivery& delivery, Scratch& scratch) {
  const Mobility held = HeldNow(m, d, mobility, state, scratch);
  FollowLines(m, d, held, state, scratch);
  mjtNum* row = scratch.Take<mjtNum>(m->nv);
  ForPulsesUnderWay(state, [&](Pulse& pulse) {
    const Share share = ShareOfStep(pulse, state.header().clock, m->opt.timestep);
    pulse.delivered_next = share.delivered_next;
    mju_zero(row, m->nv);
    AddPulseRow(m, d, pulse, pulse.line_next, 1, row);
    mju_addToScl(delivery.impulse, row, share.impulse, m->nv);
    mju_addToScl(delivery.moment, row, share.moment, m->nv);
    mju_addToScl(delivery.second, row, SecondMoment(share, m->opt.timestep), m->nv);
    mju_addToScl(delivery.remaining, row, pulse.remaining(), m->nv);
  });
  for (mjtNum* sum : {delivery.impulse, delivery.moment, delivery.second, delivery.remaining}) {
    held.AddStops(sum, sum, scratch);
  }
}

}  // namespace mujoco_impact::engine
