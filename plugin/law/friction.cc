// SPDX-License-Identifier: Apache-2.0

#include "law/friction.h"

#include <algorithm>

namespace mujoco_impact::law {

namespace {

// T after the normal impulse s ≤ N₀.
double SlipWhileCompressing(const PaperFriction& friction, double N, double T, double s) {
  const auto [mu_s, mu_d] = friction;
  double start = 0;
  if (T <= mu_s * N) {
    // sticks until |N| has fallen to T / μ_s
    start = mu_s > 0 ? N - T / mu_s : N;
    if (s <= start) return T;
  }
  // max: friction that would take T below the border leaves it on the border
  return std::max(T - mu_d * (s - start), mu_s * (N - s));
}

}  // namespace

double FrictionImpulse(const PaperFriction& friction, double normal_momentum, double slip_momentum,
                       double impulse) {
  const double compression = std::min(impulse, normal_momentum);
  const double T = SlipWhileCompressing(friction, normal_momentum, slip_momentum, compression);
  const double expansion = impulse - compression;
  const double both = friction.static_factor + friction.dynamic_factor;
  if (expansion <= 0 || both <= 0) return slip_momentum - T;
  // slides until T − μ_d x = μ_s x
  const double sliding = std::min(expansion, T / both);
  return slip_momentum - T + friction.dynamic_factor * sliding;
}

}  // namespace mujoco_impact::law
