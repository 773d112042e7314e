// SPDX-License-Identifier: Apache-2.0
// Passivity guard: no impact adds kinetic energy.
//
// Impulses P ≥ 0 on contacts with closing speeds c change the kinetic energy by
//
//   ΔT = −cᵀ P + ½ Pᵀ W P
//
// which is ≤ 0 exactly when P is at most s* P, s* = 2 cᵀP / (Pᵀ W P). Necessary and sufficient for
// the whole impact, any number of contacts. Single contact: P ≤ 2 μ c, the elastic impulse.

#ifndef MUJOCO_IMPACT_LAW_PASSIVITY_H_
#define MUJOCO_IMPACT_LAW_PASSIVITY_H_

#include "law/impact_problem.h"

namespace mujoco_impact::law {

// ΔT [J] of the impulses P at closing speeds c; `work` holds `size` numbers.
double KineticEnergyChange(const DelassusMatrix& delassus, const double* closing_speed,
                           const double* impulse, double* work);

// s*, the factor at which P conserves energy; 0 where P does no work on closing contacts.
double ConservativeScale(const DelassusMatrix& delassus, const double* closing_speed,
                         const double* impulse, double* work);

// Takes away the energy that the impulses add, if any, where no factor does: pushes that cancel
// each other, as those on a body that bounced to and fro, do no work together, and what they add is
// the error of the integration. With the closing speeds c' = c − W P that they leave,
//
//   P + λ d,    d = D⁻¹ c',  D the diagonal of W
//
// with the smaller root of ½ dᵀW d λ² − c'ᵀd λ + ΔT = 0 takes away just that much: it
// pushes more where contacts still close and less where they part. `moment` goes along; `work`
// holds 3 × `size` numbers.
void RemoveGain(const DelassusMatrix& delassus, const double* closing_speed, double* impulse,
                double* moment, double* work);

// min(1, s*): the factor that the guard applies to every impulse of the island.
double PassiveScale(const DelassusMatrix& delassus, const double* closing_speed,
                    const double* impulse, double* work);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_PASSIVITY_H_
