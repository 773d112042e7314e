// SPDX-License-Identifier: Apache-2.0

#include "law/coulomb.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "law/friction_on_disc.h"
#include "tests/islands.h"

namespace mujoco_impact::law {
namespace {

constexpr double kSolved = 3e-6;  // of the default tolerance, in parts of the speed

FreeIsland BallOnGround(double speed, double spin, double mu) {
  return FreeIsland({Ball(0.17, 0.03, {0, 0, 0.03}, {speed, 0, -1, 0, spin, 0})},
                    {{-1, 0, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, mu}});
}

TEST(Coulomb, ABallThatSlidesThroughoutIsPushedByMu) {
  for (const double e : {1.0, 0.5, 0.0}) {
    FreeIsland island = BallOnGround(3, 0, 0.3);
    const auto v = island.After(island.Solve({.restitution = e}), 0);
    EXPECT_NEAR(v[0], 3 - 0.3 * (1 + e), kSolved);
    EXPECT_NEAR(v[2], e, kSolved);
    EXPECT_NEAR(v[4], 2.5 * 0.3 * (1 + e) / 0.03, kSolved / 0.03);
  }
}

TEST(Coulomb, ABallThatSticksRolls) {
  FreeIsland island = BallOnGround(0.3, 0, 0.3);
  const auto v = island.After(island.Solve({.restitution = 0.8}), 0);
  EXPECT_NEAR(v[0], 0.3 * 5 / 7, kSolved);
  EXPECT_NEAR(v[4], v[0] / 0.03, kSolved / 0.03);
}

// A tumbling box on three of its corners beside a ball that it touches, the ball on the ground:
// three dimensions, two bodies, all kinds of couplings.
FreeIsland BoxAndBall() {
  const FreeBody box{1.3, {0.002, 0.003, 0.004}, {0, 0, 0.05}, {0.4, -0.2, -1, 2, -3, 5}};
  const double s = std::sqrt(0.5);
  return FreeIsland({box, Ball(0.4, 0.05, {0.15, 0.02, 0.05}, {-0.3, 0.1, -0.2, 1, 2, -4})},
                    {{-1, 0, {0.1, 0.06, 0}, {0, 0, 1}, {1, 0, 0}, 0.4},
                     {-1, 0, {-0.1, 0.06, 0}, {0, 0, 1}, {s, s, 0}, 0.3},
                     {-1, 0, {-0.1, -0.06, 0}, {0, 0, 1}, {0, 1, 0}, 0.0},
                     {0, 1, {0.1, 0.02, 0.05}, {1, 0, 0}, {0, 0, 1}, 0.2, 1e-6},
                     {-1, 1, {0.15, 0.02, 0}, {0, 0, 1}, {0, 1, 0}, 0.5}});
}

// Its corners turn from compression to expansion one after the other.
TEST(Coulomb, ABoxOnItsFaceTakesFewSteps) {
  const FreeBody box{1, {0.0022, 0.0014, 0.0025}, {0, 0, 0.04}, {0.8, -0.5, -1, 2, 1, 3}};
  std::vector<Touch> touches;
  for (const double x : {-0.05, 0.05}) {
    for (const double y : {-0.07, 0.07}) {
      touches.push_back({-1, 0, {x, y, 0}, {0, 0, 1}, {1, 0, 0}, 0.3});
    }
  }
  const auto result = FreeIsland({box}, touches).Solve({.restitution = 0.5});
  EXPECT_TRUE(result.report.converged);
  EXPECT_LE(result.report.steps, 50);
}

TEST(Coulomb, CompressedRowsAndRowsByBodyAreTheSame) {
  for (const auto dissipation : {Dissipation::kBistiffness, Dissipation::kViscous}) {
    FreeIsland island = BoxAndBall();
    const FreeIsland::Options options{.restitution = 0.7, .dissipation = dissipation};
    FreeIsland::Options by_body = options;
    by_body.by_body = true;
    const auto one = island.Solve(options), other = island.Solve(by_body);
    ASSERT_TRUE(one.report.converged);
    EXPECT_GT(*std::max_element(one.impulse.begin(), one.impulse.end()), 0.1);
    for (std::size_t i = 0; i < one.friction.size(); ++i) {
      // rounding that a dozen steps amplify
      EXPECT_NEAR(one.impulse[i / 2], other.impulse[i / 2], 1e-9);
      EXPECT_NEAR(one.friction[i], other.friction[i], 1e-9);
      EXPECT_NEAR(one.slip[i], other.slip[i], 1e-9);
      EXPECT_NEAR(one.friction_moment[i], other.friction_moment[i], 1e-12);
    }
  }
}

TEST(Coulomb, FrictionStaysInItsConeAndLosesEnergy) {
  const double mu[] = {0.4, 0.3, 0.0, 0.2, 0.5};
  for (const double e : {1.0, 0.6, 0.0}) {
    FreeIsland island = BoxAndBall();
    const auto result = island.Solve({.restitution = e});
    ASSERT_TRUE(result.report.converged);
    for (int k = 0; k < 5; ++k) {
      const double size = std::hypot(result.friction[2 * k], result.friction[2 * k + 1]);
      EXPECT_LE(size, mu[k] * result.impulse[k] * (1 + 1e-12));
    }
    EXPECT_LT(island.EnergyAfter(result), 0.99 * island.EnergyBefore());
  }
}

// A spinning ball on a long row: its contacts are integrated through a window, the row is a wave.
TEST(Coulomb, AWaveThatSpinsIsTheSameInBothForms) {
  constexpr int kBalls = 30;
  std::vector<FreeBody> balls;
  std::vector<Touch> touches;
  for (int i = 0; i < kBalls; ++i) {
    balls.push_back(Ball(1, 0.03, {0.06 * i, 0, 0}));
    if (i > 0) touches.push_back({i - 1, i, {0.06 * i - 0.03, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.3});
  }
  balls[0].velocity = {1, 0, 0, 5, 20, 30};
  FreeIsland row(balls, touches);
  const auto one = row.Solve({}), other = row.Solve({.by_body = true});
  ASSERT_TRUE(one.report.converged);
  double momentum = 0;
  for (int i = 0; i < kBalls; ++i) {
    const auto v = row.After(one, i), w = row.After(other, i);
    momentum += v[0];
    for (int j = 0; j < 6; ++j) EXPECT_NEAR(v[j], w[j], 1e-12) << i << ", " << j;
  }
  EXPECT_NEAR(momentum, 1, 1e-13);
  // spin goes over to the second ball, and the last leaves as without: 0.98566
  EXPECT_GT(std::abs(row.After(one, 1)[4]), 0.1);
  EXPECT_NEAR(row.After(one, kBalls - 1)[0], 0.98566, 1e-3);
}

// A step in which nothing else pushes: slip v, at the end b without friction.
StepFriction Rub(const Tangents& A, Pair v, Pair b, double R) {
  const Tangents inverse = Inverse(A);
  const double rate[2] = {b[0] - v[0], b[1] - v[1]}, none[2] = {0, 0};
  return FrictionOfStep({A, inverse, R, v, b, Pair{}, false, rate, rate, none});
}

TEST(FrictionOnDisc, SlidingIsAgainstTheMeanSlipAndOnTheRim) {
  const Tangents A{3, 1, 2};
  const Pair v{2, -1}, b{1.5, -2};
  const Pair p = Rub(A, v, b, 0.1).p;
  EXPECT_NEAR(std::hypot(p[0], p[1]), 0.1, 1e-15);
  const Pair mean = 0.5 * (v + b + Times(A, p));
  // Newton's method ends at 1e-6 of R, which turns p by as little
  EXPECT_NEAR(mean[0] * p[1] - mean[1] * p[0], 0, 1e-6);
  EXPECT_LT(mean[0] * p[0] + mean[1] * p[1], 0);
}

TEST(FrictionOnDisc, StickingStopsTheSlip) {
  const Tangents A{3, 1, 2};
  const Pair b{0.2, -0.1}, p = Rub(A, Pair{0.3, 0.1}, b, 1).p;
  const Pair after = b + Times(A, p);
  EXPECT_NEAR(after[0], 0, 1e-15);
  EXPECT_NEAR(after[1], 0, 1e-15);
}

TEST(FrictionOnDisc, ASlipOnALineStopsAndTurnsRoundWithinTheStep) {
  // pushed back by 3, friction 1: from 1 at a rate of −4 to 0 at 1/4, then at a rate of −2 to −1.5
  const Tangents A{1, 0, 1};
  const StepFriction friction = Rub(A, Pair{1, 0}, Pair{-2, 0}, 1);
  EXPECT_NEAR(friction.theta, 0.25, 1e-8);
  EXPECT_NEAR(friction.p[0], -0.25 + 0.75, 1e-8);
  EXPECT_NEAR(friction.ratio[0], 1, 1e-8);
  EXPECT_NEAR(-2 + friction.p[0], -1.5, 1e-8);
}

}  // namespace
}  // namespace mujoco_impact::law
