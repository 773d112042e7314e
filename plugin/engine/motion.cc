// SPDX-License-Identifier: Apache-2.0

#include "engine/motion.h"

#include "engine/weight_gradient.h"

namespace mujoco_impact::engine {

namespace {

void AddAppliedForces(const mjModel* m, mjData* d, mjtNum* force) {
  mju_addTo(force, d->qfrc_applied, m->nv);
  for (int body = 1; body < m->nbody; ++body) {
    const mjtNum* wrench = d->xfrc_applied + 6 * body;
    if (!mju_isZero(wrench, 6)) {
      mj_applyFT(m, d, wrench, wrench + 3, d->xipos + 3 * body, body, force);
    }
  }
}

}  // namespace

double ImpulseLag(const mjModel* m) { return m->opt.integrator == mjINT_RK4 ? 0.5 : 0; }

Motion PredictMotion(const mjModel* m, mjData* d, const Mobility& mobility, Scratch& scratch) {
  const int nv = m->nv;
  Motion motion{scratch.Take<mjtNum>(nv), scratch.Take<mjtNum>(nv), scratch.Take<mjtNum>(nv)};
  // zeros: MuJoCo leaves out what sleeps
  mjtNum* force = scratch.Zeros(nv);
  mj_rne(m, d, 0, force);
  mju_sub(force, d->qfrc_passive, force, nv);
  AddAppliedForces(m, d, force);
  if (m->nu > 0) {
    // this step's actuation is computed after the passive forces
    mj_fwdActuation(m, d);
    mju_addTo(force, d->qfrc_actuator, nv);
  }
  mobility.Solve(motion.acceleration, force);
  mobility.AddReference(motion.acceleration);
  const mjtNum lead = m->opt.integrator == mjINT_RK4 ? 0 : 0.5 * m->opt.timestep;
  mju_addScl(motion.velocity, d->qvel, motion.acceleration, lead, nv);
  mju_zero(force, nv);
  AddWeightGradient(m, d, motion.velocity, force);
  mobility.Solve(motion.jerk, force);
  return motion;
}

void VelocityOnPath(const mjModel* m, const Motion& motion, mjtNum tau, mjtNum* velocity) {
  mju_addScl(velocity, motion.velocity, motion.acceleration, tau, m->nv);
  mju_addToScl(velocity, motion.jerk, 0.5 * tau * tau, m->nv);
}

void SolveInertia(const mjModel* m, mjData* d, mjtNum* x, const mjtNum* y) {
  mju_zero(x, m->nv);
  mj_solveM(m, d, x, y, 1);
}

void SolveTreeInertia(const mjModel* m, const mjData* d, int tree, mjtNum* x) {
  const int begin = m->tree_dofadr[tree];
  const int end = begin + m->tree_dofnum[tree];
  // M = Lᵀ D L in rows of qLD, diagonal last; all columns of a row are dofs of its tree
  for (int i = end - 1; i >= begin; --i) {
    const int row = m->M_rowadr[i];
    for (int a = row; a < row + m->M_rownnz[i] - 1; ++a) {
      x[m->M_colind[a] - begin] -= d->qLD[a] * x[i - begin];
    }
  }
  for (int i = begin; i < end; ++i) {
    x[i - begin] *= d->qLDiagInv[i];
    const int row = m->M_rowadr[i];
    for (int a = row; a < row + m->M_rownnz[i] - 1; ++a) {
      x[i - begin] -= d->qLD[a] * x[m->M_colind[a] - begin];
    }
  }
}

}  // namespace mujoco_impact::engine
