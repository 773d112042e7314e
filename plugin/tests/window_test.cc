// SPDX-License-Identifier: Apache-2.0
// Long islands, of which the law integrates only the part where something happens.

#include "law/window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "law/hertz_contact.h"
#include "law/impact_clock.h"
#include "law/impact_law.h"
#include "tests/rows.h"

namespace mujoco_impact::law {
namespace {

constexpr double kMass = 0.115, kStiffness = 1e10;

// The contacts of a row of equal balls, numbered by `order`.
struct Contacts {
  std::vector<int> row_start{0}, column;
  std::vector<double> value, diagonal, closing, gap, stiffness, impulse, moment, onset, after;

  Contacts(const std::vector<double>& row_closing, const std::vector<double>& row_gap,
           const std::vector<int>& order)
      : diagonal(order.size(), 2 / kMass), stiffness(order.size(), kStiffness) {
    const int n = static_cast<int>(order.size());
    std::vector<int> number(n);
    for (int k = 0; k < n; ++k) number[order[k]] = k;
    for (int k = 0; k < n; ++k) {
      const int place = order[k];
      for (int beside = std::max(0, place - 1); beside <= std::min(n - 1, place + 1); ++beside) {
        column.push_back(number[beside]);
        value.push_back((beside == place ? 2 : -1) / kMass);
      }
      row_start.push_back(static_cast<int>(column.size()));
      closing.push_back(row_closing[place]);
      gap.push_back(row_gap[place]);
    }
  }

  ImpactReport Solve(double horizon, double tolerance) {
    const int n = static_cast<int>(closing.size());
    for (auto* result : {&impulse, &moment, &onset, &after}) result->assign(n, std::nan(""));
    const std::vector<double> restitution(n, 1.0);
    const ImpactProblem problem{{n, row_start.data(), column.data(), value.data(), diagonal.data()},
                                closing.data(),
                                gap.data(),
                                stiffness.data(),
                                restitution.data(),
                                Dissipation::kBistiffness,
                                horizon,
                                horizon,
                                tolerance};
    std::vector<double> numbers(ImpactNumbers(n));
    std::vector<int> indices(ImpactIndices(n));
    ImpactSolution solution{impulse.data(), moment.data(), onset.data(), after.data()};
    return SolveImpact(problem, true, &solution, {numbers.data(), indices.data()});
  }
};

std::vector<int> InOrder(int n) {
  std::vector<int> order(n);
  std::iota(order.begin(), order.end(), 0);
  return order;
}

class LongRow : public testing::TestWithParam<int> {};  // number of contacts, odd and even

INSTANTIATE_TEST_SUITE_P(Sizes, LongRow, testing::Values(9, 12, 25, 40));

// A row is solved by vectors if its contacts come in order, by compressed rows if not.
TEST_P(LongRow, TheOrderOfTheContactsChangesNothing) {
  const int n = GetParam();
  std::vector<double> closing(n, 0.0), gap(n, 0.0);
  closing[0] = 1;
  std::vector<int> shuffled = InOrder(n);
  std::mt19937 random(5);
  std::shuffle(shuffled.begin(), shuffled.end(), random);
  Contacts in_order(closing, gap, InOrder(n)), mixed(closing, gap, shuffled);
  const ImpactReport first = in_order.Solve(1, kDefaultTolerance);
  const ImpactReport second = mixed.Solve(1, kDefaultTolerance);
  EXPECT_EQ(first.steps, second.steps);
  for (int k = 0; k < n; ++k) {
    // sums of three numbers in another order: rounding only
    EXPECT_NEAR(mixed.impulse[k], in_order.impulse[shuffled[k]], 1e-13);
  }
}

TEST_P(LongRow, ToleranceSetsTheErrorOfAWave) {
  const int n = GetParam();
  std::vector<double> closing(n, 0.0), gap(n, 0.0);
  closing[0] = 1;
  Contacts exact(closing, gap, InOrder(n)), coarse(closing, gap, InOrder(n));
  exact.Solve(1, 1e-10);
  coarse.Solve(1, 1e-3);
  // a step may err by the tolerance, and most of its error is forgotten as the wave goes on
  for (int k = 0; k < n; ++k)
    EXPECT_NEAR(coarse.impulse[k] / kMass, exact.impulse[k] / kMass, 1e-3);
}

// Balls on their way to each other all along a row: small gaps, random speeds.
Contacts LooseRow(int contacts, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> closing(contacts), gap(contacts);
  for (double& c : closing) c = 0.2 * (uniform(random) - 0.5);
  for (double& y : gap) y = 2e-5 * uniform(random);
  return {closing, gap, InOrder(contacts)};
}

// In a long row of loosely packed balls something always closes soon.
TEST(LateClosings, WaitForTheNextStep) {
  constexpr double kHorizon = 2e-3;
  Contacts gas = LooseRow(80, 7);
  const ImpactReport report = gas.Solve(kHorizon, kDefaultTolerance);
  EXPECT_TRUE(report.converged);
  const double last = *std::max_element(gas.onset.begin(), gas.onset.end());
  const double fastest = *std::max_element(gas.closing.begin(), gas.closing.end());
  const double contact = ContactTime(kStiffness, kMass / 2, fastest);
  EXPECT_GT(last, 0.5 * kHorizon);
  // what is under way at the horizon is finished, and a wave may run some contacts on
  EXPECT_LT(last, kHorizon + (kSameImpactTimes + 10) * contact);
}

}  // namespace
}  // namespace mujoco_impact::law
