// SPDX-License-Identifier: Apache-2.0

#include "engine/foresee/gather.h"

#include <algorithm>

#include "engine/foresee/look.h"
#include "engine/foresee/narrow_phase.h"
#include "engine/foresee/silence.h"
#include "engine/scene/tree_kinds.h"

namespace mujoco_impact::engine {

namespace {

// Of a step: as late as a closing may be noticed that the scan of the last step could not see.
constexpr mjtNum kLatest = 0.25;

constexpr mjtNum kFarAway = 1e10;  // [m]

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
  if (-path.GapRate(*tau) <= path.RestSpeed(m, d, *tau)) return false;
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

// Room for the points that pairs may touch in beyond those that they have now.
int RoomForPoints(const mjModel* m, const mjContact* const* contacts, int count) {
  int room = 0;
  for (int k = 0; k < count; ++k) {
    const bool first = k == 0 || !SamePair(*contacts[k - 1], *contacts[k]);
    if (first && !FollowsFromCentres(m, *contacts[k])) room += kMorePoints;
  }
  return room;
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

// Puts a point in place of contact k.
void Replace(const mjModel* m, const mjData* d, const mjContact& point, int k, Gathered& gathered) {
  gathered.found[k] = point;
  gathered.contact[k] = gathered.found + k;
  gathered.anchored[k] = false;
  gathered.relevant[k] = true;
  gathered.due[k] = gathered.near[k] = false;
  gathered.lowest[k] = LowestGap(m, d, point, gathered.mocap, gathered.kick);
}

}  // namespace

bool IsOnPath(const mjModel* m, const mjContact& contact) {
  const auto [first, second] = TreesOf(m, contact).tree;
  return FollowsFromCentres(m, contact) && KeepsInertia(m, first) && KeepsInertia(m, second);
}

int FindPointsAgain(const mjModel* m, mjData* d, const int* position, int count,
                    Gathered& gathered) {
  Scratch scratch(d);
  // what a step asks for covers it; the points of before are better than the end of the process
  if (!scratch.Fits(NarrowPhaseBytes(m))) return 0;
  mjContact* points = scratch.Take<mjContact>(kMostPoints);
  int asked = 0;
  for (int a = 0; a < count; ++a) {
    const int first = position[a];
    mjContact like = *gathered.contact[first];
    if (FollowsFromCentres(m, like) || !CanBeAsked(m, like)) continue;
    bool done = false;
    for (int b = 0; b < a && !done; ++b) done = SamePair(*gathered.contact[position[b]], like);
    if (done) continue;
    ++asked;
    const int known = gathered.count;
    const int number = FindPoints(m, d, like, gathered.farthest, points);
    // a point that is gone is as good as one that is far away
    like.dist = kFarAway;
    int next = 0;
    for (int k = 0; k < known; ++k) {
      if (!SamePair(*gathered.contact[k], like)) continue;
      Replace(m, d, next < number ? points[next] : like, k, gathered);
      ++next;
    }
    for (; next < number && gathered.count < gathered.room; ++next) {
      Replace(m, d, points[next], gathered.count++, gathered);
    }
  }
  return asked;
}

bool AnyMayCloseByPulses(const mjModel* m, mjData* d, const MocapRecord* mocap, mjtNum touch,
                         const mjtNum* kick) {
  const auto may_close = [&](const mjContact& contact) {
    return LowestGap(m, d, contact, mocap, kick) < std::min(-touch, contact.dist);
  };
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    if (!IsOffered(contact)) continue;
    if (may_close(contact)) return true;
    if (IsDoubtful(m, d, i) && AnyFoundAgain(m, d, i, may_close)) return true;
  }
  return false;
}

Gathered GatherContacts(const mjModel* m, mjData* d, const Ownership& ownership, State& state,
                        const mjtNum* kick, Scratch& scratch) {
  const mjContact** owned = scratch.Take<const mjContact*>(d->ncon);
  int count = 0;
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    if (!IsOffered(contact) || !ownership.Owns(contact)) continue;
    if (kick && IsCarried(contact) && !HasPulse(state, contact, false)) continue;
    const ContactTrees trees = TreesOf(m, contact);
    if (trees.tree[0] >= 0 || trees.tree[1] >= 0) owned[count++] = &contact;
  }
  const int room = count + RoomForPoints(m, owned, count);
  const mjContact** contacts = scratch.Take<const mjContact*>(room);
  std::copy_n(owned, count, contacts);
  Gathered gathered{count,
                    room,
                    contacts,
                    room > count ? scratch.Take<mjContact>(room) : nullptr,
                    0,
                    0,
                    state.mocap(),
                    kick,
                    scratch.Take<ContactAnchor>(room),
                    scratch.Take<bool>(room),
                    scratch.Take<mjtNum>(room),
                    scratch.Take<bool>(room),
                    scratch.Take<bool>(room),
                    scratch.Take<bool>(room),
                    scratch.Take<mjtNum>(room)};
  std::fill_n(gathered.anchored, count, false);
  std::fill_n(gathered.relevant, count, true);
  for (int k = 0; k < count; ++k) {
    const mjContact& contact = *owned[k];
    gathered.lowest[k] = LowestGap(m, d, contact, state.mocap(), kick);
    // what closed late is looked for where it was before the step
    const mjtNum back = kLatest * (contact.dist - gathered.lowest[k]);
    gathered.farthest = std::max(gathered.farthest, contact.dist + back);
  }
  for (int k = 0; k < count; ++k) {
    const int i = static_cast<int>(owned[k] - d->contact);
    if (IsDoubtful(m, d, i)) gathered.asked += FindPointsAgain(m, d, &k, 1, gathered);
  }
  return gathered;
}

const ContactAnchor& Anchor(const mjModel* m, const mjData* d, Gathered& gathered, int k) {
  if (!gathered.anchored[k]) {
    gathered.anchor[k] = AnchorContact(m, d, *gathered.contact[k]);
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

bool FindDue(const mjModel* m, mjData* d, const Outlook& outlook, mjtNum touch, const mjtNum* busy,
             Gathered& gathered) {
  Scratch scratch(d);
  Motion settled = outlook.motion;
  if (outlook.arrears) settled.velocity = SettledVelocity(m, outlook, 0, scratch);
  const mjtNum at_rest = LargestRestSpeed(m, d);
  bool any = false;
  for (int k = 0; k < gathered.count; ++k) {
    const mjContact& contact = *gathered.contact[k];
    gathered.due[k] = false;
    if (!gathered.relevant[k]) continue;
    // the bodies are still where MuJoCo found the contact: its velocities tell, and the pulses'
    if (outlook.start == 0 && gathered.lowest[k] >= -touch &&
        !MayClose(m, contact, ClosingSpeed(m, d, contact, gathered.mocap), at_rest, touch))
      continue;
    const mjtNum since = FreeSince(m, contact, busy) - outlook.start;
    mjtNum tau;
    if (!IsDue(m, d, outlook, settled, touch, since, Anchor(m, d, gathered, k), &tau)) continue;
    gathered.tau[k] = tau;
    gathered.due[k] = any = true;
  }
  return any;
}

}  // namespace mujoco_impact::engine
