// SPDX-License-Identifier: Apache-2.0

#include "engine/gather.h"

#include <algorithm>

#include "engine/islands.h"
#include "engine/silence.h"

namespace mujoco_impact::engine {

namespace {

// Of a step: as late as a closing may be noticed that the scan of the last step could not see.
constexpr mjtNum kLatest = 0.25;

// Whether the contact closes in the rest of the step. Its bodies are on this path since `since`,
// from the time of the outlook [s].
bool IsDue(const mjModel* m, const mjData* d, const Outlook& outlook, const Motion& settled,
           mjtNum touch, mjtNum since, const ContactAnchor& anchor, mjtNum* tau) {
  const mjtNum h = m->opt.timestep, end = h - outlook.start;
  const mjtNum from = std::max<mjtNum>(0, since);
  // later in the step: since they are on it, for the impacts before may have closed it meanwhile
  const mjtNum late = outlook.start == 0 ? kLatest * h : outlook.start;
  const ContactPath path(m, d, anchor, outlook.motion);
  if (!path.ClosingTime(from, end, late, touch, tau)) return false;
  if (outlook.start > 0) *tau = std::max(*tau, since);
  // with pulses under way, a contact that they will part is not an impact
  return !outlook.arrears || ContactPath(m, d, anchor, settled).Closes(0, h, touch);
}

// Until when an impact of this step keeps the bodies of the contact from the path that they are on
// since; a pulse that outlasts the step does not.
mjtNum FreeSince(const mjModel* m, const mjContact& contact, const mjtNum* busy) {
  const mjtNum h = m->opt.timestep;
  mjtNum free = -h;
  for (const int tree : TreesOf(m, contact).tree) {
    if (tree >= 0 && busy[tree] < h) free = std::max(free, busy[tree]);
  }
  return free;
}

// The greatest closing speed of the step, at its start or with what pulses add to it; not negative.
mjtNum FastestClosing(const mjModel* m, const mjData* d, const mjContact& contact,
                      const MocapRecord* mocap, const mjtNum* kick) {
  const mjtNum speed = ClosingSpeed(m, d, contact, mocap);
  if (!kick) return std::max<mjtNum>(0, speed);
  Vector3 added[2];
  for (int i = 0; i < 2; ++i) {
    const BodyPoint point{m->geom_bodyid[contact.geom[i]], Load(contact.pos)};
    added[i] = PointVelocityBy(m, d, point, kick);
  }
  return std::max({mjtNum{0}, speed, speed + Dot(Load(contact.frame), added[0] - added[1])});
}

// Gap that the contact has at least by the end of the step, if nothing strikes [m].
mjtNum LowestGap(const mjModel* m, const mjData* d, const mjContact& contact,
                 const MocapRecord* mocap, const mjtNum* kick) {
  return contact.dist - FastestClosing(m, d, contact, mocap, kick) * m->opt.timestep;
}

}  // namespace

bool AnyMayClose(const mjModel* m, const mjData* d, const MocapRecord* mocap, mjtNum touch) {
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    if (IsReleased(contact) && MayClose(m, d, contact, mocap, touch)) return true;
  }
  return false;
}

bool AnyMayCloseByPulses(const mjModel* m, const mjData* d, const MocapRecord* mocap, mjtNum touch,
                         const mjtNum* kick) {
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    if (!IsReleased(contact) && !IsDeep(contact)) continue;
    if (LowestGap(m, d, contact, mocap, kick) < std::min(-touch, contact.dist)) return true;
  }
  return false;
}

Gathered GatherContacts(const mjModel* m, const mjData* d, const Ownership& ownership, State& state,
                        const mjtNum* kick, Scratch& scratch) {
  const bool pressed = AnyPulsePresses(state);
  int* owned = scratch.Take<int>(d->ncon);
  int count = 0;
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    const bool ours = IsReleased(contact)
                          ? ownership.Owns(contact)
                          : pressed && IsTakenOver(ownership, contact) && HasPulse(state, contact);
    if (!ours) continue;
    const ContactTrees trees = TreesOf(m, contact);
    if (trees.tree[0] >= 0 || trees.tree[1] >= 0) owned[count++] = i;
  }
  Gathered gathered{count,
                    owned,
                    scratch.Take<ContactAnchor>(count),
                    scratch.Take<bool>(count),
                    scratch.Take<mjtNum>(count),
                    scratch.Take<bool>(count),
                    scratch.Take<bool>(count),
                    scratch.Take<bool>(count),
                    scratch.Take<bool>(count),
                    scratch.Take<mjtNum>(count)};
  std::fill_n(gathered.anchored, count, false);
  std::fill_n(gathered.relevant, count, true);
  std::fill_n(gathered.idle, count, false);
  for (int k = 0; k < count; ++k) {
    gathered.lowest[k] = LowestGap(m, d, d->contact[owned[k]], state.mocap(), kick);
  }
  return gathered;
}

const ContactAnchor& Anchor(const mjModel* m, const mjData* d, Gathered& gathered, int k) {
  if (!gathered.anchored[k]) {
    gathered.anchor[k] = AnchorContact(m, d, d->contact[gathered.contact[k]]);
    gathered.anchored[k] = true;
  }
  return gathered.anchor[k];
}

void FindNear(const mjModel* m, const mjData* d, const Outlook& outlook, mjtNum reach,
              Gathered& gathered) {
  const mjtNum time_left = m->opt.timestep - outlook.start;
  for (int k = 0; k < gathered.count; ++k) {
    mjtNum lowest = gathered.lowest[k];
    if (outlook.start > 0 && gathered.relevant[k]) {
      const ContactPath path(m, d, Anchor(m, d, gathered, k), outlook.motion);
      lowest = path.Gap(0) + std::min<mjtNum>(0, path.GapRate(0)) * time_left;
    }
    gathered.near[k] = gathered.due[k] || lowest <= reach;
  }
}

bool FindDue(const mjModel* m, const mjData* d, const Outlook& outlook, mjtNum touch,
             const mjtNum* busy, Gathered& gathered, Scratch& scratch) {
  Motion settled = outlook.motion;
  if (outlook.arrears) settled.velocity = SettledVelocity(m, outlook, 0, scratch);
  bool any = false;
  for (int k = 0; k < gathered.count; ++k) {
    const mjContact& contact = d->contact[gathered.contact[k]];
    gathered.due[k] = false;
    if (!gathered.relevant[k] || gathered.idle[k]) continue;
    // the bodies are still where MuJoCo found the contact: its velocities tell, and the pulses'
    if (outlook.start == 0 && gathered.lowest[k] >= -touch) continue;
    const mjtNum since = FreeSince(m, contact, busy) - outlook.start;
    mjtNum tau;
    if (!IsDue(m, d, outlook, settled, touch, since, Anchor(m, d, gathered, k), &tau)) continue;
    gathered.tau[k] = tau;
    gathered.due[k] = any = true;
  }
  return any;
}

}  // namespace mujoco_impact::engine
