// SPDX-License-Identifier: Apache-2.0

#include "engine/resolve/velocity_forces.h"

#include "engine/path/motion.h"
#include "engine/scene/tree_kinds.h"

namespace mujoco_impact::engine {

namespace {

// What the integrator counts, of the linear and the quadratic part.
struct Counted {
  mjtNum linear, quadratic;
};

Counted CountedBy(const mjModel* m, int tree) {
  const bool single = m->tree_bodynum[tree] == 1 && IsFreeBody(m, tree);
  switch (m->opt.integrator) {
    case mjINT_EULER:
      return {0, 0};
    case mjINT_RK4:
      return {1.0 / 2, 1.0 / 3};
    case mjINT_IMPLICIT:
      return {1, 0};
    default:
      return {single ? 1.0 : 0.0, 0};
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

void AddVelocityForces(const mjModel* m, mjData* d, const Flights& flights, mjtNum t,
                       const mjtNum* before, const mjtNum* after, Kicks& kicks, Scratch& scratch) {
  const mjtNum h = m->opt.timestep;
  mjtNum* velocity = scratch.Take<mjtNum>(m->nv);
  mjtNum* back = scratch.Take<mjtNum>(m->nv);
  mjtNum* at_before = scratch.Take<mjtNum>(m->nv);
  mjtNum* at_after = scratch.Take<mjtNum>(m->nv);
  mjtNum* at_back = scratch.Take<mjtNum>(m->nv);
  mjtNum* change = scratch.Take<mjtNum>(m->nv);
  mju_copy(velocity, d->qvel, m->nv);
  // v − Δv
  for (int i = 0; i < m->nv; ++i) back[i] = 2 * before[i] - after[i];
  BiasAt(m, d, before, at_before);
  BiasAt(m, d, after, at_after);
  BiasAt(m, d, back, at_back);
  mju_copy(d->qvel, velocity, m->nv);
  mj_comVel(m, d);
  for (int tree = 0; tree < m->ntree; ++tree) {
    const int begin = m->tree_dofadr[tree], dofs = m->tree_dofnum[tree];
    if (flights.Has(tree)) continue;
    const Counted counted = CountedBy(m, tree);
    const mjtNum lag = 0.5 - ImpulseLag(m);
    for (int i = begin; i < begin + dofs; ++i) {
      const mjtNum L = 0.5 * (at_after[i] - at_back[i]);
      const mjtNum Q = 0.5 * (at_after[i] + at_back[i]) - at_before[i];
      change[i] = h * (counted.linear * L + counted.quadratic * Q) - (h - t - lag * h) * (L + Q);
    }
    if (mju_isZero(change + begin, dofs)) continue;
    SolveTreeInertia(m, d, tree, change + begin);
    // it comes all along the rest of the step
    const mjtNum mean = 0.5 * (t + h);
    mju_addTo(kicks.velocity + begin, change + begin, dofs);
    mju_addToScl(kicks.moment + begin, change + begin, mean, dofs);
    mju_addToScl(kicks.second + begin, change + begin, mean * mean, dofs);
    kicks.any = true;
  }
}

const mjtNum* WithoutVelocityForces(const mjModel* m, mjData* d, const Flights& flights,
                                    const mjtNum* acceleration, Scratch& scratch) {
  const auto has_arms = [&](int tree) { return !flights.IsRigid(tree) && !KeepsInertia(m, tree); };
  int tree = 0;
  while (tree < m->ntree && !has_arms(tree)) ++tree;
  if (tree == m->ntree) return acceleration;
  mjtNum* steady = scratch.Take<mjtNum>(m->nv);
  mjtNum* velocity = scratch.Take<mjtNum>(m->nv);
  mjtNum* still = scratch.Zeros(static_cast<int>(m->nv));
  mjtNum* change = scratch.Take<mjtNum>(m->nv);
  mju_copy(steady, acceleration, m->nv);
  mju_copy(velocity, d->qvel, m->nv);
  BiasAt(m, d, still, still);
  BiasAt(m, d, velocity, change);
  mju_subFrom(change, still, m->nv);
  for (; tree < m->ntree; ++tree) {
    if (!has_arms(tree) || IsAsleep(d, tree)) continue;
    const int begin = m->tree_dofadr[tree];
    SolveTreeInertia(m, d, tree, change + begin);
    mju_addTo(steady + begin, change + begin, m->tree_dofnum[tree]);
  }
  return steady;
}

}  // namespace mujoco_impact::engine
