// SPDX-License-Identifier: Apache-2.0

#include "law/impact_clock.h"

#include <algorithm>
#include <limits>

#include "law/hertz_contact.h"

namespace mujoco_impact::law {

ImpactScale MeasureScale(const ImpactProblem& problem) {
  const DelassusMatrix& W = problem.delassus;
  ImpactScale scale{0, 0, 0};
  int fastest = 0;
  for (int k = 0; k < W.size; ++k) {
    if (problem.closing_speed[k] > scale.speed) {
      scale.speed = problem.closing_speed[k];
      fastest = k;
    }
  }
  if (scale.speed == 0) return scale;
  scale.compression =
      MaximumCompression(problem.stiffness[fastest], 1 / W.diagonal[fastest], scale.speed);
  scale.time = std::numeric_limits<double>::infinity();
  for (int k = 0; k < W.size; ++k) {
    scale.time =
        std::min(scale.time, ContactTime(problem.stiffness[k], 1 / W.diagonal[k], scale.speed));
  }
  return scale;
}

bool ImpactIsOver(const ImpactProblem& problem, const ImpactScale& scale, double t,
                  const double* compression, const double* closing_speed) {
  const double y_floor = kCompressionFloor * scale.compression;
  const double c_floor = kSpeedFloor * scale.speed;
  for (int k = 0; k < problem.delassus.size; ++k) {
    if (compression[k] > y_floor) return false;
    const double c = closing_speed[k];
    const bool closes_in_time = -compression[k] < c * (problem.horizon - t);
    if (c > c_floor && (compression[k] >= 0 || closes_in_time)) return false;
  }
  return true;
}

bool AnyCompressed(int size, const double* compression) {
  return std::any_of(compression, compression + size, [](double y) { return y > 0; });
}

double FlyToNextClosing(const ImpactProblem& problem, double t, double* compression,
                        const double* closing_speed) {
  const int n = problem.delassus.size;
  double flight = std::numeric_limits<double>::infinity();
  int next = -1;
  for (int k = 0; k < n; ++k) {
    if (closing_speed[k] <= 0) continue;
    const double arrival = -compression[k] / closing_speed[k];
    if (arrival < flight) {
      flight = arrival;
      next = k;
    }
  }
  if (next < 0 || t + flight > problem.horizon) return -1;
  for (int k = 0; k < n; ++k) compression[k] += flight * closing_speed[k];
  compression[next] = 0;
  return flight;
}

}  // namespace mujoco_impact::law
