// SPDX-License-Identifier: Apache-2.0
// Integrates an impact through its contact forces F_k = K_k y_k³ᐟ², y_k ≥ 0 (bi-stiffness).
//
//   dc/dt = −W F        dy_k/dt = c_k         while compressing or open
//                       dy_k/dt = c_k / e²    while expanding
//
// so that a contact gives back e² of the work stored in it (energetic restitution, Stronge) at any
// speed. For e = 1 this is the Hertz ordinary differential equation; for e < 1 it is the
// Liu-Zhao-Brogliato law (Proc. R. Soc. A 464, 2008, bi-stiffness) without its singular start,
// except that a contact which has expanded opens a gap, where theirs may press again at once. A
// contact of e = 0 drops its compression when it stops closing. Only ratios of stiffness and mass
// matter for the impulses; the result is independent of the speed.
//
// Method: the embedded Runge-Kutta-Nyström pair 4(3) of Dormand, El-Mikkawy and Prince (IMA J.
// Numer. Anal. 7, 1987), three force evaluations a step, the step set by the error estimate: the
// force has no second derivative at y = 0, which limits every fixed step to order 2.5. Free flight
// between contacts is jumped over. Impulses are quadratures of the same stages, and closing speeds
// follow from them, so momentum is exact to rounding.

#ifndef MUJOCO_IMPACT_LAW_COMPRESSION_H_
#define MUJOCO_IMPACT_LAW_COMPRESSION_H_

#include "law/impact_problem.h"

namespace mujoco_impact::law {

// Doubles of workspace that an island of `size` contacts needs.
int CompressionWorkspace(int size, bool friction);

ImpactReport IntegrateCompression(const ImpactProblem& problem, ImpactSolution* solution,
                                  const Workspace& workspace);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_COMPRESSION_H_
