// SPDX-License-Identifier: Apache-2.0

#include "law/friction.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mujoco_impact::law {
namespace {

// Equations (7)-(9) stepped through in `steps` equal parts of the normal impulse.
double Stepped(const PaperFriction& friction, double N, double T, double P, int steps) {
  const double ds = P / steps, before = T;
  for (int i = 0; i < steps; ++i) {
    const bool sticks = T <= friction.static_factor * std::abs(N);
    if (!sticks) T = std::max(0.0, T - friction.dynamic_factor * ds);
    N -= ds;
  }
  return before - T;
}

TEST(PaperFriction, ClosedFormIsTheLimitOfSmallSteps) {
  for (const double mu_s : {0.0, 0.02, 0.3, 0.9}) {
    for (const double mu_d : {0.0, 0.05, 0.3, 0.7}) {
      for (const double N : {0.0, 0.4, 1.0}) {
        for (const double T : {0.0, 0.1, 0.5, 2.0}) {
          for (const double P : {0.2, 1.0, 1.9}) {
            const PaperFriction friction{mu_s, mu_d};
            const int steps = 20000;
            // a step decides with the mode at its start: each change of mode is late by one step
            EXPECT_NEAR(FrictionImpulse(friction, N, T, P), Stepped(friction, N, T, P, steps),
                        4 * P / steps)
                << mu_s << " " << mu_d << " " << N << " " << T << " " << P;
          }
        }
      }
    }
  }
}

TEST(PaperFriction, SlidingAllTheWayIsCoulomb) {
  // no static factor, fast slip: Q = mu_d P
  EXPECT_NEAR(FrictionImpulse({0, 0.3}, 1, 10, 1.8), 0.3 * 1.8, 1e-14);
}

TEST(PaperFriction, SlowSlipUnderStrongStickingOnlySlidesAroundTheTurningPoint) {
  // sticks but for |N| < T / mu_s = .2: slides from s = .8; after N = 0 until T = mu_s x
  const double left = 0.1 - 0.3 * 0.2;
  EXPECT_NEAR(FrictionImpulse({0.5, 0.3}, 1, 0.1, 2), 0.3 * 0.2 + 0.3 * left / 0.8, 1e-15);
}

TEST(PaperFriction, NoSlipNoFriction) { EXPECT_EQ(FrictionImpulse({0.5, 0.3}, 1, 0, 2), 0); }

}  // namespace
}  // namespace mujoco_impact::law
