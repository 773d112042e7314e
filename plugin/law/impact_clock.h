// SPDX-License-Identifier: Apache-2.0
// Scales, free flight and the end of an impact: what every integrator of one needs.

#ifndef MUJOCO_IMPACT_LAW_IMPACT_CLOCK_H_
#define MUJOCO_IMPACT_LAW_IMPACT_CLOCK_H_

#include "law/impact_problem.h"

namespace mujoco_impact::law {

// Natural scales of an impact, from the contact that closes fastest.
struct ImpactScale {
  double speed;        // c_ref [m/s]; 0: nothing closes
  double compression;  // y_ref [m]
  double time;         // shortest contact time T at c_ref of all contacts [s]
};

ImpactScale MeasureScale(const ImpactProblem& problem);

// Contacts whose compression and closing speed are below these parts of the scale are over. An
// exact zero would cost 50 times the steps for the same impulses.
constexpr double kCompressionFloor = 1e-5;
constexpr double kSpeedFloor = 1e-6;

// Whether every contact has opened or will not close before the horizon; t is the time now.
bool ImpactIsOver(const ImpactProblem& problem, const ImpactScale& scale, double t,
                  const double* compression, const double* closing_speed);

// Whether any contact is compressed.
bool AnyCompressed(int size, const double* compression);

// Flies all contacts to the next closing and returns the time that took, or −1 if none closes
// before the horizon. No contact may be compressed.
double FlyToNextClosing(const ImpactProblem& problem, double t, double* compression,
                        const double* closing_speed);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_IMPACT_CLOCK_H_
