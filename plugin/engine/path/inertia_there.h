// SPDX-License-Identifier: Apache-2.0
// The inertia of bodies that have been moved within the step.

#ifndef MUJOCO_IMPACT_ENGINE_PATH_INERTIA_THERE_H_
#define MUJOCO_IMPACT_ENGINE_PATH_INERTIA_THERE_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"

namespace mujoco_impact::engine {

// The inertia of the bodies where they are in `d`, for as long as the object lives; then that of
// the start of the step again, to the bit.
class InertiaThere {
 public:
  InertiaThere(const mjModel* m, mjData* d, Scratch& scratch);
  ~InertiaThere();
  InertiaThere(const InertiaThere&) = delete;
  InertiaThere& operator=(const InertiaThere&) = delete;

 private:
  const mjModel* m_;
  mjData* d_;
  mjtNum *crb_, *M_, *qLD_, *qLDiagInv_;
};

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_PATH_INERTIA_THERE_H_
