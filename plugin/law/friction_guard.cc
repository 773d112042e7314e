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

// P + λ d, d = D⁻¹ c' (passivity.h), with the smaller root λ.
void Redistribute(const ImpactProblem& problem, double gain, ImpactSolution& solution,
                  double* work) {
  const DelassusMatrix& W = problem.delassus;
  double *step = work, *answer = work + W.size;
  double slope = 0, curvature = 0;
  for (int k = 0; k < W.size; ++k) {
    const double after = solution.closing_speed[k];
    step[k] = solution.impulse[k] > 0 ? after / W.diagonal[k] : 0;
    slope += after * step[k];
  }
  Multiply(W, step, answer);
  for (int k = 0; k < W.size; ++k) curvature += step[k] * answer[k];
  const double discriminant = slope * slope - 2 * curvature * gain;
  if (slope <= 0 || discriminant < 0) return;
  const double lambda = 2 * gain / (slope + std::sqrt(discriminant));
  for (int k = 0; k < W.size; ++k) {
    const double P = solution.impulse[k];
    if (P <= 0) continue;
    const double factor = std::max(0.0, 1 + lambda * step[k] / P);
    solution.impulse[k] *= factor;
    solution.moment[k] *= factor;
    if (factor >= 1) continue;
    // within the cone
    Scale(factor, 2, solution.friction + 2 * k);
    Scale(factor, 2, solution.friction_moment + 2 * k);
  }
}

}  // namespace

double KineticEnergyChange(const ImpactProblem& problem, const ImpactSolution& solution) {
  const Work work = WorkOf(problem, solution);
  return 0.5 * work.quadratic - work.linear;
}

void RemoveGain(const ImpactProblem& problem, ImpactSolution& solution, double* work) {
  const int n = problem.delassus.size;
  constexpr double kLeastScale = 0.9;  // a factor below is no correction: the pushes cancel
  for (int pass = 0; pass < 2; ++pass) {
    const auto [linear, quadratic] = WorkOf(problem, solution);
    if (0.5 * quadratic <= linear) return;
    const double scale = 2 * linear / quadratic;
    if (pass == 0 && scale < kLeastScale) {
      Redistribute(problem, 0.5 * quadratic - linear, solution, work);
    } else {
      ScaleAll(std::max(0.0, scale), n, solution);
    }
    SpeedsAfter(problem, solution);
  }
}

}  // namespace mujoco_impact::law
