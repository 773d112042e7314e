// SPDX-License-Identifier: Apache-2.0

#ifndef MUJOCO_IMPACT_LAW_IMPACT_SCALE_H_
#define MUJOCO_IMPACT_LAW_IMPACT_SCALE_H_

#include "law/impact_problem.h"

namespace mujoco_impact::law {

// Natural scales of an impact, from the contact that closes fastest.
struct ImpactScale {
  double speed;        // c_ref [m/s]; 0: nothing closes
  double compression;  // y_ref [m]
  double time;         // shortest contact time T at c_ref of all contacts [s]
};

ImpactScale MeasureScale(const ImpactProblem& problem);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_IMPACT_SCALE_H_
