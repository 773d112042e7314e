// SPDX-License-Identifier: Apache-2.0
// Impacts of straight rows of balls, shared by the tests of the law layer.

#ifndef MUJOCO_IMPACT_TESTS_ROWS_H_
#define MUJOCO_IMPACT_TESTS_ROWS_H_

#include <cstddef>
#include <limits>
#include <vector>

#include "law/impact_law.h"

namespace mujoco_impact::law {

// A row of balls on a line, ball k at k; the first `incoming` balls move with speed 1.
struct Row {
  std::vector<double> mass;
  int incoming = 1;
  std::vector<double> stiffness;  // per contact; empty: 1e10 each
  std::vector<double> gap;        // per contact; empty: touching
};

struct RowResult {
  std::vector<double> velocity;  // after the impact
  std::vector<double> impulse, moment, onset;
  ImpactReport report;
};

struct RowOptions {
  double restitution = 1;                 // of every contact
  std::vector<double> restitutions = {};  // of each; empty: the one above
  Dissipation dissipation = Dissipation::kBistiffness;
  double tolerance = kDefaultTolerance;
  double horizon = std::numeric_limits<double>::infinity();
  bool passive = true;
};

// The tridiagonal Delassus matrix of a row.
struct RowMatrix {
  std::vector<int> row_start{0}, column;
  std::vector<double> value, diagonal;

  explicit RowMatrix(const std::vector<double>& mass) {
    const int n = static_cast<int>(mass.size()) - 1;
    for (int k = 0; k < n; ++k) {
      if (k > 0) Add(k - 1, -1 / mass[k]);
      Add(k, 1 / mass[k] + 1 / mass[k + 1]);
      diagonal.push_back(value.back());
      if (k + 1 < n) Add(k + 1, -1 / mass[k + 1]);
      row_start.push_back(static_cast<int>(column.size()));
    }
  }

  DelassusMatrix View() const {
    return {static_cast<int>(diagonal.size()), row_start.data(), column.data(), value.data(),
            diagonal.data()};
  }

 private:
  void Add(int k, double w) {
    column.push_back(k);
    value.push_back(w);
  }
};

inline RowResult Collide(const Row& row, const RowOptions& options = {}) {
  const std::size_t n = row.mass.size() - 1;
  const RowMatrix matrix(row.mass);
  std::vector<double> closing(n, 0.0), gap = row.gap, stiffness = row.stiffness;
  if (gap.empty()) gap.assign(n, 0.0);
  if (stiffness.empty()) stiffness.assign(n, 1e10);
  closing[row.incoming - 1] = 1;
  std::vector<double> restitution = options.restitutions;
  if (restitution.empty()) restitution.assign(n, options.restitution);
  const ImpactProblem problem{matrix.View(),    closing.data(),     gap.data(),
                              stiffness.data(), restitution.data(), options.dissipation,
                              options.horizon,  options.horizon,    options.tolerance};
  const int size = static_cast<int>(n);
  std::vector<double> numbers(ImpactNumbers(size)), after(n);
  std::vector<int> indices(ImpactIndices(size));
  // poisoned, so that a law that writes nothing cannot pass
  const double poison = std::numeric_limits<double>::quiet_NaN();
  RowResult result;
  result.impulse.assign(n, poison);
  result.moment.assign(n, poison);
  result.onset.assign(n, poison);
  ImpactSolution solution{result.impulse.data(), result.moment.data(), result.onset.data(),
                          after.data()};
  result.report =
      SolveImpact(problem, options.passive, &solution, {numbers.data(), indices.data()});
  for (std::size_t i = 0; i <= n; ++i) {
    double v = static_cast<int>(i) < row.incoming ? 1 : 0;
    if (i > 0) v += result.impulse[i - 1] / row.mass[i];
    if (i < n) v -= result.impulse[i] / row.mass[i];
    result.velocity.push_back(v);
  }
  return result;
}

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_TESTS_ROWS_H_
