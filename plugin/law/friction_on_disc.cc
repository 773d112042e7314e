// SPDX-License-Identifier: Apache-2.0

#include "law/friction_on_disc.h"

#include <algorithm>
#include <cmath>

namespace mujoco_impact::law {

namespace {

// A part of the trace, or of a step, that is rounding.
constexpr double kNothing = 1e-9;

double Dot(Pair x, Pair y) {
  const Pair product = x * y;
  return product[0] + product[1];
}

double Length(Pair x) { return std::sqrt(Dot(x, x)); }

bool IsWithin(Pair p, double R) { return Dot(p, p) <= R * R; }

bool IsRound(const Tangents& A) {
  return std::abs(A.b) + std::abs(A.a - A.c) < kNothing * (A.a + A.c);
}

// (A + λ)⁻¹ g
Pair Solve(const Tangents& A, double lambda, Pair g) {
  const double a = A.a + lambda, c = A.c + lambda, inverse = 1 / (a * c - A.b * A.b);
  return Pair{inverse * (c * g[0] - A.b * g[1]), inverse * (a * g[1] - A.b * g[0])};
}

// The p = −(A + λ)⁻¹ g with |p| = R, λ ≥ 0, if that of λ = 0 is longer.
Pair OnRim(const Tangents& A, Pair g, double R) {
  const double length = Length(g);
  if (length == 0) return g;
  if (IsRound(A)) return -R / length * g;
  // Newton's method for 1/|p| = 1/R, which is nearly straight in λ, from where p is against g
  const Pair d = 1 / length * g;
  double lambda = std::max(0.0, length / R - Dot(d, Times(A, d)));
  Pair p = Solve(A, lambda, g);
  constexpr int kMost = 20;
  constexpr double kEnough = 1e-5;  // |p| is made R, and its direction changes slower
  double size = Length(p);
  for (int i = 0; i < kMost && std::abs(size - R) > kEnough * R; ++i) {
    // d|p|²/dλ = −2 p·(A + λ)⁻¹ p
    const double step = (size / R - 1) * size * size / Dot(p, Solve(A, lambda, p));
    lambda = std::max(0.0, lambda + step);
    p = Solve(A, lambda, g);
    size = Length(p);
  }
  return -R / size * p;
}

// Change of the slip that goes on as it is at the end, but for its own friction.
Pair RateAtEnd(const ContactStep& step) { return At(step.rate) - Times(step.A, At(step.ratio)); }

// p₁ up to the part θ of the step, then it slides.
StepFriction ThenSlides(const ContactStep& step, double theta, Pair p1) {
  const double rest = 1 - theta;
  if (rest <= kNothing) return {p1, p1, p1, 0};
  const Pair b = step.b + Times(step.A, p1), stops = -Times(step.inverse, b);
  const bool holds = IsWithin(stops, rest * step.R);  // until the end, where it begins to slide
  const Pair p2 = holds ? stops : OnRim(step.A, b, rest * step.R);
  const Pair ratio = holds ? OnRim(step.A, RateAtEnd(step), step.R) : 1 / rest * p2;
  return {p1 + p2, (2 - theta) * p1 + rest * p2, ratio, theta};
}

// A contact that has stuck: the ratio that keeps it so goes on as it went.
StepFriction AfterSticking(const ContactStep& step, Pair needed) {
  const double R = step.R;
  Pair start = 0.5 * (step.before + needed);
  if (!IsWithin(start, R)) start = step.before;
  const Pair way = 2 * (needed - start);
  if (IsWithin(start + way, R)) {
    // what sweeps have left of the slip is taken up as far as the cone goes
    const Pair stops = -Times(step.inverse, step.b);
    const Pair p = IsWithin(stops, R) ? stops : OnRim(step.A, step.b, R);
    return {p, p, needed, 0};
  }
  // |start + θ way| = R
  const double a = Dot(way, way), half = Dot(start, way), c = Dot(start, start) - R * R;
  const double root = std::sqrt(std::max(0.0, half * half - a * c));
  const double theta = std::clamp(-c / (half + root), 0.0, 1.0);
  return ThenSlides(step, theta, theta * (start + 0.5 * theta * way));
}

// A contact that slides until it stops, and sticks from there on.
StepFriction Stops(const ContactStep& step, Pair stops, Pair needed) {
  const double speed = Length(step.v);
  const Pair slides = speed > 0 ? -step.R / speed * step.v : needed;
  const double way = Length(slides - needed);
  const double theta = way > 0 ? std::min(1.0, Length(stops - needed) / way) : 0;
  const double rest = 1 - theta;
  return {stops, theta * (2 - theta) * slides + rest * rest * needed, needed, theta};
}

// A contact that slides, and whose slip changes its direction within the step: it stops on the way.
StepFriction ThroughZero(const ContactStep& step, double speed) {
  if (speed == 0) return ThenSlides(step, kNothing, Pair{});
  const Pair d = 1 / speed * step.v;
  // along the slip: what slows it down, and the rates at which all else changes it, of which the
  // second takes over where the change of the whole step says
  const double slows = step.R * Dot(d, Times(step.A, d));
  const double first = Dot(At(step.first_rate) - Times(step.A, step.before), d);
  const double second = Dot(RateAtEnd(step), d), mean = Dot(step.b - step.v, d);
  const double between = first - second;
  const double part =
      std::abs(between) > kNothing * slows ? std::clamp((mean - second) / between, 0.0, 1.0) : 1;
  double theta = slows > first ? speed / (slows - first) : 1;
  if (theta > part) {
    const double left = speed - (slows - first) * part;
    theta = slows > second ? std::min(1.0, part + left / (slows - second)) : 1;
  }
  return ThenSlides(step, theta, -theta * step.R * d);
}

}  // namespace

Tangents Lifted(const double tt[2][2]) {
  const double lift = kNothing * (tt[0][0] + tt[1][1]);
  return {tt[0][0] + lift, 0.5 * (tt[0][1] + tt[1][0]), tt[1][1] + lift};
}

StepFriction FrictionOfStep(const ContactStep& step) {
  const double R = step.R;
  if (step.stuck) return AfterSticking(step, -Times(step.inverse, RateAtEnd(step)));
  const Pair stops = -Times(step.inverse, step.b);
  if (IsWithin(stops, R)) {
    const Pair needed = -Times(step.inverse, RateAtEnd(step));  // to keep the slip as it is
    if (IsWithin(needed, R)) return Stops(step, stops, needed);
  }
  const Pair g = step.v + step.b;
  if (!IsWithin(Times(step.inverse, g), R)) {
    const Pair p = OnRim(step.A, g, R);
    if (Dot(step.v, p) <= 0 && Dot(step.b + Times(step.A, p), p) <= 0) return {p, p, p, 0};
  }
  return ThroughZero(step, Length(step.v));
}

}  // namespace mujoco_impact::law
