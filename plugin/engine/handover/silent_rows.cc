// SPDX-License-Identifier: Apache-2.0

#include "engine/handover/silent_rows.h"

namespace mujoco_impact::engine {

namespace {

// a_ref is then beyond any acceleration of a sane state [m]; half of it tells such a row, for 1e15
// less a depth is rounded.
constexpr mjtNum kApart = 1e15;

void SilenceRow(mjData* d, int row) {
  // a_ref = −b v − k d (pos − margin)
  d->efc_pos[row] = d->efc_margin[row] + kApart;
  mjtNum* KBI = d->efc_KBIP + 4 * row;
  KBI[0] = 1;
  KBI[1] = 0;
  KBI[2] = 1;
}

}  // namespace

void SilenceLimit(mjData* d, bool tendon, int id) {
  const int type = tendon ? mjCNSTR_LIMIT_TENDON : mjCNSTR_LIMIT_JOINT;
  for (int i = 0; i < d->nefc; ++i) {
    if (d->efc_type[i] == type && d->efc_id[i] == id) SilenceRow(d, i);
  }
}

// All rows of a pyramid push the bodies apart. Of an elliptic cone only the first does: the others
// are friction, to which a reference is a demand. The distance does it, for the integrator
// `discrete` computes stiffness and damping anew.
void Silence(mjData* d, int contact) {
  const int begin = d->contact[contact].efc_address, type = d->efc_type[begin];
  const int end = type == mjCNSTR_CONTACT_ELLIPTIC ? begin + 1 : static_cast<int>(d->nefc);
  for (int i = begin; i < end && d->efc_type[i] == type && d->efc_id[i] == contact; ++i) {
    SilenceRow(d, i);
  }
}

bool IsSilent(const mjData* d, const mjContact& contact) {
  return contact.efc_address >= 0 && d->efc_pos[contact.efc_address] >= 0.5 * kApart;
}

}  // namespace mujoco_impact::engine
