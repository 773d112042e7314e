// SPDX-License-Identifier: Apache-2.0

#include "engine/handover/runge_kutta.h"

#include "engine/handover/silent_rows.h"
#include "engine/scene/ownership.h"

namespace mujoco_impact::engine {

namespace {

// A number that two different stages do not share: weighted sum of position and velocity.
mjtNum Fingerprint(const mjModel* m, const mjData* d) {
  mjtNum sum = 0;
  for (int i = 0; i < m->nq; ++i) sum += (i + 1) * d->qpos[i];
  for (int i = 0; i < m->nv; ++i) sum -= (i + 1) * d->qvel[i];
  return sum;
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
