// SPDX-License-Identifier: Apache-2.0

#include "law/impact_clock.h"

#include <algorithm>

namespace mujoco_impact::law {

namespace {

// Within which a closing after a force is one of the same impact.
double SameImpact(const ImpactProblem& problem, const ImpactScale& scale) {
  return std::min(kSameImpactTimes * scale.time, problem.longest_flight);
}

// The longest flight to a next closing that still belongs to the impact.
double LongestFlight(const ImpactProblem& problem, const ImpactScale& scale, double t) {
  const double same_impact = SameImpact(problem, scale);
  return std::min(std::max(problem.flight, same_impact), problem.horizon + same_impact - t);
}

// The speed up to which a contact is left to rest if nothing presses it. With friction contacts of
// e = 0 would otherwise wait for ever at speeds below the floor for one that closes much later.
double RestSpeed(const ImpactProblem& problem, const ImpactScale& scale) {
  return problem.friction ? kSpeedFloor * problem.tolerance * scale.speed : 0;
}

// Whether a contact that shares a body with the one of lane i is compressed.
bool IsPressedFromBeside(const ImpactProblem& problem, const Lanes& lanes, int i) {
  bool pressed = false;
  ForNeighbours(problem.delassus, lanes.contact(i), [&](int l) {
    const int beside = lanes.lane(l);
    pressed = pressed || (beside >= 0 && beside != i && lanes.y[beside] > 0);
  });
  return pressed;
}

}  // namespace

bool IsOver(const ImpactProblem& problem, const ImpactScale& scale, const Lanes& lanes, double t) {
  const double y_floor = kCompressionFloor * problem.tolerance * scale.compression;
  const double c_floor = kSpeedFloor * problem.tolerance * scale.speed;
  const double time_left = LongestFlight(problem, scale, t);
  for (int i = 0; i < lanes.size(); ++i) {
    const double y = lanes.y[i], c = lanes.c[i];
    if (y > y_floor) return false;
    const bool closes_in_time = y >= 0 || -y < c * time_left;
    if (c > c_floor && closes_in_time) return false;
  }
  return lanes.window().NextArrival() >= t + time_left;
}

bool AnyCompressed(const Lanes& lanes) {
  return std::any_of(lanes.y, lanes.y + lanes.size(), [](double y) { return y > 0; });
}

bool FlyToNextClosing(const ImpactProblem& problem, const ImpactScale& scale, Lanes& lanes,
                      double* t) {
  const double longest = LongestFlight(problem, scale, *t);
  double flight = std::min(longest, lanes.window().NextArrival() - *t);
  const double rest = RestSpeed(problem, scale);
  int next = -1;
  for (int i = 0; i < lanes.size(); ++i) {
    if (lanes.c[i] <= rest) continue;
    if (-lanes.y[i] > flight * lanes.c[i]) continue;
    flight = -lanes.y[i] / lanes.c[i];
    next = i;
  }
  if (next < 0 && flight >= longest) return false;
  for (int i = 0; i < lanes.size(); ++i) lanes.y[i] += flight * lanes.c[i];
  if (next >= 0) lanes.y[next] = 0;
  *t += flight;
  return true;
}

void LeaveLateClosings(const ImpactProblem& problem, const ImpactScale& scale, double t,
                       Lanes& lanes) {
  constexpr double kNever = -1e30;  // a compression that no speed makes up for [m]
  if (t < problem.horizon + SameImpact(problem, scale)) return;
  for (int i = 0; i < lanes.size(); ++i) {
    const bool closes = lanes.y[i] < 0 && lanes.c[i] > 0;
    if (closes && !IsPressedFromBeside(problem, lanes, i)) lanes.y[i] = kNever;
  }
}

void SpeedsAfter(const ImpactProblem& problem, ImpactSolution& solution) {
  Multiply(problem.delassus, solution.impulse, solution.closing_speed);
  if (const CoulombFriction* friction = problem.friction) {
    AddTangential(problem.delassus, *friction, solution.friction, solution.closing_speed);
    SlipAfter(problem.delassus, *friction, solution.impulse, solution.friction, solution.slip);
  }
  for (int k = 0; k < problem.delassus.size; ++k) {
    solution.closing_speed[k] = problem.closing_speed[k] - solution.closing_speed[k];
  }
}

}  // namespace mujoco_impact::law
