// SPDX-License-Identifier: Apache-2.0
// Ends an impact that would rattle on for longer than there is work for: impulses P' ≥ 0 that come
// at once, and after which nothing closes until the horizon,
//
//   P' ≥ 0  ⊥  g / t_left − (c' − W P') ≥ 0
//
// with the closing speeds c' and the gaps g ≥ 0 at that time. A contact may close as far as its gap
// allows, so nothing pushes from afar; what springs hold is dropped. Projected Gauss-Seidel
// minimises
//
//   ½ P'ᵀ W P' − (c' − g / t_left)ᵀ P'
//
// contact by contact. It starts at zero and only falls, and the change of kinetic energy is less by
// P'ᵀ g / t_left: however few sweeps there is work for, energy does not grow.

#ifndef MUJOCO_IMPACT_LAW_PLASTIC_END_H_
#define MUJOCO_IMPACT_LAW_PLASTIC_END_H_

#include "law/impact_problem.h"

namespace mujoco_impact::law {

// Adds the impulses that end the impact at time t to the solution, whose closing speeds it leaves
// as they are. Returns the work done, in multiplications.
double EndPlastically(const ImpactProblem& problem, double t, ImpactSolution* solution,
                      const Workspace& workspace);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_PLASTIC_END_H_
