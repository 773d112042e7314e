// SPDX-License-Identifier: Apache-2.0

#include "law/passivity.h"

#include <algorithm>

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

double PassiveScale(const DelassusMatrix& delassus, const double* closing_speed,
                    const double* impulse, double* work) {
  return std::min(1.0, ConservativeScale(delassus, closing_speed, impulse, work));
}

}  // namespace mujoco_impact::law
