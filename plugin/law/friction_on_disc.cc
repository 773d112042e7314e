// SPDX-License-Identifier: Apache-2.0

#include "law/friction_on_disc.h"

#include <algorithm>
#include <cmath>

namespace mujoco_impact::law {

namespace {

// A part of the trace, below which a difference is rounding.
constexpr double kNothing = 1e-9;

double Dot(Pair x, Pair y) {
  const Pair product = x * y;
  return product[0] + product[1];
}

bool IsRound(const Tangents& A) {
  return std::abs(A.b) + std::abs(A.a - A.c) < kNothing * (A.a + A.c);
}

Pair Times(const Tangents& A, Pair x) {
  return Pair{A.a * x[0] + A.b * x[1], A.b * x[0] + A.c * x[1]};
}

// (A + λ)⁻¹ g
Pair Solve(const Tangents& A, double lambda, Pair g) {
  const double a = A.a + lambda, c = A.c + lambda, inverse = 1 / (a * c - A.b * A.b);
  return Pair{inverse * (c * g[0] - A.b * g[1]), inverse * (a * g[1] - A.b * g[0])};
}

// The p = −(A + λ)⁻¹ g with |p| = R, λ ≥ 0, for a p with λ = 0 that is longer.
Pair OnRim(const Tangents& A, Pair g, double R) {
  const double length = std::sqrt(Dot(g, g));
  if (IsRound(A)) return -R / length * g;
  // Newton's method for 1/|p| = 1/R, which is concave in λ and nearly straight, from the left
  double lambda =
      std::max(0.0, length / R - 0.5 * (A.a + A.c) - std::hypot(0.5 * (A.a - A.c), A.b));
  Pair p = Solve(A, lambda, g);
  constexpr int kMost = 30;
  for (int i = 0; i < kMost; ++i) {
    const double square = Dot(p, p), size = std::sqrt(square);
    if (std::abs(size - R) <= kNothing * R) break;
    // d|p|²/dλ = −2 p·(A + λ)⁻¹ p
    lambda = std::max(0.0, lambda + (size / R - 1) * square / Dot(p, Solve(A, lambda, p)));
    p = Solve(A, lambda, g);
  }
  return -R / std::sqrt(Dot(p, p)) * p;
}

}  // namespace

Tangents Lifted(const double tt[2][2]) {
  const double lift = kNothing * (tt[0][0] + tt[1][1]);
  return {tt[0][0] + lift, 0.5 * (tt[0][1] + tt[1][0]), tt[1][1] + lift};
}

Pair FrictionOfStep(const Tangents& A, Pair v, Pair b, double R) {
  const Pair sticks = -Solve(A, 0, b);
  if (Dot(sticks, sticks) <= R * R) return sticks;
  const Pair g = v + b, free = Solve(A, 0, g);
  if (Dot(free, free) > R * R) {
    const Pair p = OnRim(A, g, R);
    if (Dot(b + Times(A, p), p) <= 0) return p;
  }
  return OnRim(A, b, R);
}

}  // namespace mujoco_impact::law
