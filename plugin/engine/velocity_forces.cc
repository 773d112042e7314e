// SPDX-License-Identifier: Apache-2.0

#include "engine/velocity_forces.h"

#include "engine/motion.h"

namespace mujoco_impact::engine {

namespace {

// b of the tree.
mjtNum IncludedPart(const mjModel* m, int tree) {
  const bool single = m->tree_bodynum[tree] == 1 && m->tree_dofnum[tree] == 6 &&
                      m->jnt_type[m->dof_jntid[m->tree_dofadr[tree]]] == mjJNT_FREE;
  switch (m->opt.integrator) {
    case mjINT_EULER:
      return 0;
    case mjINT_RK4:
      return 0.5;
    case mjINT_IMPLICIT:
      return 1;
    default:
      return single ? 1 : 0;
  }
}

// c(q, v) and gravity where the bodies are.
void BiasAt(const mjModel* m, mjData* d, const mjtNum* velocity, mjtNum* bias) {
  mju_copy(d->qvel, velocity, m->nv);
  mj_comVel(m, d);
  mju_zero(bias, m->nv);
  mj_rne(m, d, 0, bias);
}

}  // namespace

void AddVelocityForces(const mjModel* m, mjData* d, const RigidFlights& flights, mjtNum t,
                       const mjtNum* before, const mjtNum* after, Kicks& kicks, Scratch& scratch) {
  const mjtNum h = m->opt.timestep;
  mjtNum* velocity = scratch.Take<mjtNum>(m->nv);
  mjtNum* change = scratch.Take<mjtNum>(m->nv);
  mjtNum* bias = scratch.Take<mjtNum>(m->nv);
  mju_copy(velocity, d->qvel, m->nv);
  BiasAt(m, d, before, bias);
  BiasAt(m, d, after, change);
  mju_subFrom(change, bias, m->nv);
  mju_copy(d->qvel, velocity, m->nv);
  mj_comVel(m, d);
  for (int tree = 0; tree < m->ntree; ++tree) {
    const int begin = m->tree_dofadr[tree], dofs = m->tree_dofnum[tree];
    if (flights.Has(tree) || mju_isZero(change + begin, dofs)) continue;
    const mjtNum lag = 0.5 - ImpulseLag(m);
    mju_scl(change + begin, change + begin, -(h - t - (lag + IncludedPart(m, tree)) * h), dofs);
    SolveTreeInertia(m, d, tree, change + begin);
    // it comes all along the rest of the step
    const mjtNum mean = 0.5 * (t + h);
    mju_addTo(kicks.velocity + begin, change + begin, dofs);
    mju_addToScl(kicks.moment + begin, change + begin, mean, dofs);
    mju_addToScl(kicks.second + begin, change + begin, mean * mean, dofs);
    kicks.any = true;
  }
}

}  // namespace mujoco_impact::engine
