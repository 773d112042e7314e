// SPDX-License-Identifier: Apache-2.0
// Integrates an impact with viscous loss in the contacts (Hunt and Crossley 1975):
//
//   F_k = K_k y_k³ᐟ² (1 + x c_k / c_ref),  F_k ≥ 0        dc/dt = −W F,  dy_k/dt = c_k
//
// x [-] is the damping at which an isolated pair closing with c_ref restitutes e:
//
//   ln((1 + x) / (1 − e x)) = x (1 + e)
//
// c_ref is the fastest closing speed of the impact, so the result does not depend on the speed.
// Limits: e → 1 gives x → 0, the Hertz law; x grows as 1/e as e → 0, hence e ≥ kViscousMinimum.
// The force depends on c, so the integrator is the embedded pair 5(4) of Dormand and Prince (1980).

#ifndef MUJOCO_IMPACT_LAW_VISCOUS_H_
#define MUJOCO_IMPACT_LAW_VISCOUS_H_

#include "law/impact_problem.h"

namespace mujoco_impact::law {

constexpr double kViscousMinimum = 0.05;

// x(e) for e in [kViscousMinimum, 1].
double ViscousDamping(double restitution);

// Doubles of workspace that an island of `size` contacts needs.
int ViscousWorkspace(int size, bool friction);

ImpactReport IntegrateViscous(const ImpactProblem& problem, ImpactSolution* solution,
                              const Workspace& workspace);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_VISCOUS_H_
