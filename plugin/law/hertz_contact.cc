// SPDX-License-Identifier: Apache-2.0

#include "law/hertz_contact.h"

#include <cmath>

namespace mujoco_impact::law {

double EffectiveModulus(double young, double poisson) {
  // 1/E* = (1 − ν²)/E + (1 − ν²)/E
  return young / (2 * (1 - poisson * poisson));
}

double HertzStiffness(double effective_modulus, double curvature) {
  // K = 4/3 E* √R*
  return 4.0 / 3.0 * effective_modulus / std::sqrt(curvature);
}

double MaximumCompression(double stiffness, double reduced_mass, double speed) {
  // y_max = (5 μ u² / (4 K))^(2/5)
  return std::pow(1.25 * reduced_mass * speed * speed / stiffness, 0.4);
}

namespace {

// T u / y_max = 4/5 B(2/5, 1/2), T the time of contact without losses
constexpr double kContactTimeFactor = 2.9432751843247047;

}  // namespace

double ContactTime(double stiffness, double reduced_mass, double speed) {
  return kContactTimeFactor * MaximumCompression(stiffness, reduced_mass, speed) / speed;
}

double HertzPeak(double impulse, double centre, double restitution) {
  // P = (1 + e) μ u. The compression takes T/2 with its impulse μ u centred at y_max/u = s T/2, the
  // expansion e T/2 with e μ u, its mirror image stretched:
  //   centre = (T/2) (s + e (1 + e (1 − s))) / (1 + e)
  const double e = restitution, s = 2 / kContactTimeFactor;
  const double half = centre * (1 + e) / (s + e * (1 + e * (1 - s)));
  // F = K y_max^(3/2) = 5/4 μ u² / y_max
  return 1.25 * impulse / (1 + e) * kContactTimeFactor / (2 * half);
}

}  // namespace mujoco_impact::law
