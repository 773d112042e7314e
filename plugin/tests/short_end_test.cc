// SPDX-License-Identifier: Apache-2.0
// Impacts that are given less work than they need, and the matrix of contacts of the same bodies.

#include "law/short_end.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "law/impact_law.h"
#include "law/passivity.h"
#include "law/stopping_impulses.h"
#include "tests/rows.h"

namespace mujoco_impact::law {
namespace {

constexpr double kHorizon = 1e-3;

// Contacts between bodies of `dofs` degrees of freedom, M = 1, with rows and velocities at random.
// Body 0 is in all of them, every second joins another.
struct Heap {
  int size, bodies, dofs;
  std::vector<double> row, closing, diagonal, work, stiffness, gap;
  std::vector<BodyRow> part;
  std::vector<int> dof_start, contact_start{0}, contact, mark, row_start{0}, column;
  std::vector<double> value;
  BodyRows rows{};

  Heap(int contacts, int others, int dofs_each, unsigned seed)
      : size(contacts),
        bodies(others + 1),
        dofs(dofs_each),
        stiffness(contacts, 1e10),
        gap(contacts, 0.0) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    row.resize(2 * size * dofs);
    for (double& x : row) x = normal(random);
    for (int k = 0; k < size; ++k) {
      const int other = k % 2 == 1 && others > 0 ? 1 + k / 2 % others : -1;
      part.push_back({0, &row[2 * k * dofs], &row[2 * k * dofs]});
      part.push_back({other, &row[(2 * k + 1) * dofs], &row[(2 * k + 1) * dofs]});
      gap[k] = k % 3 == 0 ? 0 : 1e-4 * std::abs(normal(random));
    }
    for (int body = 0; body <= bodies; ++body) dof_start.push_back(body * dofs);
    for (int body = 0; body < bodies; ++body) {
      for (int k = 0; k < size; ++k) {
        if (part[2 * k].body == body || part[2 * k + 1].body == body) contact.push_back(k);
      }
      contact_start.push_back(static_cast<int>(contact.size()));
    }
    work.resize(3 * dof_start.back());
    mark.resize(bodies);
    rows = {bodies,         dof_start.data(), part.data(), contact_start.data(),
            contact.data(), work.data(),      mark.data()};
    std::vector<double> velocity(dof_start.back());
    for (double& v : velocity) v = normal(random);
    for (int k = 0; k < size; ++k) closing.push_back(-RowTimes(rows, k, velocity.data()));
    for (int k = 0; k < size; ++k) {
      diagonal.push_back(Coupling(rows, k, k));
      for (int l = 0; l < size; ++l) {
        column.push_back(l);
        value.push_back(Coupling(rows, k, l));
      }
      row_start.push_back(static_cast<int>(column.size()));
    }
  }

  DelassusMatrix ByBody() const {
    return {size, nullptr, nullptr, nullptr, diagonal.data(), &rows};
  }
  DelassusMatrix Compressed() const {
    return {size, row_start.data(), column.data(), value.data(), diagonal.data()};
  }
};

struct Solved {
  ImpactReport report;
  std::vector<double> impulse, moment, onset, after;
};

Solved Solve(const DelassusMatrix& W, const Heap& heap, double e, double work,
             double work_of_end = 1e7, Dissipation dissipation = Dissipation::kBistiffness) {
  const int n = W.size;
  const std::vector<double> restitution(n, e);
  ImpactProblem problem{W,
                        heap.closing.data(),
                        heap.gap.data(),
                        heap.stiffness.data(),
                        restitution.data(),
                        dissipation,
                        kHorizon,
                        kHorizon,
                        1e-6};
  problem.work = work;
  problem.work_of_end = work_of_end;
  Solved solved{{},
                std::vector<double>(n),
                std::vector<double>(n),
                std::vector<double>(n),
                std::vector<double>(n)};
  std::vector<double> numbers(ImpactNumbers(n));
  std::vector<int> indices(ImpactIndices(n));
  ImpactSolution solution{solved.impulse.data(), solved.moment.data(), solved.onset.data(),
                          solved.after.data()};
  solved.report = SolveImpact(problem, true, &solution, {numbers.data(), indices.data()});
  return solved;
}

double EnergyChange(const Heap& heap, const Solved& solved) {
  std::vector<double> work(heap.size);
  return KineticEnergyChange(heap.Compressed(), heap.closing.data(), solved.impulse.data(),
                             work.data());
}

// By what the fastest contact closes faster than its gap allows until the horizon.
double Excess(const Heap& heap, const Solved& solved) {
  double excess = 0;
  for (int k = 0; k < heap.size; ++k) {
    excess = std::max(excess, solved.after[k] - heap.gap[k] / kHorizon);
  }
  return excess;
}

class Heaps : public testing::TestWithParam<int> {};  // seeds

INSTANTIATE_TEST_SUITE_P(Seeds, Heaps, testing::Range(0, 10));

TEST_P(Heaps, BothFormsOfTheMatrixGiveTheSameProducts) {
  const Heap heap(40, 3, 5, GetParam());
  std::vector<double> one(heap.size), other(heap.size);
  Multiply(heap.ByBody(), heap.closing.data(), one.data());
  Multiply(heap.Compressed(), heap.closing.data(), other.data());
  // rounding of 40 terms of up to 20
  for (int k = 0; k < heap.size; ++k) EXPECT_NEAR(one[k], other[k], 1e-12) << k;
}

TEST_P(Heaps, BothFormsOfTheMatrixGiveTheSameImpact) {
  // as many degrees of freedom as contacts: the impulses are the only ones
  const Heap heap(12, 0, 14, GetParam());
  const Solved one = Solve(heap.ByBody(), heap, 1, 1e9);
  const Solved other = Solve(heap.Compressed(), heap, 1, 1e9);
  ASSERT_TRUE(one.report.converged);
  for (int k = 0; k < heap.size; ++k) EXPECT_NEAR(one.after[k], other.after[k], 1e-5) << k;
}

TEST_P(Heaps, ContactsOfOneBodyCostNotTheSquareOfTheirNumber) {
  const Heap few(50, 0, 6, GetParam()), many(500, 0, 6, GetParam());
  const double ratio = Cost(many.ByBody()) / Cost(few.ByBody());
  EXPECT_EQ(ratio, 10);
  EXPECT_LT(Cost(many.ByBody()), 0.1 * Cost(many.Compressed()));
}

TEST_P(Heaps, HoweverLittleWorkThereIsEnergyDoesNotGrow) {
  const Heap heap(30, 4, 6, GetParam());
  for (const auto dissipation : {Dissipation::kBistiffness, Dissipation::kViscous}) {
    for (const double e : {0.05, 0.5, 0.95}) {
      for (const double work : {0.0, 1e4, 1e5}) {
        for (const double work_of_end : {0.0, 1e4, 1e6}) {
          for (const DelassusMatrix& W : {heap.ByBody(), heap.Compressed()}) {
            const Solved solved = Solve(W, heap, e, work, work_of_end, dissipation);
            EXPECT_LE(EnergyChange(heap, solved), 1e-12);
            EXPECT_GE(*std::min_element(solved.impulse.begin(), solved.impulse.end()), 0);
          }
        }
      }
    }
  }
}

TEST_P(Heaps, WhatIsEndedClosesNoMore) {
  const Heap heap(30, 4, 6, GetParam());
  for (const double e : {0.0, 0.5}) {
    const Solved solved = Solve(heap.ByBody(), heap, e, 0);
    ASSERT_FALSE(solved.report.converged);
    EXPECT_LT(EnergyChange(heap, solved), -0.1);
    // the tolerance of the law
    EXPECT_LT(Excess(heap, solved), 1e-4);
  }
}

TEST_P(Heaps, AnElasticImpactThatIsEndedKeepsItsEnergy) {
  // bodies that are free to go somewhere with all of their energy
  const Heap heap(12, 0, 14, GetParam());
  const Solved solved = Solve(heap.ByBody(), heap, 1, 0);
  ASSERT_FALSE(solved.report.converged);
  EXPECT_GT(*std::max_element(solved.impulse.begin(), solved.impulse.end()), 0.01);
  // rounding of an energy of 7
  EXPECT_NEAR(EnergyChange(heap, solved), 0, 1e-12);
  EXPECT_LT(Excess(heap, solved), 1e-4);
}

TEST_P(Heaps, TheWorkDoneIsTheWorkAllowed) {
  const Heap heap(60, 8, 6, GetParam());
  for (const double work : {1e5, 1e6}) {
    const Solved solved = Solve(heap.ByBody(), heap, 0.5, work, work);
    // a last step and a last product more
    EXPECT_LT(solved.report.work, 2 * work + 4e4);
  }
}

// Gauss-Seidel alone would take a sweep for each unit of the ratio of masses.
TEST(StoppingImpulses, StopALightBodyBetweenHeavyOnes) {
  const RowMatrix matrix({1e6, 1, 1e6});
  const double closing[] = {1, -0.5}, bound[] = {0, 0};
  const DelassusMatrix W = matrix.View();
  double numbers[2 * StoppingImpulses::kArrays];
  StoppingImpulses stopping(W, numbers);
  EXPECT_TRUE(stopping.Solve(closing, bound, 1e-9, 1e4));
  for (int k = 0; k < 2; ++k) EXPECT_NEAR(stopping.after()[k], 0, 1e-8);
  // all three go on together: the last takes a third of the first's momentum and the light one's
  EXPECT_NEAR(stopping.impulse()[1] / 1e6, 0.25, 1e-6);
}

TEST(StoppingImpulses, AContactMayCloseAsFarAsItsBound) {
  const RowMatrix matrix({1, 1, 1});
  const double closing[] = {1, 0}, bound[] = {0.25, 10};
  const DelassusMatrix W = matrix.View();
  double numbers[2 * StoppingImpulses::kArrays];
  StoppingImpulses stopping(W, numbers);
  EXPECT_TRUE(stopping.Solve(closing, bound, 1e-12, 1e4));
  EXPECT_NEAR(stopping.after()[0], 0.25, 1e-12);
  EXPECT_EQ(stopping.impulse()[1], 0);
  const double open[] = {0.2, -1};
  EXPECT_FALSE(stopping.Solve(open, bound, 1e-12, 1e4));
}

}  // namespace
}  // namespace mujoco_impact::law
