// SPDX-License-Identifier: Apache-2.0
// The law `hertz`: impulses of an island from its stiffnesses, masses and gaps.
//
// Picks the cheapest exact way: a single isolated contact in closed form, otherwise the integrator
// of the dissipation law. The result is made passive; an elastic impact conserves energy to
// rounding, because the integrator's remaining error is scaled away (s* of passivity.h).

#ifndef MUJOCO_IMPACT_LAW_IMPACT_LAW_H_
#define MUJOCO_IMPACT_LAW_IMPACT_LAW_H_

#include "law/impact_problem.h"

namespace mujoco_impact::law {

// Error per step, relative; the impulses of elastic rows are then good to 1e-6.
constexpr double kDefaultTolerance = 1e-5;
constexpr double kSmallestTolerance = 1e-12, kLargestTolerance = 1e-2;

// Numbers and indices of workspace that SolveImpact needs for an island of `size` contacts.
int ImpactNumbers(int size, bool friction = false);
int ImpactIndices(int size);

// Fills `solution`. With `passive` false the impulses are left as integrated.
ImpactReport SolveImpact(const ImpactProblem& problem, bool passive, ImpactSolution* solution,
                         const Workspace& workspace);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_IMPACT_LAW_H_
