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

// Derivatives of the position of a point along the path of a Motion, world frame.
struct PointDerivatives {
  mjtNum velocity[3];      // J V
  mjtNum acceleration[3];  // J a, + J̇ V if the point turns with its body
  mjtNum jerk[3];          // J b
};

PointDerivatives PointMotion(const mjModel* m, const mjData* d, const BodyPoint& point,
                             const Motion& motion, bool turning);

// x + velocity τ + acceleration τ²/2 + jerk τ³/6
void MovePoint(const PointDerivatives& derivatives, mjtNum tau, mjtNum x[3]);

// Adds sign · nᵀ J to `row`, the segment of the dofs of the tree of `point`: J where the point is.
void AddRow(const mjModel* m, const mjData* d, const BodyPoint& point, const mjtNum normal[3],
            mjtNum sign, mjtNum* row);

// The same at the time τ on the path of `motion`, by which the point has moved to `moved` and the
// axes have turned and gone along with their bodies.
void AddRowAt(const mjModel* m, const mjData* d, const BodyPoint& point, const Motion& motion,
              mjtNum tau, const mjtNum moved[3], const mjtNum normal[3], mjtNum sign, mjtNum* row);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_POINT_H_
