// SPDX-License-Identifier: Apache-2.0

#include "law/impact_law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <string>

#include "law/hertz_contact.h"
#include "law/passivity.h"
#include "law/single_impact.h"
#include "law/viscous.h"
#include "tests/rows.h"

namespace mujoco_impact::law {
namespace {

// The integrator's step tolerance is 1e-6 of the impact; impulses add a few steps' errors up.
constexpr double kSolved = 3e-6;

// Ratio of the Hertz stiffness of two spheres to that of two A balls; radii A 15 mm, B 19.05 mm.
double Stiffness(char left, char right) {
  const auto curvature = [](char c) { return 1 / (c == 'A' ? 0.015 : 0.01905); };
  return HertzStiffness(1e11, curvature(left) + curvature(right));
}

Row Pattern(const std::string& pattern, int incoming = 1) {
  Row row;
  row.incoming = incoming;
  for (const char c : pattern) row.mass.push_back(c == 'A' ? 0.115 : 0.230);
  for (size_t i = 1; i < pattern.size(); ++i) {
    row.stiffness.push_back(Stiffness(pattern[i - 1], pattern[i]));
  }
  return row;
}

struct Published {
  std::string pattern;
  int incoming;
  double restitution;
  Dissipation dissipation;
  std::vector<double> velocity;
};

constexpr auto kBi = Dissipation::kBistiffness;
constexpr auto kViscous = Dissipation::kViscous;

class ReferenceImpact : public testing::TestWithParam<Published> {};

// Independent integrations of the same differential equations: scipy DOP853 at rtol 1e-12 in body
// coordinates with event restart (Hertz, Hunt-Crossley), the Liu-Zhao-Brogliato impulse equations
// for bi-stiffness; masses 115 g and 230 g, radii 15.0 mm and 19.05 mm.
INSTANTIATE_TEST_SUITE_P(
    Published, ReferenceImpact,
    testing::Values(
        Published{"AAA", 1, 1, kBi, {-0.070952353650, 0.076403039070, 0.994549314580}},
        Published{"AAA", 2, 1, kBi, {0.005450685420, 0.923596960930, 1.070952353650}},
        Published{
            "AAAAA",
            1,
            1,
            kBi,
            {-0.071085017087, -0.030273764097, -0.014463629032, 0.127044986068, 0.988777424147}},
        Published{
            "AAAAA",
            2,
            1,
            kBi,
            {-0.112614979026, -0.041959500533, 0.214485776195, 0.800366671701, 1.139722031664}},
        Published{"ABA", 1, 1, kBi, {-0.361985920698, 0.249613728654, 0.862758463391}},
        Published{"AAA", 1, 0.9, kBi, {-0.00861535615488, 0.104142798515, 0.90447255764}},
        Published{
            "AAAAA",
            2,
            0.9,
            kBi,
            {-0.00718265069689, 0.0437179463324, 0.230508911288, 0.737597085652, 0.995358707424}},
        Published{"ABA", 1, 0.9, kBi, {-0.291007688834, 0.253107331182, 0.784793026469}}),
    [](const auto& test) {
      return test.param.pattern + "_" + std::to_string(test.param.incoming) + "in_e" +
             std::to_string(static_cast<int>(10 * test.param.restitution));
    });

TEST_P(ReferenceImpact, VelocitiesAgree) {
  const Published& published = GetParam();
  const RowResult result =
      Collide(Pattern(published.pattern, published.incoming),
              {.restitution = published.restitution, .dissipation = published.dissipation});
  ASSERT_TRUE(result.report.converged);
  for (size_t i = 0; i < published.velocity.size(); ++i) {
    EXPECT_NEAR(result.velocity[i], published.velocity[i], kSolved) << "ball " << i;
  }
}

TEST(ImpactLaw, ViscousRowAgreesWithHuntCrossleyReference) {
  // DOP853 of F = K d^1.5 (1 + 1.5 c d'), c = .11099 / v0, which gives a pair e = .9 to 5 digits
  const RowResult result = Collide(Pattern("AAA"), {.restitution = 0.9, .dissipation = kViscous});
  const double published[] = {-0.0391314613448, 0.122916444531, 0.916215016813};
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(result.velocity[i], published[i], 3e-5);
}

class Loss : public testing::TestWithParam<std::tuple<double, Dissipation>> {};

TEST_P(Loss, APairRestitutes) {
  const auto [e, dissipation] = GetParam();
  Row pair;
  pair.mass = {0.2, 0.7};
  const RowResult result = Collide(pair, {.restitution = e, .dissipation = dissipation});
  // the viscous force jumps when it sets in, which its error estimate sees ten times too small
  EXPECT_NEAR(result.velocity[1] - result.velocity[0], e, dissipation == kBi ? kSolved : 5e-5);
}

TEST_P(Loss, NoRowGainsEnergy) {
  const auto [e, dissipation] = GetParam();
  const Row row = Pattern("ABBAB", 2);
  const RowResult result = Collide(row, {.restitution = e, .dissipation = dissipation});
  double before = 0, after = 0;
  for (size_t i = 0; i < row.mass.size(); ++i) {
    before += static_cast<int>(i) < row.incoming ? row.mass[i] : 0;
    after += row.mass[i] * result.velocity[i] * result.velocity[i];
  }
  // rounding of the sums
  EXPECT_LE(after, before * (1 + 1e-14));
  if (e == 1) {
    EXPECT_NEAR(after / before, 1, 1e-14);
  }
}

TEST_P(Loss, BallsPartOrTouch) {
  const auto [e, dissipation] = GetParam();
  const RowResult result =
      Collide(Pattern("BABAA"), {.restitution = e, .dissipation = dissipation});
  ASSERT_TRUE(result.report.converged);
  for (size_t i = 1; i < result.velocity.size(); ++i) {
    // the impact ends when closing speeds are below 1e-6; energy scaling moves them by as much
    EXPECT_GE(result.velocity[i], result.velocity[i - 1] - 5e-6);
    EXPECT_GE(result.impulse[i - 1], 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Restitution, Loss,
                         testing::Values(std::tuple{1.0, kBi}, std::tuple{0.9, kBi},
                                         std::tuple{0.5, kBi}, std::tuple{0.1, kBi},
                                         std::tuple{0.0, kBi}, std::tuple{0.95, kViscous},
                                         std::tuple{0.5, kViscous}, std::tuple{0.05, kViscous}));

TEST(ImpactLaw, ToleranceSetsTheError) {
  const RowResult exact = Collide(Pattern("AAAAA"), {.tolerance = 1e-10});
  double last = 1;
  for (const double tolerance : {1e-3, 1e-5, 1e-7}) {
    const RowResult result = Collide(Pattern("AAAAA"), {.tolerance = tolerance});
    double error = 0;
    for (int i = 0; i < 5; ++i) {
      error = std::max(error, std::abs(result.velocity[i] - exact.velocity[i]));
    }
    EXPECT_LT(error, tolerance);
    EXPECT_LT(error, 0.1 * last);
    last = error;
  }
}

TEST(ImpactLaw, AWideGapGivesSequentialImpacts) {
  Row row = Pattern("AAA");
  row.gap = {0, 1e-3};
  const RowResult result = Collide(row);
  EXPECT_NEAR(result.velocity[0], 0, kSolved);
  EXPECT_NEAR(result.velocity[1], 0, kSolved);
  EXPECT_NEAR(result.velocity[2], 1, kSolved);
  // ball 2 flies 1 mm at speed 1 minus half the way it made in contact
  EXPECT_NEAR(result.onset[1], 1e-3, 1e-4);
}

TEST(ImpactLaw, AClosingBeyondTheHorizonIsLeftAlone) {
  Row row = Pattern("AAA");
  row.gap = {0, 1e-3};
  const RowResult result = Collide(row, {.horizon = 5e-4});
  EXPECT_NEAR(result.velocity[1], 1, kSolved);
  EXPECT_EQ(result.impulse[1], 0);
}

TEST(ImpactLaw, TheOutcomeDoesNotDependOnStiffnessButItsDurationDoes) {
  Row soft = Pattern("BAB"), stiff = soft;
  for (double& K : soft.stiffness) K *= 1e-4;
  const RowResult a = Collide(soft), b = Collide(stiff);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a.velocity[i], b.velocity[i], kSolved);
  // time scales as K^(-2/5)
  EXPECT_NEAR(a.moment[0] / a.impulse[0] / (b.moment[0] / b.impulse[0]), std::pow(1e4, 0.4), 1e-2);
}

TEST(ImpactLaw, MomentIsThatOfTheClosedForm) {
  for (const double e : {1.0, 0.7, 0.0}) {
    // a distant third ball makes the integrator solve what the closed form gives
    Row row;
    row.mass = {0.115, 0.2, 1e9};
    row.gap = {0, 1e3};
    const RowResult result = Collide(row, {.restitution = e, .tolerance = 1e-9, .horizon = 1});
    const SingleImpact single = SolveSingleImpact(1 / (1 / 0.115 + 1 / 0.2), 1, 1e10, e);
    EXPECT_NEAR(result.impulse[0] / single.impulse, 1, 1e-6) << e;
    EXPECT_NEAR(result.moment[0] / single.moment, 1, 1e-4) << e;
  }
}

TEST(Passivity, TheConservativeScaleConservesEnergy) {
  const RowMatrix matrix({0.1, 0.3, 0.2});
  const double closing[] = {1.0, 0.2}, impulse[] = {0.9, 0.4};
  double work[2], scaled[2];
  const double s = ConservativeScale(matrix.View(), closing, impulse, work);
  for (int i = 0; i < 2; ++i) scaled[i] = s * impulse[i];
  EXPECT_GT(KineticEnergyChange(matrix.View(), closing, impulse, work), 0.1);
  EXPECT_NEAR(KineticEnergyChange(matrix.View(), closing, scaled, work), 0, 1e-15);
  EXPECT_LT(PassiveScale(matrix.View(), closing, impulse, work), 1);
}

// A ball that bounced to and fro between two walls: no factor changes what the pushes do together.
// Found by the law fuzzer.
TEST(Passivity, TheGainOfPushesThatCancelIsRemoved) {
  const int row_start[] = {0, 2, 4}, column[] = {0, 1, 0, 1};
  const double value[] = {5, -5, -5, 5}, diagonal[] = {5, 5};
  const DelassusMatrix W{2, row_start, column, value, diagonal};
  const double closing[] = {0.3, -0.3};
  double impulse[] = {0.12, 0.12 + 1e-8}, moment[] = {0.6, 1.2}, work[6];
  EXPECT_EQ(ConservativeScale(W, closing, impulse, work), 0);
  EXPECT_GT(KineticEnergyChange(W, closing, impulse, work), 1e-9);
  RemoveGain(W, closing, impulse, moment, work);
  // the last bits of .036 J
  EXPECT_NEAR(KineticEnergyChange(W, closing, impulse, work), 0, 1e-16);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(impulse[k], 0.12, 2e-8);
    EXPECT_NEAR(moment[k] / impulse[k], k == 0 ? 5 : 10, 1e-6);
  }
}

// The same as an impact of the law: what the pushes of even numbers of bounces do together is the
// error of the integration: a gain at this tolerance.
TEST(ImpactLaw, ABallBetweenTwoWallsGainsNothing) {
  const int row_start[] = {0, 2, 4}, column[] = {0, 1, 0, 1};
  const double value[] = {5, -5, -5, 5}, diagonal[] = {5, 5};
  const DelassusMatrix W{2, row_start, column, value, diagonal};
  const double closing[] = {0.3, -0.3}, stiffness[] = {1e10, 1e10}, e[] = {1, 1};
  int even = 0;
  for (int i = 1; i <= 40; ++i) {
    const double gap[] = {0, 2e-5};
    const double horizon = 1e-4 * i;
    const ImpactProblem problem{W, closing, gap, stiffness, e, kBi, horizon, horizon, 1e-3};
    double impulse[2], moment[2], onset[2], after[2];
    std::vector<double> numbers(ImpactNumbers(2));
    std::vector<int> indices(ImpactIndices(2));
    ImpactSolution solution{impulse, moment, onset, after};
    SolveImpact(problem, true, &solution, {numbers.data(), indices.data()});
    even += std::abs(impulse[0] - impulse[1]) < 1e-3 * impulse[0];
    double work[2];
    // rounding of an energy of 9 mJ
    EXPECT_LE(KineticEnergyChange(W, closing, impulse, work), 1e-15) << horizon;
  }
  EXPECT_GT(even, 5);
}

TEST(Passivity, PushesThatGainNothingAreLeftAsTheyAre) {
  const RowMatrix matrix({0.1, 0.3, 0.2});
  const double closing[] = {1.0, 0.2};
  double impulse[] = {0.05, 0.01}, moment[] = {1, 2}, work[6];
  RemoveGain(matrix.View(), closing, impulse, moment, work);
  EXPECT_EQ(impulse[0], 0.05);
  EXPECT_EQ(moment[1], 2);
}

TEST(Passivity, ImpulsesOnOpeningContactsAreRefused) {
  const RowMatrix matrix({0.1, 0.3});
  const double closing[] = {-1.0}, impulse[] = {0.5};
  double work[1];
  EXPECT_EQ(PassiveScale(matrix.View(), closing, impulse, work), 0);
}

}  // namespace
}  // namespace mujoco_impact::law
