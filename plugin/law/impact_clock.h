// SPDX-License-Identifier: Apache-2.0
// Step control and the end of an impact: what every integrator of one needs.

#ifndef MUJOCO_IMPACT_LAW_IMPACT_CLOCK_H_
#define MUJOCO_IMPACT_LAW_IMPACT_CLOCK_H_

#include <algorithm>
#include <cmath>

#include "law/impact_problem.h"
#include "law/impact_scale.h"
#include "law/lanes.h"

namespace mujoco_impact::law {

// Contacts whose compression and closing speed are below these parts of the scale, in units of the
// tolerance, are over. An exact zero would cost 50 times the steps for the same impulses.
constexpr double kCompressionFloor = 1;
constexpr double kSpeedFloor = 0.1;

// Contacts that close within this many contact times after a force belong to the same impact, be it
// beyond the horizon: to cut an impact in two would cost more than the geometry that turns
// meanwhile.
constexpr double kSameImpactTimes = 5;

// Multiplications that an attempted step costs: so many products by W, and what is done by lane.
inline double StepCost(const Lanes& lanes, int products) {
  constexpr double kPerLane = 10, kConstant = 80;
  return products * lanes.product_cost() + kPerLane * lanes.padded() + kConstant;
}

// And what it costs to let contacts in and out, or to find the next that closes.
inline double SearchCost(const ImpactProblem& problem, const Lanes& lanes) {
  return 2 * lanes.product_cost() + problem.delassus.size;
}

// Whether every contact has opened, or will not close in time, at time t.
bool IsOver(const ImpactProblem& problem, const ImpactScale& scale, const Lanes& lanes, double t);

bool AnyCompressed(const Lanes& lanes);

// Flies to the next closing, no contact being compressed; false if none comes in time. A contact
// that closes outside the window is let in by moving the window then.
bool FlyToNextClosing(const ImpactProblem& problem, const ImpactScale& scale, Lanes& lanes,
                      double* t);

// Once the horizon has passed, leaves the contacts alone that would begin an impact of their own:
// the bodies on both sides are in no other contact. Waves under way go on to their end; without
// this a long row, in which something always closes soon, would be followed for many steps of the
// engine.
void LeaveLateClosings(const ImpactProblem& problem, const ImpactScale& scale, double t,
                       Lanes& lanes);

// Factor for the next step after one with this error (in units of the tolerance) of a method whose
// error is of the given order in the step; 4 or 5.
inline double StepGrowth(double error, int order) {
  const double root =
      order == 4 ? std::sqrt(std::sqrt(error + 1e-10)) : std::pow(error + 1e-10, 1.0 / order);
  return std::clamp(0.9 / root, 0.2, 5.0);
}

// The closing speeds c − W P that the impulses of the solution leave, and the slips.
void SpeedsAfter(const ImpactProblem& problem, ImpactSolution& solution);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_IMPACT_CLOCK_H_
