// SPDX-License-Identifier: Apache-2.0

#include "engine/handover/runge_kutta.h"

#include <cstdint>
#include <cstring>

#include "engine/handover/silent_rows.h"
#include "engine/scene/ownership.h"

namespace mujoco_impact::engine {

namespace {

// Adds the bits of some numbers to a hash (FNV-1a, a number at a time).
void Hash(const mjtNum* numbers, int count, uint64_t& hash) {
  for (int i = 0; i < count; ++i) {
    const double number = numbers[i] + 0.0;  // -0 is 0
    uint64_t bits;
    std::memcpy(&bits, &number, sizeof bits);
    hash = (hash ^ bits) * 0x100000001b3;
    hash ^= hash >> 32;
  }
}

// A number that two different stages do not share, of all bits of position and velocity. A
// weighted sum of them would not do: it stays as it is for some velocities, such as 2 and -1.
double Fingerprint(const mjModel* m, const mjData* d) {
  uint64_t hash = 0xcbf29ce484222325;
  Hash(d->qpos, m->nq, hash);
  Hash(d->qvel, m->nv, hash);
  return static_cast<double>(hash >> 11);  // as many bits as a double holds
}

// Geoms of others count as held: what matters is the body of ours.
bool IsCarried(const Ownership& ownership, State& state, int geom) {
  const int index = ownership.Index(geom);
  return index < 0 || state.record(index).carried != 0;
}

// Whether the two geoms strike each other in this step.
bool IsStruck(State& state, const mjContact& contact) {
  bool struck = false;
  ForPulsesOfStep(state, [&](const Pulse& pulse) {
    struck = struck || (pulse.geom[0] == contact.geom[0] && pulse.geom[1] == contact.geom[1]);
  });
  return struck;
}

}  // namespace

bool IsLaterStage(const mjModel* m, const mjData* d, const State& state) {
  const Header& header = state.header();
  if (m->opt.integrator != mjINT_RK4 || header.stage_open == 0) return false;
  const mjtNum h = m->opt.timestep;
  const bool later = d->time == header.stage_time + 0.5 * h || d->time == header.stage_time + h;
  return later && Fingerprint(m, d) != header.stage_fingerprint;
}

void OpenStage(const mjModel* m, const mjData* d, State& state) {
  if (m->opt.integrator != mjINT_RK4) return;
  Header& header = state.header();
  header.stage_open = 1;
  header.stage_time = d->time;
  header.stage_fingerprint = Fingerprint(m, d);
  header.later_stages = 0;
}

void NoteCarried(const mjModel* m, const mjData* d, int instance, State& state) {
  if (m->opt.integrator != mjINT_RK4) return;
  const Ownership ownership(m, instance);
  for (int i = 0; i < state.capacity(); ++i) state.record(i).carried = 0;
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    if (!IsTakenOver(ownership, contact) || IsSilent(d, contact)) continue;
    for (const int geom : contact.geom) {
      const int index = ownership.Index(geom);
      if (index >= 0) state.record(index).carried = 1;
    }
  }
}

void ApplyHeldForce(const mjModel* m, mjData* d, int instance, State& state) {
  state.header().later_stages = 1;
  if (state.header().pending == 0) return;
  for (int tree = 0; tree < m->ntree; ++tree) {
    if (state.flight(tree).struck != 0) continue;
    const int begin = m->tree_dofadr[tree];
    mju_addTo(d->qfrc_passive + begin, state.held_force() + begin, m->tree_dofnum[tree]);
  }
  const Ownership ownership(m, instance);
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    if (!IsTakenOver(ownership, contact)) continue;
    const bool real = IsCarried(ownership, state, contact.geom[0]) &&
                      IsCarried(ownership, state, contact.geom[1]) && !IsStruck(state, contact);
    if (!real) Silence(d, i);
  }
}

}  // namespace mujoco_impact::engine
