// SPDX-License-Identifier: Apache-2.0
// Ends an impact for which there is no more work, all at once. With the closing speeds c and the
// gaps g ≥ 0 at that time, the impulses p that stop the contacts,
//
//   p ≥ 0  ⊥  g / t_left − (c − W p) ≥ 0
//
// are given 1 + e times, e the lowest of the island, again and again until nothing closes before
// the horizon; once, and plastically, if there is no work for that either. A contact may close as
// far as its gap allows, so nothing pushes from afar; what springs hold is dropped. An elastic
// impact then goes on as a sequence of simultaneous ones (Smith, Kaufman, Vouga, Tamstorf and
// Grinspun: Reflections on Simultaneous Impact, 2012).
//
// p by projected Gauss-Seidel, which minimises ½ pᵀW p − (c − g / t_left)ᵀp contact by contact from
// zero on. However few sweeps there is work for, the change of kinetic energy ½ pᵀW p − cᵀp is not
// positive, and that of s p is not for s up to the s* of passivity.h.

#ifndef MUJOCO_IMPACT_LAW_SHORT_END_H_
#define MUJOCO_IMPACT_LAW_SHORT_END_H_

#include "law/impact_problem.h"

namespace mujoco_impact::law {

// Adds the impulses that end the impact at time t to the solution. Returns the work done, in
// multiplications.
double EndShort(const ImpactProblem& problem, double t, ImpactSolution* solution,
                const Workspace& workspace);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_SHORT_END_H_
