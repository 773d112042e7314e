// SPDX-License-Identifier: Apache-2.0

#include "law/passivity.h"

#include <algorithm>
#include <cmath>

namespace mujoco_impact::law {

namespace {

double Dot(const double* a, const double* b, int n) {
  double sum = 0;
  for (int i = 0; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

double KineticEnergyChange(const DelassusMatrix& delassus, const double* closing_speed,
                           const double* impulse, double* work) {
  Multiply(delassus, impulse, work);
  // ΔT = −cᵀ P + ½ Pᵀ W P
  return -Dot(closing_speed, impulse, delassus.size) + 0.5 * Dot(impulse, work, delassus.size);
}

double ConservativeScale(const DelassusMatrix& delassus, const double* closing_speed,
                         const double* impulse, double* work) {
  Multiply(delassus, impulse, work);
  const double quadratic = Dot(impulse, work, delassus.size);
  const double linear = Dot(closing_speed, impulse, delassus.size);
  if (quadratic <= 0 || linear <= 0) return 0;
  // s* = 2 cᵀP / (Pᵀ W P)
  return 2 * linear / quadratic;
}

void RemoveGain(const DelassusMatrix& delassus, const double* closing_speed, double* impulse,
                double* moment, double* work) {
  const int n = delassus.size;
  const double gain = KineticEnergyChange(delassus, closing_speed, impulse, work);
  if (gain <= 0) return;
  double *after = work, *step = work + n, *answer = work + 2 * n;
  for (int k = 0; k < n; ++k) {
    after[k] = closing_speed[k] - after[k];
    step[k] = impulse[k] > 0 ? after[k] / delassus.diagonal[k] : 0;
  }
  Multiply(delassus, step, answer);
  const double slope = Dot(after, step, n), curvature = Dot(step, answer, n);
  const double discriminant = slope * slope - 2 * curvature * gain;
  if (slope <= 0 || discriminant < 0) return;
  const double lambda = 2 * gain / (slope + std::sqrt(discriminant));
  for (int k = 0; k < n; ++k) {
    if (impulse[k] <= 0) continue;
    const double changed = std::max(0.0, impulse[k] + lambda * step[k]);
    moment[k] *= changed / impulse[k];
    impulse[k] = changed;
  }
}

double PassiveScale(const DelassusMatrix& delassus, const double* closing_speed,
                    const double* impulse, double* work) {
  return std::min(1.0, ConservativeScale(delassus, closing_speed, impulse, work));
}

}  // namespace mujoco_impact::law
