// SPDX-License-Identifier: Apache-2.0

#include "engine/gather.h"

#include "engine/contact_path.h"
#include "engine/islands.h"

namespace mujoco_impact::engine {

bool AnyMayClose(const mjModel* m, const mjData* d, mjtNum touch) {
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    if (IsReleased(contact) && MayClose(m, d, contact, touch)) return true;
  }
  return false;
}

Outlook LookAhead(const mjModel* m, mjData* d, const Delivery& delivery, bool pulses,
                  Scratch& scratch) {
  Outlook outlook{PredictMotion(m, d, scratch), nullptr, nullptr};
  if (!pulses) return outlook;
  outlook.bend = scratch.Take<mjtNum>(m->nv);
  outlook.arrears = scratch.Take<mjtNum>(m->nv);
  mj_solveM(m, d, outlook.bend, delivery.impulse, 1);
  mju_scl(outlook.bend, outlook.bend, 1 / m->opt.timestep, m->nv);
  mju_addTo(outlook.motion.acceleration, outlook.bend, m->nv);
  mj_solveM(m, d, outlook.arrears, delivery.remaining, 1);
  return outlook;
}

mjtNum* SettledVelocity(const mjModel* m, const Outlook& outlook, mjtNum tau, Scratch& scratch) {
  mjtNum* velocity = scratch.Take<mjtNum>(m->nv);
  VelocityOnPath(m, outlook.motion, tau, velocity);
  if (outlook.arrears) {
    // the part that the path already has by τ is not to come again
    mju_addTo(velocity, outlook.arrears, m->nv);
    mju_addToScl(velocity, outlook.bend, -tau, m->nv);
  }
  return velocity;
}

Gathered GatherContacts(const mjModel* m, const mjData* d, const Ownership& ownership, mjtNum touch,
                        const Outlook& outlook, Scratch& scratch) {
  Gathered gathered{0, scratch.Take<int>(d->ncon), scratch.Take<bool>(d->ncon),
                    scratch.Take<mjtNum>(d->ncon)};
  // with pulses under way, a contact that they will part is not an impact
  Motion settled = outlook.motion;
  if (outlook.arrears) settled.velocity = SettledVelocity(m, outlook, 0, scratch);
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    if (!IsReleased(contact) || !ownership.Owns(contact)) continue;
    const ContactTrees trees = TreesOf(m, contact);
    if (trees.tree[0] < 0 && trees.tree[1] < 0) continue;
    const int k = gathered.count++;
    gathered.contact[k] = i;
    gathered.due[k] = MayClose(m, d, contact, touch) &&
                      ContactPath(m, d, contact, outlook.motion)
                          .ClosingTime(m->opt.timestep, touch, &gathered.tau[k]);
    if (gathered.due[k] && outlook.arrears) {
      gathered.due[k] = ContactPath(m, d, contact, settled).GapRate(0) < 0;
    }
  }
  return gathered;
}

}  // namespace mujoco_impact::engine
