// SPDX-License-Identifier: Apache-2.0

#include "engine/gather.h"

#include "engine/islands.h"

namespace mujoco_impact::engine {

namespace {

// Of a step: as late as a closing may be noticed that the scan of the last step could not see.
constexpr mjtNum kLatest = 0.25;

bool IsDue(const mjModel* m, const mjData* d, const Outlook& outlook, const Motion& settled,
           mjtNum touch, const ContactAnchor& anchor, mjtNum* tau) {
  const mjtNum h = m->opt.timestep;
  const mjtNum late = outlook.start == 0 ? kLatest * h : 0;
  const ContactPath path(m, d, anchor, outlook.motion);
  if (!path.ClosingTime(h - outlook.start, late, touch, tau)) return false;
  // with pulses under way, a contact that they will part is not an impact
  return !outlook.arrears || ContactPath(m, d, anchor, settled).GapRate(0) < 0;
}

}  // namespace

bool AnyMayClose(const mjModel* m, const mjData* d, mjtNum touch) {
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    if (IsReleased(contact) && MayClose(m, d, contact, touch)) return true;
  }
  return false;
}

Gathered GatherContacts(const mjModel* m, const mjData* d, const Ownership& ownership,
                        Scratch& scratch) {
  int* owned = scratch.Take<int>(d->ncon);
  int count = 0;
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    if (!IsReleased(contact) || !ownership.Owns(contact)) continue;
    const ContactTrees trees = TreesOf(m, contact);
    if (trees.tree[0] >= 0 || trees.tree[1] >= 0) owned[count++] = i;
  }
  Gathered gathered{count, owned, scratch.Take<ContactAnchor>(count), scratch.Take<bool>(count),
                    scratch.Take<mjtNum>(count)};
  for (int k = 0; k < count; ++k) {
    gathered.anchor[k] = AnchorContact(m, d, d->contact[owned[k]]);
  }
  return gathered;
}

bool FindDue(const mjModel* m, const mjData* d, const Outlook& outlook, mjtNum touch,
             const mjtNum* busy, Gathered& gathered, Scratch& scratch) {
  Motion settled = outlook.motion;
  if (outlook.arrears) settled.velocity = SettledVelocity(m, outlook, 0, scratch);
  bool any = false;
  for (int k = 0; k < gathered.count; ++k) {
    const mjContact& contact = d->contact[gathered.contact[k]];
    gathered.due[k] = false;
    // the bodies are still where MuJoCo found the contact: its velocities tell
    if (outlook.start == 0 && !MayClose(m, d, contact, touch)) continue;
    mjtNum tau;
    if (!IsDue(m, d, outlook, settled, touch, gathered.anchor[k], &tau)) continue;
    const auto [first, second] = TreesOf(m, contact).tree;
    const mjtNum time = outlook.start + tau;
    if ((first >= 0 && time < busy[first]) || (second >= 0 && time < busy[second])) continue;
    gathered.tau[k] = tau;
    gathered.due[k] = any = true;
  }
  return any;
}

}  // namespace mujoco_impact::engine
