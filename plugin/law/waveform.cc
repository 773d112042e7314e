// SPDX-License-Identifier: Apache-2.0

#include "law/waveform.h"

#include <cmath>
#include <numbers>

namespace mujoco_impact::law {

namespace {

constexpr double kHalfPi = std::numbers::pi / 2;

// Integrals of s·sin(k s) and s·cos(k s) from 0 to t, k = π/(2w).
double SineMoment(double t, double w) {
  const double k = kHalfPi / w;
  return (std::sin(k * t) - k * t * std::cos(k * t)) / (k * k);
}

double CosineMoment(double t, double w) {
  const double k = kHalfPi / w;
  return (std::cos(k * t) - 1 + k * t * std::sin(k * t)) / (k * k);
}

}  // namespace

double WaveformHeight(double impulse, double duration) { return kHalfPi * impulse / duration; }

double WaveformImpulse(double height, double duration) { return height * duration / kHalfPi; }

double WaveformForce(double t, double restitution) {
  if (t < 0 || t > 1) return 0;
  const double w_c = 1 / (1 + restitution);
  if (t <= w_c) return kHalfPi * std::sin(kHalfPi * t / w_c);
  return kHalfPi * std::cos(kHalfPi * (t - w_c) / (restitution * w_c));
}

double WaveformCumulative(double t, double restitution) {
  if (t <= 0) return 0;
  if (t >= 1) return 1;
  const double w_c = 1 / (1 + restitution);
  const double w_e = restitution * w_c;
  // ∫ sin = w_c (1 − cos) while compressing, w_c + w_e sin while expanding
  if (t <= w_c) return w_c * (1 - std::cos(kHalfPi * t / w_c));
  return w_c + w_e * std::sin(kHalfPi * (t - w_c) / w_e);
}

double WaveformMoment(double t, double restitution) {
  if (t <= 0) return 0;
  if (t > 1) t = 1;
  const double w_c = 1 / (1 + restitution);
  const double w_e = restitution * w_c;
  // unit area and duration: H = π/2
  if (t <= w_c) return kHalfPi * SineMoment(t, w_c);
  const double s = t - w_c;
  const double area = w_e * std::sin(kHalfPi * s / w_e);
  return kHalfPi * (SineMoment(w_c, w_c) + CosineMoment(s, w_e)) + w_c * area;
}

}  // namespace mujoco_impact::law
