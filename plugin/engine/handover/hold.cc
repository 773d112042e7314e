// SPDX-License-Identifier: Apache-2.0

#include "engine/handover/hold.h"

#include <algorithm>

#include "engine/handover/silent_rows.h"

namespace mujoco_impact::engine {

namespace {

Hold HoldOfRow(const mjData* d, int i) {
  const int type = d->efc_type[i];
  const bool contact = type == mjCNSTR_CONTACT_FRICTIONLESS || type == mjCNSTR_CONTACT_PYRAMIDAL ||
                       type == mjCNSTR_CONTACT_ELLIPTIC;
  if (!contact) return Hold::kTied;
  return IsSilent(d, d->contact[d->efc_id[i]]) ? Hold::kNone : Hold::kCarried;
}

}  // namespace

void FindHeld(const mjModel* m, const mjData* d, Hold* held) {
  std::fill_n(held, m->ntree, Hold::kNone);
  const int nv = static_cast<int>(m->nv);
  const bool sparse = mj_isSparse(m);
  for (int i = 0; i < d->nefc; ++i) {
    const Hold hold = HoldOfRow(d, i);
    if (hold == Hold::kNone) continue;
    const int begin = sparse ? d->efc_J_rowadr[i] : i * nv;
    const int count = sparse ? d->efc_J_rownnz[i] : nv;
    for (int a = begin; a < begin + count; ++a) {
      if (d->efc_J[a] == 0) continue;
      Hold& tree = held[m->dof_treeid[sparse ? d->efc_J_colind[a] : a - begin]];
      tree = std::max(tree, hold);
    }
  }
}

}  // namespace mujoco_impact::engine
