// SPDX-License-Identifier: Apache-2.0

#include "engine/resolve/budget.h"

namespace mujoco_impact::engine {

namespace {

// What a step takes MuJoCo at least [ns]: for a degree of freedom, a number of the inertia matrix,
// a contact within the gap, and one that touches.
constexpr double kPerDof = 300, kPerInertia = 20, kPerContact = 100, kPerTouch = 300;

// What impacts may take, over that: not all of it is counted, and a step may take 20 times and 2
// ms, without friction.
constexpr double kConstant = 1.7e6, kOfMujoco = 12;

// An elastic impact takes as long as its wave, and does not rattle; to end it costs the most.
constexpr double kElastic = 3;

// With friction a step of the law costs four times as much, and bodies rattle on their feet: this
// many times the constant, unless all is elastic.
constexpr double kFriction = 2;

}  // namespace

Budget::Budget(const mjModel* m, bool elastic, bool friction, const Gathered& contacts) {
  const auto touches = std::count_if(contacts.lowest, contacts.lowest + contacts.count,
                                     [](mjtNum gap) { return gap <= 0; });
  const double of_contacts = kPerContact * contacts.count + kPerTouch * touches;
  const double constant = friction && !elastic ? kFriction * kConstant : kConstant;
  total_ = constant + kOfMujoco * (kPerDof * m->nv + kPerInertia * m->nM + of_contacts);
  if (elastic) total_ *= kElastic;
}

void Budget::SpendRound(const mjModel* m, const Gathered& contacts) {
  constexpr double kPerBody = 400, kPerVelocity = 50, kPerPath = 500, kPerAny = 50;
  most_for_rows_ = std::max(most_for_rows_, for_rows_);
  for_rows_ = 0;
  const auto paths = std::count(contacts.relevant, contacts.relevant + contacts.count, true);
  Spend(kPerBody * m->nbody + kPerVelocity * m->nv + kPerPath * paths + kPerAny * contacts.count);
}

void Budget::SpendRow(const mjModel* m, const ContactRow& row, int directions) {
  constexpr double kPerRow = 500, kPerDof = 75;
  double dofs = 0;
  for (const RowSegment& segment : row.segment) {
    if (segment.tree >= 0) dofs += m->tree_dofnum[segment.tree];
  }
  const double work = directions * (kPerRow + kPerDof * dofs);
  for_rows_ += work;
  Spend(work);
}

}  // namespace mujoco_impact::engine
