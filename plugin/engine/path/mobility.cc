// SPDX-License-Identifier: Apache-2.0

#include "engine/path/mobility.h"

#include "engine/common/tree_sets.h"
#include "engine/path/motion.h"
#include "engine/scene/softness.h"

namespace mujoco_impact::engine {

namespace {

// Row i of the constraint Jacobian, dense.
void CopyRow(const mjModel* m, const mjData* d, int i, mjtNum* row) {
  if (!mj_isSparse(m)) {
    mju_copy(row, d->efc_J + i * m->nv, m->nv);
    return;
  }
  mju_zero(row, m->nv);
  for (int a = d->efc_J_rowadr[i]; a < d->efc_J_rowadr[i] + d->efc_J_rownnz[i]; ++a) {
    row[d->efc_J_colind[a]] = d->efc_J[a];
  }
}

size_t TieBytes(const mjModel* m, int ties) {
  const size_t numbers = 2 * m->nv + ties + 3;
  return ties * numbers * sizeof(mjtNum) + 2 * m->ntree * sizeof(int);
}

}  // namespace

Mobility::Mobility(const mjModel* m, mjData* d, Scratch& scratch) : m_(m), d_(d) {
  if (d->ne == 0) return;
  if (!scratch.Fits(TieBytes(m, d->ne))) {
    mju_warning(
        "mujoco_impact.waveform: impacts do not see %d equality constraints, for which mjData has "
        "not enough memory left; raise <size memory=\"...\"/> in the model",
        static_cast<int>(d->ne));
    return;
  }
  ties_ = d->ne;
  const int nv = m->nv;
  rows_ = scratch.Take<mjtNum>(ties_ * nv);
  answer_ = scratch.Take<mjtNum>(ties_ * nv);
  factor_ = scratch.Take<mjtNum>(ties_ * ties_);
  reference_ = scratch.Take<mjtNum>(ties_);
  work_ = scratch.Take<mjtNum>(2 * ties_);
  for (int i = 0; i < ties_; ++i) {
    CopyRow(m, d, i, rows_ + i * nv);
    SolveInertia(m, d, answer_ + i * nv, rows_ + i * nv);
  }
  // A + R
  mju_mulMatMatT(factor_, rows_, answer_, ties_, nv, ties_);
  MakeReferences(m, d, factor_);
  for (int i = 0; i < ties_; ++i) factor_[i * (ties_ + 1)] += d->efc_R[i];
  mju_copy(reference_, d->efc_aref, ties_);
  mju_cholFactor(factor_, ties_, mjMINVAL);
  FindGroups(scratch);
}

void Mobility::FindGroups(Scratch& scratch) {
  TreeSets sets(m_->ntree, scratch);
  for (int i = 0; i < ties_; ++i) {
    int first = -1;
    for (int dof = 0; dof < m_->nv; ++dof) {
      if (rows_[i * m_->nv + dof] == 0) continue;
      const int tree = m_->dof_treeid[dof];
      if (first >= 0) sets.Join(first, tree);
      first = tree;
    }
  }
  group_ = scratch.Take<int>(m_->ntree);
  for (int tree = 0; tree < m_->ntree; ++tree) group_[tree] = sets.Root(tree);
}

void Mobility::Solve(mjtNum* x, const mjtNum* y) const {
  SolveInertia(m_, d_, x, y);
  Tie(x);
}

void Mobility::Tie(mjtNum* x) const {
  if (ties_ == 0) return;
  mjtNum *rate = work_, *force = work_ + ties_;
  // x −= M⁻¹Jᵀ(A + R)⁻¹J x
  mju_mulMatVec(rate, rows_, x, ties_, m_->nv);
  SolveTies(force, rate);
  for (int i = 0; i < ties_; ++i) mju_addToScl(x, answer_ + i * m_->nv, -force[i], m_->nv);
}

void Mobility::AddReference(mjtNum* a) const {
  if (ties_ == 0) return;
  mjtNum* force = work_;
  SolveTies(force, reference_);
  for (int i = 0; i < ties_; ++i) mju_addToScl(a, answer_ + i * m_->nv, force[i], m_->nv);
}

void Mobility::AddTieRates(int tree, const mjtNum* x, mjtNum* result) const {
  const int begin = m_->tree_dofadr[tree], dofs = m_->tree_dofnum[tree];
  for (int i = 0; i < ties_; ++i) result[i] += mju_dot(rows_ + i * m_->nv + begin, x, dofs);
}

}  // namespace mujoco_impact::engine
