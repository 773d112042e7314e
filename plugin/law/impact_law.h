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

// Numbers and indices of workspace that SolveImpact needs for an island of `size` contacts.
int ImpactNumbers(int size);
int ImpactIndices(int size);

// Fills `solution`. With `passive` false the impulses are left as integrated.
ImpactReport SolveImpact(const ImpactProblem& problem, bool passive, ImpactSolution* solution,
                         const Workspace& workspace);

// Closed form of one contact of reduced mass μ that closes with speed u (bi-stiffness):
//
//   P = (1 + e) μ u        W = (1 + e) T/2        M = W P − μ (u W − (1 − e²) y_max)
//
// M from the relative displacement u W − ∫ (W − s) F ds/μ, which a loss leaves at (1 − e²) y_max.
struct SingleImpact {
  double impulse;   // P [N s]
  double duration;  // W [s]
  double moment;    // M about the onset [N s²]
};
SingleImpact SolveSingleImpact(double reduced_mass, double speed, double stiffness,
                               double restitution);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_IMPACT_LAW_H_
