// SPDX-License-Identifier: Apache-2.0

#include "law/plastic_end.h"

#include <algorithm>
#include <cmath>

#include "law/impact_clock.h"

namespace mujoco_impact::law {

namespace {

// The sweeps over all contacts, of a number that is even: they go to and fro.
constexpr double kFewestSweeps = 10, kMostSweeps = 400;

class Sweeps {
 public:
  // `closing` is c', and c' − W P' in the end; `allowed` g / t_left.
  Sweeps(const DelassusMatrix& W, double* closing, const double* allowed, double* impulse)
      : W_(W), closing_(closing), allowed_(allowed), impulse_(impulse) {
    std::fill_n(impulse, W.size, 0.0);
    if (W.by_body) std::fill_n(W.by_body->work, W.by_body->dofs(), 0.0);
  }

  // One over all contacts; returns the largest change of a closing speed by its own impulse.
  double Run(bool backwards) {
    double largest = 0;
    for (int i = 0; i < W_.size; ++i) {
      const int k = backwards ? W_.size - 1 - i : i;
      const double excess = Closing(k) - allowed_[k];
      const double change = std::max(-impulse_[k], excess / W_.diagonal[k]);
      if (change == 0) continue;
      Push(k, change);
      largest = std::max(largest, std::abs(change) * W_.diagonal[k]);
    }
    return largest;
  }

 private:
  double Closing(int k) const {
    return W_.by_body ? closing_[k] - RowTimes(*W_.by_body, k, W_.by_body->work) : closing_[k];
  }

  void Push(int k, double change) {
    impulse_[k] += change;
    if (W_.by_body) return AddAnswer(*W_.by_body, k, change, W_.by_body->work);
    ForRow(W_, k, [&](int l, double coupling) { closing_[l] -= coupling * change; });
  }

  const DelassusMatrix& W_;
  double* closing_;
  const double* allowed_;
  double* impulse_;
};

// g / t_left, g = max(0, g₀ − c t + W (t P − M)) where the bodies are at time t.
void AllowedSpeeds(const ImpactProblem& problem, double t, const ImpactSolution& solution,
                   double* lever, double* allowed) {
  const int n = problem.delassus.size;
  for (int k = 0; k < n; ++k) lever[k] = t * solution.impulse[k] - solution.moment[k];
  Multiply(problem.delassus, lever, allowed);
  const double time_left = std::max(problem.horizon - t, 0.0);
  for (int k = 0; k < n; ++k) {
    const double gap = problem.gap[k] - problem.closing_speed[k] * t + allowed[k];
    allowed[k] = gap > 0 ? gap / time_left : 0;
  }
}

}  // namespace

double EndPlastically(const ImpactProblem& problem, double t, ImpactSolution* solution,
                      const Workspace& workspace) {
  const DelassusMatrix& W = problem.delassus;
  const int n = W.size;
  double *impulse = workspace.numbers, *allowed = impulse + n, *closing = allowed + n;
  AllowedSpeeds(problem, t, *solution, impulse, allowed);
  SpeedsAfter(problem, *solution);
  std::copy_n(solution->closing_speed, n, closing);

  Sweeps sweeps(W, closing, allowed, impulse);
  const double cost = Cost(W) + n;
  const int most = static_cast<int>(std::clamp(problem.work / cost, kFewestSweeps, kMostSweeps));
  const double floor = problem.tolerance * MeasureScale(problem).speed;
  int done = 0;
  while (done < most && sweeps.Run(done % 2 == 1) > floor) ++done;

  for (int k = 0; k < n; ++k) {
    if (impulse[k] <= 0) continue;
    if (solution->impulse[k] <= 0) solution->onset[k] = t;
    solution->impulse[k] += impulse[k];
    solution->moment[k] += t * impulse[k];
  }
  return (done + 3) * cost;
}

}  // namespace mujoco_impact::law
