// SPDX-License-Identifier: Apache-2.0

#include "law/short_end.h"

#include <algorithm>

#include "law/impact_clock.h"
#include "law/stopping_impulses.h"

namespace mujoco_impact::law {

namespace {

// Of the work: what is left for the plastic end, and the most that one p before it may take.
constexpr double kOfPlasticEnd = 0.5, kOfOne = 0.25;

// g / t_left, g = max(0, g₀ − c t + W (t P − M)) where the bodies are at time t.
void FindBounds(const ImpactProblem& problem, double t, const ImpactSolution& solution,
                double* lever, double* bound) {
  const int n = problem.delassus.size;
  for (int k = 0; k < n; ++k) lever[k] = t * solution.impulse[k] - solution.moment[k];
  Multiply(problem.delassus, lever, bound);
  if (problem.friction) {
    for (int i = 0; i < 2 * n; ++i) {
      lever[i] = t * solution.friction[i] - solution.friction_moment[i];
    }
    AddTangential(problem.delassus, *problem.friction, lever, bound);
  }
  const double time_left = std::max(problem.horizon - t, 0.0);
  for (int k = 0; k < n; ++k) {
    const double gap = problem.gap[k] - problem.closing_speed[k] * t + bound[k];
    bound[k] = gap > 0 ? gap / time_left : 0;
  }
}

// s* = 2 cᵀp / (pᵀ W p), at which p conserves energy.
double ConservingScale(const StoppingImpulses& stopping, const double* closing_speed, int size) {
  const double *p = stopping.impulse(), *after = stopping.after();
  double linear = 0, quadratic = 0;
  for (int k = 0; k < size; ++k) {
    linear += closing_speed[k] * p[k];
    quadratic += (closing_speed[k] - after[k]) * p[k];
  }
  return quadratic > 0 ? 2 * linear / quadratic : 1;
}

// Adds s p at time t.
void Give(double s, const StoppingImpulses& stopping, double t, int size,
          ImpactSolution& solution) {
  const double *p = stopping.impulse(), *after = stopping.after();
  for (int k = 0; k < size; ++k) {
    solution.closing_speed[k] += s * (after[k] - solution.closing_speed[k]);
    if (p[k] <= 0) continue;
    if (solution.impulse[k] <= 0) solution.onset[k] = t;
    solution.impulse[k] += s * p[k];
    solution.moment[k] += t * s * p[k];
  }
}

}  // namespace

double EndShort(const ImpactProblem& problem, double t, ImpactSolution* solution,
                const Workspace& workspace) {
  const int n = problem.delassus.size;
  double *bound = workspace.numbers, *numbers = bound + n;
  FindBounds(problem, t, *solution, numbers, bound);
  SpeedsAfter(problem, *solution);
  const double* c = solution->closing_speed;
  const double e = *std::min_element(problem.restitution, problem.restitution + n);
  const double work = problem.work_of_end;
  // far below what an impact is solved to: what sweeps leave depends on the order of the contacts
  const double floor = 0.01 * problem.tolerance * MeasureScale(problem).speed;
  StoppingImpulses stopping(problem.delassus, numbers);
  while (e > 0 && stopping.work() < (1 - kOfPlasticEnd) * work) {
    if (!stopping.Solve(c, bound, floor, kOfOne * work)) return stopping.work();
    const double s = ConservingScale(stopping, c, n);
    Give(e == 1 ? s : std::min(1 + e, s), stopping, t, n, *solution);
  }
  if (stopping.Solve(c, bound, floor, kOfPlasticEnd * work)) Give(1, stopping, t, n, *solution);
  return stopping.work();
}

}  // namespace mujoco_impact::law
