// SPDX-License-Identifier: Apache-2.0

#include "law/impact_clock.h"

#include <algorithm>

namespace mujoco_impact::law {

namespace {

// The longest flight to a next closing that still belongs to the impact.
double LongestFlight(const ImpactProblem& problem, const ImpactScale& scale, double t) {
  const double same_impact = kSameImpactTimes * scale.time;
  return std::min(std::max(problem.flight, same_impact), problem.horizon + same_impact - t);
}

}  // namespace

bool IsOver(const ImpactProblem& problem, const ImpactScale& scale, const Window& window, double t,
            const double* y, const double* c) {
  const double y_floor = kCompressionFloor * scale.compression;
  const double c_floor = kSpeedFloor * scale.speed;
  const double time_left = LongestFlight(problem, scale, t);
  for (int i = 0; i < window.size(); ++i) {
    const int k = window[i];
    if (y[k] > y_floor) return false;
    const bool closes_in_time = y[k] >= 0 || -y[k] < c[k] * time_left;
    if (c[k] > c_floor && closes_in_time) return false;
  }
  return window.NextArrival() >= t + time_left;
}

bool AnyCompressed(const Window& window, const double* y) {
  for (int i = 0; i < window.size(); ++i) {
    if (y[window[i]] > 0) return true;
  }
  return false;
}

bool FlyToNextClosing(const ImpactProblem& problem, const ImpactScale& scale, const Window& window,
                      double* t, double* y, const double* c) {
  const double longest = LongestFlight(problem, scale, *t);
  double flight = std::min(longest, window.NextArrival() - *t);
  int next = -1;
  for (int i = 0; i < window.size(); ++i) {
    const int k = window[i];
    if (c[k] <= 0 || -y[k] > flight * c[k]) continue;
    flight = -y[k] / c[k];
    next = k;
  }
  if (next < 0 && flight >= longest) return false;
  for (int i = 0; i < window.size(); ++i) y[window[i]] += flight * c[window[i]];
  if (next >= 0) y[next] = 0;
  *t += flight;
  return true;
}

void SpeedsAfter(const ImpactProblem& problem, ImpactSolution& solution) {
  Multiply(problem.delassus, solution.impulse, solution.closing_speed);
  for (int k = 0; k < problem.delassus.size; ++k) {
    solution.closing_speed[k] = problem.closing_speed[k] - solution.closing_speed[k];
  }
}

}  // namespace mujoco_impact::law
