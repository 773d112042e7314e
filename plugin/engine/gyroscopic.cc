// SPDX-License-Identifier: Apache-2.0

#include "engine/gyroscopic.h"

#include <algorithm>

namespace mujoco_impact::engine {

namespace {

// Of principal inertias, and of the square of the offset over that of the radius of gyration: what
// counts as equal, and as centred.
constexpr mjtNum kRound = 1e-9;

bool IsRound(const mjModel* m, int body) {
  const mjtNum* inertia = m->body_inertia + 3 * body;
  const auto [least, most] = std::minmax({inertia[0], inertia[1], inertia[2]});
  const mjtNum offset2 = mju_dot3(m->body_ipos + 3 * body, m->body_ipos + 3 * body);
  return most - least <= kRound * most && m->body_mass[body] * offset2 <= kRound * most;
}

// Whether the bias of the tree does not depend on its velocity.
bool IsPlain(const mjModel* m, int tree) {
  if (m->tree_dofnum[tree] == 1) return true;
  if (m->tree_bodynum[tree] > 1) return false;
  const int first = m->dof_jntid[m->tree_dofadr[tree]];
  const int body = m->jnt_bodyid[first];
  const int* types = m->jnt_type + first;
  if (*types == mjJNT_FREE || *types == mjJNT_BALL) {
    return m->body_jntnum[body] == 1 && IsRound(m, body);
  }
  return std::all_of(types, types + m->body_jntnum[body],
                     [](int type) { return type == mjJNT_SLIDE; });
}

// Whether the integrator solves for the gyroscopic forces of the end of the step.
bool IsImplicit(const mjModel* m, int tree) {
  if (m->opt.integrator == mjINT_IMPLICIT) return true;
  if (m->opt.integrator == mjINT_EULER || m->opt.integrator == mjINT_RK4) return false;
  const int first = m->dof_jntid[m->tree_dofadr[tree]];
  return m->tree_dofnum[tree] == 6 && m->jnt_type[first] == mjJNT_FREE;
}

// y = c'(w) e (nv each).
void BiasRate(const mjModel* m, mjData* d, const mjtNum* w, const mjtNum* e, mjtNum* y,
              Scratch& scratch) {
  const int nv = m->nv;
  mjtNum* velocity = scratch.Take<mjtNum>(nv);
  mjtNum* other = scratch.Zeros(nv);
  mju_copy(velocity, d->qvel, nv);
  // zeros: MuJoCo leaves out what sleeps
  mju_zero(y, nv);
  for (const int sign : {1, -1}) {
    mju_addScl(d->qvel, w, e, sign, nv);
    mj_comVel(m, d);
    mj_rne(m, d, 0, sign > 0 ? y : other);
  }
  mju_copy(d->qvel, velocity, nv);
  mj_comVel(m, d);
  mju_sub(y, y, other, nv);
  mju_scl(y, y, 0.5, nv);
}

// Copies a vector with zeros for the trees that are left out; whether any is not zero.
template <typename LeftOut>
bool Select(const mjModel* m, const mjtNum* vector, LeftOut left_out, mjtNum* selected) {
  mju_zero(selected, m->nv);
  bool any = false;
  for (int tree = 0; tree < m->ntree; ++tree) {
    const int begin = m->tree_dofadr[tree], dofs = m->tree_dofnum[tree];
    if (mju_isZero(vector + begin, dofs) || left_out(tree)) continue;
    mju_copy(selected + begin, vector + begin, dofs);
    any = true;
  }
  return any;
}

}  // namespace

void AddGyroscopicChange(const mjModel* m, mjData* d, const mjtNum* change, const mjtNum* detour,
                         mjtNum* force, Scratch& scratch) {
  const int nv = m->nv;
  const auto plain = [m](int tree) { return IsPlain(m, tree); };
  const auto explicit_or_plain = [m](int tree) { return IsPlain(m, tree) || !IsImplicit(m, tree); };
  mjtNum* selected = scratch.Take<mjtNum>(nv);
  if (!Select(m, change, plain, selected)) return;
  mjtNum* middle = scratch.Take<mjtNum>(nv);
  mjtNum* rate = scratch.Take<mjtNum>(nv);
  mju_addScl(middle, d->qvel, selected, 0.5, nv);
  Select(m, detour, plain, selected);
  mju_scl(selected, selected, 1 / m->opt.timestep, nv);
  BiasRate(m, d, middle, selected, rate, scratch);
  mju_subFrom(force, rate, nv);
  if (!Select(m, change, explicit_or_plain, selected)) return;
  mju_copy(middle, d->qvel, nv);
  BiasRate(m, d, middle, selected, rate, scratch);
  mju_addTo(force, rate, nv);
}

}  // namespace mujoco_impact::engine
