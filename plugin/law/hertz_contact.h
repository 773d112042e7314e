// SPDX-License-Identifier: Apache-2.0
// Hertz contact of one pair of elastic spheres: closed forms.
//
//   F = K y³ᐟ²                      y ≥ 0 compression [m], F force [N]
//   K = 4/3 E* √R*                  stiffness [N/m³ᐟ²]
//   1/E* = C₁ + C₂                  C = (1 − ν²)/E compliance of a body [1/Pa]: E [Pa], ν [-]
//   1/R* = 1/R₁ + 1/R₂              R = ∞ for a flat, given as curvature 0
//
// Two bodies of reduced mass μ [kg] that close with speed u [m/s] and separate without loss:
//
//   y_max = (5 μ u² / (4 K))²ᐟ⁵     from  ½ μ u² = 2/5 K y⁵ᐟ²
//   T = 2.9432… y_max / u           2 ∫₀¹ dx/√(1 − x⁵ᐟ²) = 4/5 B(2/5, 1/2)
//
// Limits: T → ∞ as u → 0 (as u^−1/5); y_max → 0 as K → ∞.
// Source: K. L. Johnson, Contact Mechanics (1985), sections 4.2 and 11.4.

#ifndef MUJOCO_IMPACT_LAW_HERTZ_CONTACT_H_
#define MUJOCO_IMPACT_LAW_HERTZ_CONTACT_H_

namespace mujoco_impact::law {

// Plane-strain modulus E* [Pa] of two bodies of the same material.
double EffectiveModulus(double young, double poisson);

// C = (1 − ν²)/E [1/Pa].
double Compliance(double young, double poisson);

// Restitution of two bodies in contact. Both feel the same force, so each takes up the part C_i /
// (C₁ + C₂) of the work of compression, of which e_i² comes back:
//
//   e² = (C₁ e₁² + C₂ e₂²)/(C₁ + C₂)
//
// e_i is that of a body against one of its own material. Source: J. Coaplen, W. J. Stronge, B.
// Ravani, Work equivalent composite coefficient of restitution, Int. J. Impact Eng. 30 (2004)
// 581-591: e²/k = e₁²/k₁ + e₂²/k₂, 1/k = 1/k₁ + 1/k₂; here 1/k_i = C_i.
double CompositeRestitution(double e1, double compliance1, double e2, double compliance2);

// Hertz stiffness K [N/m^1.5]; `curvature` is 1/R1 + 1/R2 [1/m], positive.
double HertzStiffness(double effective_modulus, double curvature);

// Largest compression [m] of a pair of reduced mass μ [kg] closing with `speed` [m/s] > 0.
double MaximumCompression(double stiffness, double reduced_mass, double speed);

// Duration [s] of the elastic contact of that pair.
double ContactTime(double stiffness, double reduced_mass, double speed);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_HERTZ_CONTACT_H_
