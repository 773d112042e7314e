// SPDX-License-Identifier: Apache-2.0

#include "engine/state.h"

#include <algorithm>

#include "engine/config.h"
#include "engine/ownership.h"

namespace mujoco_impact::engine {

namespace {

constexpr double kVersion = 1;
constexpr int kHeaderSize = sizeof(Header) / sizeof(mjtNum);
constexpr int kRecordSize = sizeof(GeomRecord) / sizeof(mjtNum);
constexpr int kPulseSize = sizeof(Pulse) / sizeof(mjtNum);

// A row of n balls has n − 1 contacts; two a geom leaves room for overlapping pulses and clusters.
int SlotNumber(int capacity) { return 2 * capacity + 2; }

}  // namespace

int State::Size(int capacity, int nv) {
  return kHeaderSize + capacity * kRecordSize + SlotNumber(capacity) * kPulseSize + 2 * nv;
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
  const int nv = static_cast<int>(m->nv);
  header_ = reinterpret_cast<Header*>(numbers);
  if (header_->version != kVersion || Size(capacity(), nv) != m->plugin_statenum[instance]) {
    Reset(m, numbers, instance);
  }
  Bind(numbers, nv);
}

void State::Bind(mjtNum* numbers, int nv) {
  const int room = capacity();
  records_ = reinterpret_cast<GeomRecord*>(numbers + kHeaderSize);
  mjtNum* pulses = numbers + kHeaderSize + room * kRecordSize;
  pulses_ = reinterpret_cast<Pulse*>(pulses);
  correction_ = pulses + SlotNumber(room) * kPulseSize;
  held_force_ = correction_ + nv;
}

}  // namespace mujoco_impact::engine
