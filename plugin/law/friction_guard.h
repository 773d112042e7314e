// SPDX-License-Identifier: Apache-2.0
// Passivity guard of an impact with friction: passivity.h over all rows.
//
//   ΔT = −cᵀP + vᵀP_t + ½ (P, P_t)ᵀ W (P, P_t) ≤ 0
//
// Friction loses energy by itself, so impulses are only ever made smaller, by the factor s* ≤ 1 at
// which ΔT = 0; both by the same, which keeps |P_t| ≤ μ P.

#ifndef MUJOCO_IMPACT_LAW_FRICTION_GUARD_H_
#define MUJOCO_IMPACT_LAW_FRICTION_GUARD_H_

#include "law/impact_problem.h"

namespace mujoco_impact::law {

// ΔT [J] of the impulses of the solution, whose closing speeds and slips are up to date.
double KineticEnergyChange(const ImpactProblem& problem, const ImpactSolution& solution);

// Takes the energy away that the impulses add, if any.
void RemoveGain(const ImpactProblem& problem, ImpactSolution& solution);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_FRICTION_GUARD_H_
