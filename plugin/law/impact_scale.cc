// SPDX-License-Identifier: Apache-2.0

#include "law/impact_scale.h"

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

}  // namespace mujoco_impact::law
