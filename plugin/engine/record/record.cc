// SPDX-License-Identifier: Apache-2.0

#include "engine/record/record.h"

#include <algorithm>

#include "engine/scene/ownership.h"
#include "engine/state/state.h"

namespace mujoco_impact::engine {

namespace {

void AddForce(const mjModel* m, const Ownership& ownership, const Pulse& pulse, mjtNum part,
              State& state) {
  const Vector3 force =
      part * pulse.scale_next * pulse.impulse / m->opt.timestep * PulseDirection(pulse);
  for (int side = 0; side < 2; ++side) {
    const int index = ownership.Index(static_cast<int>(pulse.geom[side]));
    if (index < 0) continue;
    double* sum = state.record(index).force;
    Store(Load(sum) + (side == 0 ? -1.0 : 1.0) * force, sum);
  }
}

}  // namespace

void BeginRecords(State& state) {
  for (int i = 0; i < state.capacity(); ++i) {
    GeomRecord& record = state.record(i);
    record.next = record.last;
    record.partner_next = record.partner;
    record.began_next = record.began;
    mju_zero3(record.force);
  }
}

void RecordOnset(const mjModel* m, const Ownership& ownership, const Pulse& pulse, bool at_once,
                 State& state) {
  const mjtNum clock = state.header().clock;
  for (int side = 0; side < 2; ++side) {
    const int index = ownership.Index(static_cast<int>(pulse.geom[side]));
    if (index < 0) continue;
    GeomRecord& record = state.record(index);
    GeomReading& next = record.next;
    const double partner = pulse.geom[1 - side] + 1;
    if (record.partner_next != partner || record.began_next != clock) {
      next.impulse = next.peak = next.alpha = 0;
      next.count += 1;
      record.partner_next = partner;
      record.began_next = clock;
    }
    next.impulse += pulse.impulse;
    next.peak += pulse.peak;
    next.alpha += pulse.alpha;
    next.largest = std::max(next.largest, next.peak);
  }
  if (at_once) AddForce(m, ownership, pulse, 1, state);
}

void RecordForces(const mjModel* m, int instance, State& state) {
  const Ownership ownership(m, instance);
  for (int i = 0; i < state.slots(); ++i) {
    const Pulse& pulse = state.pulse(i);
    const mjtNum part = pulse.delivered_next - pulse.delivered;
    if (part > 0) AddForce(m, ownership, pulse, part, state);
  }
  for (int i = 0; i < state.capacity(); ++i) {
    GeomRecord& record = state.record(i);
    mju_addToScl3(record.next.total, record.force, m->opt.timestep);
  }
}

void CommitRecords(State& state) {
  for (int i = 0; i < state.capacity(); ++i) {
    GeomRecord& record = state.record(i);
    record.last = record.next;
    record.partner = record.partner_next;
    record.began = record.began_next;
  }
}

}  // namespace mujoco_impact::engine
