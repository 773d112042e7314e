// SPDX-License-Identifier: Apache-2.0

#include "law/hertz_contact.h"

#include <cmath>

namespace mujoco_impact::law {

double EffectiveModulus(double young, double poisson) {
  // 1/E* = (1 − ν²)/E + (1 − ν²)/E
  return young / (2 * (1 - poisson * poisson));
}

double Compliance(double young, double poisson) { return (1 - poisson * poisson) / young; }

double CompositeRestitution(double e1, double compliance1, double e2, double compliance2) {
  if (e1 == e2) return e1;
  // e² = (C₁ e₁² + C₂ e₂²)/(C₁ + C₂)
  const double returned = compliance1 * e1 * e1 + compliance2 * e2 * e2;
  return std::sqrt(returned / (compliance1 + compliance2));
}

double HertzStiffness(double effective_modulus, double curvature) {
  // K = 4/3 E* √R*
  return 4.0 / 3.0 * effective_modulus / std::sqrt(curvature);
}

double MaximumCompression(double stiffness, double reduced_mass, double speed) {
  // y_max = (5 μ u² / (4 K))^(2/5)
  return std::pow(1.25 * reduced_mass * speed * speed / stiffness, 0.4);
}

double ContactTime(double stiffness, double reduced_mass, double speed) {
  // T = 4/5 B(2/5, 1/2) y_max / u
  constexpr double kContactTimeFactor = 2.9432751843247047;
  return kContactTimeFactor * MaximumCompression(stiffness, reduced_mass, speed) / speed;
}

}  // namespace mujoco_impact::law
