// SPDX-License-Identifier: Apache-2.0

#include "engine/path/motion.h"

#include <algorithm>

#include "engine/path/weight_gradient.h"

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

bool HasDamping(const mjModel* m) {
  return std::any_of(m->dof_damping, m->dof_damping + m->nv, [](mjtNum b) { return b > 0; });
}

// a ← (M + h B)⁻¹ M a: what implicit damping leaves of an acceleration. A light joint with strong
// damping, h B ≫ M, would by a alone be expected to turn back within the step.
void DampImplicitly(const mjModel* m, mjData* d, mjtNum* acceleration, Scratch& scratch) {
  mjtNum* x = scratch.Take<mjtNum>(m->nv);
  mju_copy(x, acceleration, static_cast<int>(m->nv));
  mj_mulM(m, d, acceleration, x);
  SolveDamped(m, d, m->opt.timestep, acceleration, scratch);
}

}  // namespace

void SolveDamped(const mjModel* m, const mjData* d, mjtNum time, mjtNum* x, Scratch& scratch) {
  const int nv = static_cast<int>(m->nv);
  mjtNum* L = scratch.Take<mjtNum>(m->nC);
  mju_copy(L, d->M, static_cast<int>(m->nC));
  const auto diagonal = [&](int i) { return m->M_rowadr[i] + m->M_rownnz[i] - 1; };
  for (int i = 0; i < nv; ++i) L[diagonal(i)] += time * m->dof_damping[i];
  // M + t B = Lᵀ D L from the leaves on: row i takes its part of the rows of its ancestors, whose
  // columns are the first of its own
  for (int i = nv - 1; i >= 0; --i) {
    const int row = m->M_rowadr[i];
    for (int a = diagonal(i) - 1; a >= row; --a) {
      const mjtNum part = L[a] / L[diagonal(i)];
      mju_addToScl(L + m->M_rowadr[m->M_colind[a]], L + row, -part, a - row + 1);
      L[a] = part;
    }
  }
  for (int i = nv - 1; i >= 0; --i) {
    for (int a = m->M_rowadr[i]; a < diagonal(i); ++a) x[m->M_colind[a]] -= L[a] * x[i];
  }
  for (int i = 0; i < nv; ++i) {
    x[i] /= L[diagonal(i)];
    for (int a = m->M_rowadr[i]; a < diagonal(i); ++a) x[i] -= L[a] * x[m->M_colind[a]];
  }
}

bool ImplicitDamping(const mjModel* m) {
  if (m->opt.integrator == mjINT_RK4 || (m->opt.disableflags & mjDSBL_DAMPER)) return false;
  return m->opt.integrator != mjINT_EULER || !(m->opt.disableflags & mjDSBL_EULERDAMP);
}

double ImpulseLag(const mjModel* m) { return m->opt.integrator == mjINT_RK4 ? 0.5 : 0; }

mjtNum PathLag(const mjModel* m) { return (0.5 - ImpulseLag(m)) * m->opt.timestep; }

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
  mjtNum* a = motion.acceleration;
  SolveInertia(m, d, a, force);
  // damping comes before the answer of the ties with `discrete`, and on top of it with the others
  const bool damped = ImplicitDamping(m) && HasDamping(m);
  const bool before = m->opt.integrator == mjINT_DISCRETE;
  if (damped && before) DampImplicitly(m, d, a, scratch);
  mobility.Tie(a);
  mobility.AddReference(a);
  if (damped && !before) DampImplicitly(m, d, a, scratch);
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

void SolveTouchedTrees(const mjModel* m, const mjData* d, mjtNum* x, const mjtNum* y) {
  mju_copy(x, y, m->nv);
  for (int tree = 0; tree < m->ntree; ++tree) {
    mjtNum* part = x + m->tree_dofadr[tree];
    if (!mju_isZero(part, m->tree_dofnum[tree])) SolveTreeInertia(m, d, tree, part);
  }
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
