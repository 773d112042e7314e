// SPDX-License-Identifier: Apache-2.0

#include "engine/silence.h"

#include <cmath>

#include "engine/contact_path.h"
#include "engine/rest.h"

namespace mujoco_impact::engine {

bool IsOnTheMove(const mjModel* m, const mjData* d, const mjContact& contact) {
  return IsOffered(contact) && contact.efc_address >= 0 &&
         std::abs(ClosingSpeed(m, d, contact)) > LargestRestSpeed(m);
}

void Silence(mjData* d, int contact) {
  // a_ref = −k d (pos − margin)
  constexpr mjtNum kOpening = 1e15;  // beyond any acceleration of a sane state [m/s²]
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

void SilenceMoving(const mjModel* m, mjData* d, int instance) {
  if (d->nefc == d->ne) return;
  const Ownership ownership(m, instance);
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    if (IsOnTheMove(m, d, contact) && ownership.Owns(contact)) Silence(d, i);
  }
}

}  // namespace mujoco_impact::engine
