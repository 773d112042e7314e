// SPDX-License-Identifier: Apache-2.0

#include "engine/budget.h"

namespace mujoco_impact::engine {

namespace {

// MuJoCo takes about a microsecond a degree of freedom and half of one a contact.
constexpr double kPerDof = 1000, kPerContact = 500;

// Of our own, of which the rest of a step takes as much again.
constexpr double kConstant = 1.5e6, kOfMujoco = 10;

}  // namespace

Budget::Budget(const mjModel* m, const mjData* d)
    : total_(kConstant + kOfMujoco * (kPerDof * m->nv + kPerContact * d->ncon)) {}

void Budget::SpendRound(const mjModel* m, int contacts) {
  constexpr double kPerBody = 500, kPerVelocity = 100, kPerPath = 150;
  Spend(kPerBody * m->nbody + kPerVelocity * m->nv + kPerPath * contacts);
}

}  // namespace mujoco_impact::engine
