// SPDX-License-Identifier: Apache-2.0

#include "engine/point.h"

#include "engine/spatial.h"

namespace mujoco_impact::engine {

namespace {

// Velocity of a point at `offset` from the origin of the axis, per unit of its motion.
void AxisTimes(const mjtNum axis[6], const mjtNum offset[3], mjtNum column[3]) {
  mju_cross(column, axis, offset);
  mju_addTo3(column, axis + 3);
}

// Rate of the axis of a degree of freedom. The axes of a quaternion joint turn with the body
// itself, which cdof_dot leaves out.
void AxisVelocity(const mjModel* m, const mjData* d, int dof, mjtNum axis_dot[6]) {
  if (TurnsWithBody(m, dof)) {
    SpatialCross(d->cvel + 6 * m->dof_bodyid[dof], d->cdof + 6 * dof, axis_dot);
  } else {
    mju_copy(axis_dot, d->cdof_dot + 6 * dof, 6);
  }
}

}  // namespace

int LastDof(const mjModel* m, int body) {
  body = m->body_weldid[body];
  return m->body_dofnum[body] ? m->body_dofadr[body] + m->body_dofnum[body] - 1 : -1;
}

void PointVelocity(const mjModel* m, const mjData* d, const BodyPoint& point, mjtNum velocity[3]) {
  const mjtNum* com = d->subtree_com + 3 * m->body_rootid[point.body];
  const mjtNum* v = d->cvel + 6 * point.body;
  mjtNum offset[3];
  mju_sub3(offset, point.position, com);
  mju_cross(velocity, v, offset);
  mju_addTo3(velocity, v + 3);
}

PointDerivatives PointMotion(const mjModel* m, const mjData* d, const BodyPoint& point,
                             const Motion& motion, bool turning) {
  mjtNum offset[3], point_velocity[3];
  mju_sub3(offset, point.position, d->subtree_com + 3 * m->body_rootid[point.body]);
  PointVelocity(m, d, point, point_velocity);
  PointDerivatives result{};
  for (int i = LastDof(m, point.body); i >= 0; i = m->dof_parentid[i]) {
    mjtNum column[3], axis_dot[6], past[3];
    AxisTimes(d->cdof + 6 * i, offset, column);
    mju_addToScl3(result.velocity, column, motion.velocity[i]);
    mju_addToScl3(result.acceleration, column, motion.acceleration[i]);
    mju_addToScl3(result.jerk, column, motion.jerk[i]);
    if (!turning) continue;
    // J̇: the axis turns, and the point moves past it
    AxisVelocity(m, d, i, axis_dot);
    AxisTimes(axis_dot, offset, column);
    mju_cross(past, d->cdof + 6 * i, point_velocity);
    mju_addToScl3(result.acceleration, column, motion.velocity[i]);
    mju_addToScl3(result.acceleration, past, motion.velocity[i]);
  }
  return result;
}

void MovePoint(const PointDerivatives& derivatives, mjtNum tau, mjtNum x[3]) {
  mju_addToScl3(x, derivatives.velocity, tau);
  mju_addToScl3(x, derivatives.acceleration, tau * tau / 2);
  mju_addToScl3(x, derivatives.jerk, tau * tau * tau / 6);
}

void AddRow(const mjModel* m, const mjData* d, const BodyPoint& point, const mjtNum normal[3],
            mjtNum sign, mjtNum* row) {
  const int last = LastDof(m, point.body);
  if (last < 0) return;
  const int begin = m->tree_dofadr[m->dof_treeid[last]];
  mjtNum offset[3], column[3];
  mju_sub3(offset, point.position, d->subtree_com + 3 * m->body_rootid[point.body]);
  for (int i = last; i >= 0; i = m->dof_parentid[i]) {
    AxisTimes(d->cdof + 6 * i, offset, column);
    row[i - begin] += sign * mju_dot3(normal, column);
  }
}

void AddRowAt(const mjModel* m, const mjData* d, const BodyPoint& point, const Motion& motion,
              mjtNum tau, const mjtNum moved[3], const mjtNum normal[3], mjtNum sign, mjtNum* row) {
  const int last = LastDof(m, point.body);
  if (last < 0) return;
  const int begin = m->tree_dofadr[m->dof_treeid[last]];
  mjtNum offset[3];
  mju_sub3(offset, moved, d->subtree_com + 3 * m->body_rootid[point.body]);
  for (int i = last; i >= 0; i = m->dof_parentid[i]) {
    mjtNum axis[6], turning[6], column[3];
    mju_copy(axis, d->cdof + 6 * i, 6);
    AxisVelocity(m, d, i, turning);
    mju_addToScl(axis, turning, tau, 6);
    if (IsFreeRotation(m, i)) {
      // the axis goes with the body: a force through the centre of a ball must never turn it
      BodyPoint centre{m->dof_bodyid[i], {}};
      mju_copy3(centre.position, d->xpos + 3 * centre.body);
      const PointDerivatives path = PointMotion(m, d, centre, motion, true);
      MovePoint(path, tau, centre.position);
      mjtNum arm[3];
      mju_sub3(arm, moved, centre.position);
      mju_cross(column, axis, arm);
    } else {
      AxisTimes(axis, offset, column);
    }
    row[i - begin] += sign * mju_dot3(normal, column);
  }
}

}  // namespace mujoco_impact::engine
