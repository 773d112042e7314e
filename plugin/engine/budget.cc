// SPDX-License-Identifier: Apache-2.0

#include "engine/budget.h"

namespace mujoco_impact::engine {

namespace {

// What MuJoCo takes, about: for a degree of freedom, a number of the inertia matrix, a contact
// [ns].
constexpr double kPerDof = 800, kPerInertia = 40, kPerContact = 500;

// What impacts may take, over that: half of what a step may, for not all of it is counted.
constexpr double kConstant = 1.5e6, kOfMujoco = 10;

}  // namespace

Budget::Budget(const mjModel* m, const mjData* d)
    : total_(kConstant +
             kOfMujoco * (kPerDof * m->nv + kPerInertia * m->nM + kPerContact * d->ncon)) {}

void Budget::SpendRound(const mjModel* m, const Gathered& contacts) {
  constexpr double kPerBody = 400, kPerVelocity = 50, kPerPath = 500, kPerContact = 50;
  most_for_rows_ = std::max(most_for_rows_, for_rows_);
  for_rows_ = 0;
  const auto paths = std::count(contacts.relevant, contacts.relevant + contacts.count, true);
  Spend(kPerBody * m->nbody + kPerVelocity * m->nv + kPerPath * paths +
        kPerContact * contacts.count);
}

void Budget::SpendRow(const mjModel* m, const ContactRow& row) {
  constexpr double kPerRow = 500, kPerDof = 75;
  double dofs = 0;
  for (const RowSegment& segment : row.segment) {
    if (segment.tree >= 0) dofs += m->tree_dofnum[segment.tree];
  }
  for_rows_ += kPerRow + kPerDof * dofs;
  Spend(kPerRow + kPerDof * dofs);
}

}  // namespace mujoco_impact::engine
