// SPDX-License-Identifier: Apache-2.0

#include "engine/point.h"

namespace mujoco_impact::engine {

namespace {

// The column of J and of J̇ that belongs to one degree of freedom.
class Columns {
 public:
  Columns(const mjModel* m, const mjData* d, const BodyPoint& point) : m_(m), d_(d) {
    const mjtNum* com = d->subtree_com + 3 * m->body_rootid[point.body];
    mju_sub3(offset_, point.position, com);
    PointVelocity(m, d, point, velocity_);
  }

  // J e_i = linear part of the motion axis, moved to the point
  void Position(int dof, mjtNum column[3]) const {
    const mjtNum* axis = d_->cdof + 6 * dof;
    mju_cross(column, axis, offset_);
    mju_addTo3(column, axis + 3);
  }

  // J̇ e_i: the axis turns with its body, the point moves past it
  void Velocity(int dof, mjtNum column[3]) const {
    const mjtNum* axis = d_->cdof + 6 * dof;
    mjtNum axis_dot[6];
    AxisVelocity(dof, axis, axis_dot);
    mjtNum past[3];
    mju_cross(column, axis_dot, offset_);
    mju_cross(past, axis, velocity_);
    mju_addTo3(column, axis_dot + 3);
    mju_addTo3(column, past);
  }

 private:
  void AxisVelocity(int dof, const mjtNum* axis, mjtNum axis_dot[6]) const {
    const int joint = m_->dof_jntid[dof];
    const int type = m_->jnt_type[joint];
    const bool quaternion =
        type == mjJNT_BALL || (type == mjJNT_FREE && dof >= m_->jnt_dofadr[joint] + 3);
    if (!quaternion) {
      mju_copy(axis_dot, d_->cdof_dot + 6 * dof, 6);
      return;
    }
    // the axes of a quaternion joint turn with the body itself, which cdof_dot leaves out:
    // spatial cross product of the body's velocity with the axis
    const mjtNum* v = d_->cvel + 6 * m_->dof_bodyid[dof];
    mjtNum linear[3];
    mju_cross(axis_dot, v, axis);
    mju_cross(axis_dot + 3, v, axis + 3);
    mju_cross(linear, v + 3, axis);
    mju_addTo3(axis_dot + 3, linear);
  }

  const mjModel* m_;
  const mjData* d_;
  mjtNum offset_[3];    // from the centre of mass of the tree, where MuJoCo's axes are
  mjtNum velocity_[3];  // of the point
};

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

void PointMotion(const mjModel* m, const mjData* d, const BodyPoint& point, const Motion& motion,
                 bool turning, mjtNum velocity[3], mjtNum acceleration[3]) {
  const Columns columns(m, d, point);
  mju_zero3(velocity);
  mju_zero3(acceleration);
  for (int i = LastDof(m, point.body); i >= 0; i = m->dof_parentid[i]) {
    mjtNum column[3];
    columns.Position(i, column);
    mju_addToScl3(velocity, column, motion.velocity[i]);
    mju_addToScl3(acceleration, column, motion.acceleration[i]);
    if (!turning) continue;
    columns.Velocity(i, column);
    mju_addToScl3(acceleration, column, motion.velocity[i]);
  }
}

void AddRow(const mjModel* m, const mjData* d, const BodyPoint& point, const mjtNum normal[3],
            mjtNum tau, mjtNum sign, mjtNum* row) {
  const int last = LastDof(m, point.body);
  if (last < 0) return;
  const int begin = m->tree_dofadr[m->dof_treeid[last]];
  const Columns columns(m, d, point);
  for (int i = last; i >= 0; i = m->dof_parentid[i]) {
    mjtNum column[3];
    columns.Position(i, column);
    row[i - begin] += sign * mju_dot3(normal, column);
    if (tau == 0) continue;
    columns.Velocity(i, column);
    row[i - begin] += sign * tau * mju_dot3(normal, column);
  }
}

}  // namespace mujoco_impact::engine
