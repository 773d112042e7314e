// SPDX-License-Identifier: Apache-2.0

#include "engine/state/state.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "engine/scene/config.h"
#include "engine/scene/ownership.h"

namespace mujoco_impact::engine {

namespace {

constexpr double kVersion = 4;
constexpr int kHeaderSize = sizeof(Header) / sizeof(mjtNum);
constexpr int kRecordSize = sizeof(GeomRecord) / sizeof(mjtNum);
constexpr int kPulseSize = sizeof(Pulse) / sizeof(mjtNum);
constexpr int kFlightSize = sizeof(FlightRecord) / sizeof(mjtNum);
constexpr int kMocapSize = sizeof(MocapRecord) / sizeof(mjtNum);

// A row of n balls has n − 1 contacts; four a geom leave room for overlapping pulses and clusters,
// and for pulses that have come but press on.
constexpr int kSlotsPerGeom = 4;
int SlotNumber(int capacity) { return kSlotsPerGeom * capacity + 2; }

// Geoms for which a state of this size has room. What is read is bound by this alone, whatever the
// header says.
int CapacityOf(const mjModel* m, int size) {
  return (size - State::Size(m, 0)) / (kRecordSize + kSlotsPerGeom * kPulseSize);
}

// Pulses that a simulation may have; serial numbers stay exact in doubles far beyond.
constexpr double kMaxCount = 1e15;

bool IsCount(double number, double most) {
  // the conversion is exact up to kMaxCount, and cheaper than rounding
  return number >= 0 && number <= most &&
         number == static_cast<double>(static_cast<int64_t>(number));
}

// Whether the header is one that Reset wrote for a state of this capacity, and the steps since.
bool IsHeader(const Header& header, int capacity) {
  return header.version == kVersion && header.capacity == capacity &&
         header.slot_number == SlotNumber(capacity) && header.slot_size == kPulseSize &&
         header.slot_offset == kHeaderSize + capacity * kRecordSize &&
         IsCount(header.count, kMaxCount) && IsCount(header.active, header.slot_number) &&
         IsCount(header.pending_pulses, kMaxCount) && std::isfinite(header.clock) &&
         header.touch >= 0;
}

bool IsGeom(const mjModel* m, double number) {
  return IsCount(number, static_cast<double>(m->ngeom) - 1);
}

// Whether the slot holds nothing, or a pulse between geoms of the model.
bool IsPulse(const mjModel* m, const Pulse& pulse) {
  if (pulse.serial == 0) return true;
  const double* numbers = reinterpret_cast<const double*>(&pulse);
  const bool finite =
      std::all_of(numbers, numbers + kPulseSize, [](double x) { return std::isfinite(x); });
  return finite && IsGeom(m, pulse.geom[0]) && IsGeom(m, pulse.geom[1]) && pulse.duration > 0 &&
         pulse.restitution >= 0;
}

void WarnOfReset() {
  mju_warning(
      "mujoco_impact.waveform: plugin_state is damaged or that of another model; it is reset, and "
      "pulses under way in it are lost");
}

}  // namespace

int State::Size(const mjModel* m, int capacity) {
  const int motion = static_cast<int>(2 * m->nv + m->ntree * kFlightSize + m->nmocap * kMocapSize);
  return kHeaderSize + capacity * kRecordSize + SlotNumber(capacity) * kPulseSize + motion;
}

void State::Reset(const mjModel* m, mjtNum* plugin_state, int instance) {
  std::fill_n(plugin_state, m->plugin_statenum[instance], 0.0);
  const int capacity = OwnedCapacity(m, instance);
  auto* header = reinterpret_cast<Header*>(plugin_state);
  header->version = kVersion;
  header->slot_offset = kHeaderSize + capacity * kRecordSize;
  header->slot_size = kPulseSize;
  header->slot_number = SlotNumber(capacity);
  header->touch = ReadConfig(m, instance, 0, nullptr).touch;
  header->capacity = capacity;
}

State::State(const mjModel* m, mjData* d, int instance) {
  mjtNum* numbers = d->plugin_state + m->plugin_stateadr[instance];
  capacity_ = CapacityOf(m, m->plugin_statenum[instance]);
  header_ = reinterpret_cast<Header*>(numbers);
  records_ = reinterpret_cast<GeomRecord*>(header_ + 1);
  pulses_ = reinterpret_cast<Pulse*>(records_ + capacity_);
  slots_ = SlotNumber(capacity_);
  correction_ = reinterpret_cast<mjtNum*>(pulses_ + slots_);
  held_force_ = correction_ + m->nv;
  flights_ = reinterpret_cast<FlightRecord*>(held_force_ + m->nv);
  mocap_ = m->nmocap > 0 ? reinterpret_cast<MocapRecord*>(flights_ + m->ntree) : nullptr;
  if (IsHeader(*header_, capacity_)) return;
  // all zeros is a state that has not begun
  if (header_->version != 0) WarnOfReset();
  Reset(m, numbers, instance);
}

void State::ResetUnlessSound(const mjModel* m, int instance) {
  const auto is_pulse = [m](const Pulse& pulse) { return IsPulse(m, pulse); };
  if (std::all_of(pulses_, pulses_ + slots(), is_pulse)) return;
  WarnOfReset();
  Reset(m, reinterpret_cast<mjtNum*>(header_), instance);
}

}  // namespace mujoco_impact::engine
