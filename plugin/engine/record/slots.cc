// SPDX-License-Identifier: Apache-2.0

#include "engine/record/slots.h"

#include <algorithm>
#include <cstdint>

#include "engine/record/record.h"
#include "law/waveform.h"

namespace mujoco_impact::engine {

namespace {

// One whose bodies still part keeps its slot, though nothing of it is to come: a repeated `compute`
// must find it (silence.h).
bool IsFree(const State& state, const Pulse& pulse) {
  return pulse.serial == 0 ||
         (pulse.serial > 0 && pulse.delivered >= 1 && pulse.parts_until() <= state.header().clock);
}

// A Hertz contact presses harder than the waveform of its impulse and duration.
mjtNum PeakForce(const Impact& impact) {
  return impact.peak > 0 ? impact.peak : law::WaveformHeight(impact.impulse, impact.duration);
}

}  // namespace

void DiscardPending(const mjModel* m, State& state) {
  if (state.header().pending == 0) return;
  state.header().pending = 0;
  state.header().pending_pulses = 0;
  for (int tree = 0; tree < m->ntree; ++tree) state.flight(tree) = {};
  for (int i = 0; i < state.slots(); ++i) {
    Pulse& pulse = state.pulse(i);
    pulse.delivered_next = pulse.delivered;
    pulse.scale_next = pulse.scale;
    pulse.finishing = 0;
    pulse.line_next = pulse.line;
    if (pulse.serial < 0) pulse = Pulse{};
  }
}

Pulse MakePulse(const mjModel* m, const mjData* d, const ContactRow& row, mjtNum tau,
                const Impact& impact, const State& state) {
  Pulse pulse{};
  pulse.onset = state.header().clock + impact.onset;
  pulse.impulse = impact.impulse;
  pulse.alpha = impact.alpha;
  pulse.duration = impact.duration;
  pulse.restitution = impact.restitution;
  pulse.peak = PeakForce(impact);
  pulse.loss = impact.loss;
  pulse.closing = impact.closing;
  pulse.scale = 1;
  Store(row.normal, pulse.line.normal);
  Store(impact.tangent, pulse.tangent);
  for (int side = 0; side < 2; ++side) {
    const BodyPoint& point = row.path.side(side);
    const Vector3 offset = point.position - Load(d->xpos + 3 * point.body);
    Store(RotateBack(d->xmat + 9 * point.body, offset), pulse.point[side]);
    Store(offset, pulse.line.arm[side]);
    pulse.geom[side] = row.contact->geom[side];
  }
  const int second = row.contact->geom[1];
  Store(SurfacePoint(m, second, 1, row.path.SideAt(1, tau), row.normal), pulse.place);
  pulse.scale_next = pulse.scale;
  pulse.line_next = pulse.line;
  return pulse;
}

bool HasRoom(const State& state, int number) {
  for (int i = 0; i < state.slots() && number > 0; ++i) {
    if (IsFree(state, state.pulse(i))) --number;
  }
  return number <= 0;
}

void AddPending(const mjModel* m, const Ownership& ownership, State& state, const Pulse& pulse,
                mjtNum delivered_next) {
  Header& header = state.header();
  header.pending_pulses += 1;
  const double serial = header.count + header.pending_pulses;
  const int slots = state.slots();
  // oldest first: pulses fill the slots in turn, those under way keep theirs
  for (int i = 0; i < slots; ++i) {
    const auto at = static_cast<int64_t>(serial - 1) + i;
    Pulse& slot = state.pulse(static_cast<int>(at % slots));
    if (!IsFree(state, slot)) continue;
    slot = pulse;
    slot.serial = -serial;
    slot.delivered = 0;
    slot.delivered_next = delivered_next;
    RecordOnset(m, ownership, pulse, false, state);
    return;
  }
  RecordOnset(m, ownership, pulse, true, state);
}

void CommitPulses(State& state) {
  Header& header = state.header();
  header.active = 0;
  for (int i = 0; i < state.slots(); ++i) {
    Pulse& pulse = state.pulse(i);
    if (pulse.serial < 0) {
      pulse.serial = -pulse.serial;
      header.pressed_until = std::max(header.pressed_until, pulse.parts_until());
    }
    pulse.finishing = 0;
    pulse.delivered_last = pulse.delivered;
    pulse.delivered = pulse.delivered_next;
    pulse.scale = pulse.scale_next;
    pulse.line = pulse.line_next;
    if (pulse.under_way()) header.active += 1;
  }
  header.count += header.pending_pulses;
  header.pending_pulses = 0;
}

}  // namespace mujoco_impact::engine
