// SPDX-License-Identifier: Apache-2.0

#include "engine/path/weight_gradient.h"

#include <algorithm>

#include "engine/common/spatial.h"

namespace mujoco_impact::engine {

namespace {

// One kinematic tree displaced along u. Spatial vectors are (rotation, translation) about `origin`,
// the point that MuJoCo's motion axes of the tree refer to.
class DisplacedTree {
 public:
  static int Numbers(int bodies, int dofs) { return 18 * bodies + 6 * dofs; }

  // `work` has room for its numbers.
  DisplacedTree(const mjModel* m, const mjData* d, int tree, const mjtNum* u, mjtNum* work)
      : m_(m),
        d_(d),
        first_(m->tree_bodyadr[tree]),
        number_(m->tree_bodynum[tree]),
        origin_(d->subtree_com + 3 * m->body_rootid[first_]),
        displacement_(work),
        weight_(displacement_ + 6 * number_),
        weight_change_(weight_ + 6 * number_),
        axis_change_(weight_change_ + 6 * number_),
        first_dof_(m->tree_dofadr[tree]),
        falling_(IsFreeRoot() ? 1 - m->body_gravcomp[first_] : 0) {
    mju_zero(work, Numbers(number_, m->tree_dofnum[tree]));
    for (int i = 0; i < number_; ++i) Displace(i, u);
    for (int i = number_ - 1; i > 0; --i) PassToParent(i);
  }

  // δQ_i = δaxis_i · F + axis_i · δF, F the weight of everything the joint carries
  void AddForces(const mjtNum* u, mjtNum* result) const {
    for (int i = 0; i < number_; ++i) {
      const int body = first_ + i;
      for (int k = 0; k < m_->body_dofnum[body]; ++k) {
        const int dof = m_->body_dofadr[body] + k;
        result[dof] += mju_dot(axis_change_ + 6 * (dof - first_dof_), weight_ + 6 * i, 6) +
                       mju_dot(d_->cdof + 6 * dof, weight_change_ + 6 * i, 6) -
                       Spring(dof) * u[dof];
      }
    }
  }

 private:
  bool IsFreeRoot() const { return m_->jnt_type[m_->dof_jntid[first_dof_]] == mjJNT_FREE; }

  mjtNum Spring(int dof) const {
    const int joint = m_->dof_jntid[dof];
    const int type = m_->jnt_type[joint];
    const bool scalar = type == mjJNT_HINGE || type == mjJNT_SLIDE;
    const bool off = m_->opt.disableflags & mjDSBL_SPRING;
    return scalar && !off ? m_->jnt_stiffness[joint] : 0;
  }

  // Displacement of body i from that of its parent, and what it does to its axes and weight.
  void Displace(int i, const mjtNum* u) {
    const int body = first_ + i;
    mjtNum* moved = displacement_ + 6 * i;
    if (i > 0) mju_copy(moved, displacement_ + 6 * (m_->body_parentid[body] - first_), 6);
    const int begin = m_->body_dofadr[body];
    for (int dof = begin; dof < begin + m_->body_dofnum[body]; ++dof) {
      // a hinge or slide is carried along by what comes before it: nothing, before a free joint
      if (!TurnsWithBody(m_, dof)) SpatialCross(moved, d_->cdof + 6 * dof, AxisChange(dof));
      mju_addToScl(moved, d_->cdof + 6 * dof, u[dof], 6);
    }
    for (int dof = begin; dof < begin + m_->body_dofnum[body]; ++dof) {
      if (TurnsWithBody(m_, dof)) SpatialCross(moved, d_->cdof + 6 * dof, AxisChange(dof));
    }
    Weigh(body, i);
  }

  void Weigh(int body, int i) {
    const mjtNum* moved = displacement_ + 6 * i;
    const Vector3 arm = Load(d_->xipos + 3 * body) - Load(origin_);
    // δx = δtranslation + δrotation × arm
    const Vector3 centre_moved = Load(moved + 3) + Cross(Load(moved), arm);
    const mjtNum weight = 1 - m_->body_gravcomp[body] - falling_;
    const Vector3 force = m_->body_mass[body] * weight * Load(m_->opt.gravity);
    Store(Cross(arm, force), weight_ + 6 * i);
    Store(force, weight_ + 6 * i + 3);
    Store(Cross(centre_moved, force), weight_change_ + 6 * i);
  }

  void PassToParent(int i) {
    const int parent = m_->body_parentid[first_ + i] - first_;
    mju_addTo(weight_ + 6 * parent, weight_ + 6 * i, 6);
    mju_addTo(weight_change_ + 6 * parent, weight_change_ + 6 * i, 6);
  }

  mjtNum* AxisChange(int dof) { return axis_change_ + 6 * (dof - first_dof_); }

  const mjModel* m_;
  const mjData* d_;
  const int first_, number_;
  const mjtNum* origin_;
  mjtNum *displacement_, *weight_, *weight_change_;  // per body (6)
  mjtNum* axis_change_;                              // per dof (6)
  const int first_dof_;
  // Of gravity: with what acceleration the tree falls as a whole. What falls freely has no weight,
  // however it turns: its inertia changes as its weight does.
  const mjtNum falling_;
};

}  // namespace

PathWeights DetourWeights(const mjModel* m) {
  const mjtNum h = m->opt.timestep;
  // (h − s)²/2 − h²/6
  if (m->opt.integrator == mjINT_RK4) return {h * h / 3, -h, 0.5};
  // −s (h − s)/2
  return {0, -0.5 * h, 0.5};
}

void AddWeightGradient(const mjModel* m, mjData* d, const mjtNum* u, mjtNum* result) {
  if (m->opt.disableflags & mjDSBL_GRAVITY) return;
  Scratch scratch(d);
  int bodies = 0, dofs = 0;
  for (int tree = 0; tree < m->ntree; ++tree) {
    bodies = std::max(bodies, static_cast<int>(m->tree_bodynum[tree]));
    dofs = std::max(dofs, static_cast<int>(m->tree_dofnum[tree]));
  }
  mjtNum* work = scratch.Take<mjtNum>(DisplacedTree::Numbers(bodies, dofs));
  for (int tree = 0; tree < m->ntree; ++tree) {
    if (mju_isZero(u + m->tree_dofadr[tree], m->tree_dofnum[tree])) continue;
    DisplacedTree(m, d, tree, u, work).AddForces(u, result);
  }
}

}  // namespace mujoco_impact::engine
