// SPDX-License-Identifier: Apache-2.0
// Motion and Jacobian of one point of a body, over the degrees of freedom that move it.
//
// The chain of degrees of freedom is walked, never all of them: the cost is the depth of the body.

#ifndef MUJOCO_IMPACT_ENGINE_POINT_H_
#define MUJOCO_IMPACT_ENGINE_POINT_H_

#include <mujoco/mujoco.h>

#include "engine/motion.h"

namespace mujoco_impact::engine {

// A point fixed to a body, world frame.
struct BodyPoint {
  int body;
  mjtNum position[3];  // [m]
};

// Last degree of freedom that moves the body, −1 for a static one.
int LastDof(const mjModel* m, int body);

// Velocity of the point by mjData.cvel, without a Jacobian.
void PointVelocity(const mjModel* m, const mjData* d, const BodyPoint& point, mjtNum velocity[3]);

// Velocity J V and acceleration J a (+ J̇ V if `turning`) of the point on the path of `motion`.
void PointMotion(const mjModel* m, const mjData* d, const BodyPoint& point, const Motion& motion,
                 bool turning, mjtNum velocity[3], mjtNum acceleration[3]);

// Adds sign · nᵀ (J + τ J̇) of the point to `row`, the segment of the dofs of the body's tree.
void AddRow(const mjModel* m, const mjData* d, const BodyPoint& point, const mjtNum normal[3],
            mjtNum tau, mjtNum sign, mjtNum* row);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_POINT_H_
