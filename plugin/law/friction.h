// SPDX-License-Identifier: Apache-2.0
// Friction of an impact after Dondo and Noborio, equations (7)-(9), as printed.
//
// With the momenta N = m u_z along the normal and T = m |u_t| along the slip, and s the normal
// impulse delivered so far, 0 ≤ s ≤ P:
//
//   N(s) = N₀ − s,  T(s) = T₀ − Q(s)           (8)
//   sticks while T ≤ μ_s |N|: dQ/ds = 0         (7)
//   slides otherwise: dQ/ds = μ_d               (9)
//
// Q(P), the tangential impulse, has a closed form: N falls to zero and grows again, so there is at
// most one change of mode before N = 0 and one after it. Where a sliding contact would stick and a
// sticking one would slide, T stays on the border T = μ_s |N|. The slip is never reversed: Q ≤ T₀.
//
// This is not Coulomb's law: (7) compares momenta instead of impulses, and what it calls sticking
// leaves the slip as it is.

#ifndef MUJOCO_IMPACT_LAW_FRICTION_H_
#define MUJOCO_IMPACT_LAW_FRICTION_H_

namespace mujoco_impact::law {

struct PaperFriction {
  double static_factor;   // μ_s [-] ≥ 0
  double dynamic_factor;  // μ_d [-] ≥ 0
};

// Q ≥ 0 [N s], against the slip, of a contact with normal momentum N₀ ≥ 0 and slip momentum T₀ ≥ 0
// [kg m/s] that receives the normal impulse P ≥ 0 [N s].
double FrictionImpulse(const PaperFriction& friction, double normal_momentum, double slip_momentum,
                       double impulse);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_FRICTION_H_
