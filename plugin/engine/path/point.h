// SPDX-License-Identifier: Apache-2.0
// Motion and Jacobian of one point of a body, over the degrees of freedom that move it.
//
// The chain of degrees of freedom is walked, never all of them: the cost is the depth of the body.

#ifndef MUJOCO_IMPACT_ENGINE_PATH_POINT_H_
#define MUJOCO_IMPACT_ENGINE_PATH_POINT_H_

#include <mujoco/mujoco.h>

#include "engine/common/vector3.h"
#include "engine/path/motion.h"

namespace mujoco_impact::engine {

// A point fixed to a body, world frame.
struct BodyPoint {
  int body;
  Vector3 position;  // [m]
};

inline bool IsSphere(const mjModel* m, int geom) { return m->geom_type[geom] == mjGEOM_SPHERE; }

// Where the surface of the geom on a side is touched, from the point that stands for that side: the
// centre of a sphere, the contact point of any other shape. The normal points from side 0 to 1.
inline Vector3 SurfacePoint(const mjModel* m, int geom, int side, const Vector3& point,
                            const Vector3& normal) {
  if (!IsSphere(m, geom)) return point;
  const mjtNum radius = m->geom_size[3 * geom];
  return point + (side == 0 ? radius : -radius) * normal;
}

// The point of the surface of an ellipsoid or a capsule in which its outward normal is `outward`,
// next to `point`; of any other shape `point` itself. The narrow phase tells the point and the
// normal of a curved body as far as it has iterated. A push along that normal at that point would
// turn the body about an axis of symmetry, which a push without friction cannot.
Vector3 PointWithNormal(const mjModel* m, const mjData* d, int geom, const Vector3& point,
                        const Vector3& outward);

// Last degree of freedom that moves the body, −1 for a static one.
int LastDof(const mjModel* m, int body);

// Velocity of the point by mjData.cvel, without a Jacobian, and without that of a mocap body.
inline Vector3 PointVelocity(const mjModel* m, const mjData* d, const BodyPoint& point) {
  const Vector3 com = Load(d->subtree_com + 3 * m->body_rootid[point.body]);
  const mjtNum* v = d->cvel + 6 * point.body;
  return Load(v + 3) + Cross(Load(v), point.position - com);
}

// Velocity of the point by other velocities of the degrees of freedom (nv).
Vector3 PointVelocityBy(const mjModel* m, const mjData* d, const BodyPoint& point,
                        const mjtNum* velocity);

// Derivatives of the position of a point along the path of a Motion, world frame.
struct PointDerivatives {
  Vector3 velocity;      // J V
  Vector3 acceleration;  // J a, + J̇ V if the point turns with its body
  Vector3 jerk;          // J b
};

PointDerivatives PointMotion(const mjModel* m, const mjData* d, const BodyPoint& point,
                             const Motion& motion, bool turning);

// How far the point gets by τ: velocity τ + acceleration τ²/2 + jerk τ³/6.
inline Vector3 Displacement(const PointDerivatives& x, mjtNum tau) {
  return tau * (x.velocity + tau / 2 * (x.acceleration + tau / 3 * x.jerk));
}

// Adds sign · nᵀ J to `row`, the segment of the dofs of the tree of `point`: J where the point is.
void AddRow(const mjModel* m, const mjData* d, const BodyPoint& point, const Vector3& normal,
            mjtNum sign, mjtNum* row);

// The same at the time τ on the path of `motion`, by which the point has moved to `moved` and the
// axes have turned and gone along with their bodies.
void AddRowAt(const mjModel* m, const mjData* d, const BodyPoint& point, const Motion& motion,
              mjtNum tau, const Vector3& moved, const Vector3& normal, mjtNum sign, mjtNum* row);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_PATH_POINT_H_
