// SPDX-License-Identifier: Apache-2.0

#include "law/friction_guard.h"

#include <algorithm>
#include <cmath>

#include "law/impact_clock.h"

namespace mujoco_impact::law {

namespace {

// Linear and quadratic part of the change of energy by s times the impulses.
struct Work {
  double linear, quadratic;  // −ΔT = linear s − quadratic s²/2
};

Work WorkOf(const ImpactProblem& problem, const ImpactSolution& solution) {
  Work work{0, 0};
  for (int k = 0; k < problem.delassus.size; ++k) {
    const double c = problem.closing_speed[k], P = solution.impulse[k];
    work.linear += c * P;
    work.quadratic += (c - solution.closing_speed[k]) * P;
  }
  for (int i = 0; i < 2 * problem.delassus.size; ++i) {
    const double v = problem.friction->slip[i], P = solution.friction[i];
    work.linear -= v * P;
    work.quadratic += (solution.slip[i] - v) * P;
  }
  return work;
}

void Scale(double factor, int n, double* x) {
  for (int i = 0; i < n; ++i) x[i] *= factor;
}

void ScaleAll(double factor, int n, ImpactSolution& solution) {
  Scale(factor, n, solution.impulse);
  Scale(factor, n, solution.moment);
  Scale(factor, 2 * n, solution.friction);
  Scale(factor, 2 * n, solution.friction_moment);
}

}  // namespace

double KineticEnergyChange(const ImpactProblem& problem, const ImpactSolution& solution) {
  const Work work = WorkOf(problem, solution);
  return 0.5 * work.quadratic - work.linear;
}

void RemoveGain(const ImpactProblem& problem, ImpactSolution& solution) {
  const auto [linear, quadratic] = WorkOf(problem, solution);
  if (0.5 * quadratic <= linear) return;
  ScaleAll(std::max(0.0, 2 * linear / quadratic), problem.delassus.size, solution);
  SpeedsAfter(problem, solution);
}

}  // namespace mujoco_impact::law
