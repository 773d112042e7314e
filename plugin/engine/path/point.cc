// SPDX-License-Identifier: Apache-2.0

#include "engine/path/point.h"

#include <algorithm>
#include <cmath>

#include "engine/common/spatial.h"

namespace mujoco_impact::engine {

namespace {

// Velocity of a point at `offset` from the origin of the axis, per unit of its motion.
Vector3 AxisTimes(const mjtNum axis[6], const Vector3& offset) {
  return Load(axis + 3) + Cross(Load(axis), offset);
}

// Rate of the axis of a degree of freedom. The axes of a quaternion joint turn with the body
// itself, which cdof_dot leaves out.
void AxisVelocity(const mjModel* m, const mjData* d, int dof, mjtNum axis_dot[6]) {
  if (TurnsWithBody(m, dof)) {
    SpatialCross(d->cvel + 6 * m->dof_bodyid[dof], d->cdof + 6 * dof, axis_dot);
  } else {
    Store(Load(d->cdof_dot + 6 * dof), axis_dot);
    Store(Load(d->cdof_dot + 6 * dof + 3), axis_dot + 3);
  }
}

// A vector turned by an angle about its direction [rad]: friction sees where the axes of a spinning
// ball are, and .1 rad in a step is not little.
Vector3 Turned(const Vector3& v, const Vector3& angle) {
  const mjtNum size = Norm(angle);
  if (size < mjMINVAL) return v;
  const Vector3 axis = 1 / size * angle, across = Cross(axis, v);
  return v + std::sin(size) * across + (1 - std::cos(size)) * Cross(axis, across);
}

Vector3 Origin(const mjModel* m, const mjData* d, int body) {
  return Load(d->subtree_com + 3 * m->body_rootid[body]);
}

}  // namespace

Vector3 PointWithNormal(const mjModel* m, const mjData* d, int geom, const Vector3& point,
                        const Vector3& outward) {
  const mjtNum *size = m->geom_size + 3 * geom, *R = d->geom_xmat + 9 * geom;
  const Vector3 centre = Load(d->geom_xpos + 3 * geom), n = RotateBack(R, outward);
  switch (m->geom_type[geom]) {
    case mjGEOM_ELLIPSOID: {
      // A² n / |A n|, A the half-axes
      const Vector3 An{size[0] * n.x, size[1] * n.y, size[2] * n.z};
      const Vector3 AAn{size[0] * An.x, size[1] * An.y, size[2] * An.z};
      return centre + Rotate(R, 1 / Norm(An) * AAn);
    }
    case mjGEOM_CAPSULE: {
      const mjtNum along = RotateBack(R, point - centre).z - size[0] * n.z;
      const Vector3 inside{0, 0, std::clamp(along, -size[1], size[1])};
      return centre + Rotate(R, inside + size[0] * n);
    }
    default:
      return point;
  }
}

int LastDof(const mjModel* m, int body) {
  body = m->body_weldid[body];
  return m->body_dofnum[body] ? m->body_dofadr[body] + m->body_dofnum[body] - 1 : -1;
}

Vector3 PointVelocityBy(const mjModel* m, const mjData* d, const BodyPoint& point,
                        const mjtNum* velocity) {
  const Vector3 offset = point.position - Origin(m, d, point.body);
  Vector3 result{};
  for (int i = LastDof(m, point.body); i >= 0; i = m->dof_parentid[i]) {
    result += velocity[i] * AxisTimes(d->cdof + 6 * i, offset);
  }
  return result;
}

PointDerivatives PointMotion(const mjModel* m, const mjData* d, const BodyPoint& point,
                             const Motion& motion, bool turning) {
  const Vector3 offset = point.position - Origin(m, d, point.body);
  const Vector3 point_velocity = PointVelocity(m, d, point);
  PointDerivatives result{};
  for (int i = LastDof(m, point.body); i >= 0; i = m->dof_parentid[i]) {
    const mjtNum V = motion.velocity[i];
    const Vector3 column = AxisTimes(d->cdof + 6 * i, offset);
    result.velocity += V * column;
    result.acceleration += motion.acceleration[i] * column;
    result.jerk += motion.jerk[i] * column;
    if (!turning) continue;
    // J̇: the axis turns, and the point moves past it
    mjtNum axis_dot[6];
    AxisVelocity(m, d, i, axis_dot);
    const Vector3 past = Cross(Load(d->cdof + 6 * i), point_velocity);
    result.acceleration += V * (AxisTimes(axis_dot, offset) + past);
  }
  result.velocity += MocapVelocity(m, d, motion.mocap, point.body, point.position);
  return result;
}

void AddRow(const mjModel* m, const mjData* d, const BodyPoint& point, const Vector3& normal,
            mjtNum sign, mjtNum* row) {
  const int last = LastDof(m, point.body);
  if (last < 0) return;
  const int begin = m->tree_dofadr[m->dof_treeid[last]];
  const Vector3 offset = point.position - Origin(m, d, point.body);
  for (int i = last; i >= 0; i = m->dof_parentid[i]) {
    row[i - begin] += sign * Dot(normal, AxisTimes(d->cdof + 6 * i, offset));
  }
}

void AddRowAt(const mjModel* m, const mjData* d, const BodyPoint& point, const Motion& motion,
              mjtNum tau, const Vector3& moved, const Vector3& normal, mjtNum sign, mjtNum* row) {
  const int last = LastDof(m, point.body);
  if (last < 0) return;
  const int begin = m->tree_dofadr[m->dof_treeid[last]];
  const Vector3 offset = moved - Origin(m, d, point.body);
  for (int i = last; i >= 0; i = m->dof_parentid[i]) {
    Vector3 column;
    if (IsFreeRotation(m, i)) {
      // the axis goes with the body: a force through the centre of a ball must never turn it
      const BodyPoint centre{m->dof_bodyid[i], Load(d->xpos + 3 * m->dof_bodyid[i])};
      const PointDerivatives path = PointMotion(m, d, centre, motion, true);
      const Vector3 angle = tau * Load(d->cvel + 6 * centre.body);
      column = Cross(Turned(Load(d->cdof + 6 * i), angle),
                     moved - (centre.position + Displacement(path, tau)));
    } else {
      mjtNum axis[6];
      AxisVelocity(m, d, i, axis);
      for (int j = 0; j < 6; ++j) axis[j] = d->cdof[6 * i + j] + tau * axis[j];
      column = AxisTimes(axis, offset);
    }
    row[i - begin] += sign * Dot(normal, column);
  }
}

}  // namespace mujoco_impact::engine
