// SPDX-License-Identifier: Apache-2.0

#include "engine/silence.h"

#include <cmath>

#include "engine/contact_path.h"
#include "engine/mobility.h"
#include "engine/motion.h"
#include "engine/ownership.h"
#include "engine/rest.h"
#include "engine/scratch.h"

namespace mujoco_impact::engine {

namespace {

constexpr mjtNum kOpening = 1e15;  // beyond any acceleration of a sane state [m/s²]

// Whether an owned contact of the solver moves faster than any that is at rest at least may.
bool IsOnTheMove(const mjModel* m, const mjData* d, const Ownership& ownership,
                 const mjContact& contact) {
  return IsOffered(contact) && contact.efc_address >= 0 &&
         std::abs(ClosingSpeed(m, d, contact)) > SmallestCarriedSpeed(m, d) &&
         ownership.Owns(contact);
}

}  // namespace

void Silence(mjData* d, int contact) {
  // a_ref = −k d (pos − margin)
  const int begin = d->contact[contact].efc_address, type = d->efc_type[begin];
  for (int i = begin; i < d->nefc && d->efc_type[i] == type && d->efc_id[i] == contact; ++i) {
    d->efc_pos[i] = d->efc_margin[i] + 1;
    mjtNum* KBI = d->efc_KBIP + 4 * i;
    KBI[0] = kOpening;
    KBI[1] = 0;
    KBI[2] = 1;
    // the rows that follow are those of friction, which an opening must not drive
    if (type == mjCNSTR_CONTACT_ELLIPTIC) break;
  }
}

bool IsSilent(const mjData* d, const mjContact& contact) {
  return contact.efc_address >= 0 && d->efc_KBIP[4 * contact.efc_address] == kOpening;
}

void SilenceMoving(const mjModel* m, mjData* d, int instance) {
  if (d->nefc == d->ne) return;
  const Ownership ownership(m, instance);
  int first = 0;
  while (first < d->ncon && !IsOnTheMove(m, d, ownership, d->contact[first])) ++first;
  if (first == d->ncon) return;
  // what presses the bodies decides
  Scratch scratch(d);
  const Mobility mobility(m, d, scratch);
  const Motion motion = PredictMotion(m, d, mobility, scratch);
  for (int i = first; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    if (!IsOnTheMove(m, d, ownership, contact)) continue;
    const ContactAnchor anchor = AnchorContact(m, d, contact);
    const ContactPath path(m, d, anchor, motion);
    if (std::abs(ClosingSpeed(m, d, contact)) > path.RestSpeed(m, d, 0)) Silence(d, i);
  }
}

}  // namespace mujoco_impact::engine
