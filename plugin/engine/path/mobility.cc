// SPDX-License-Identifier: Apache-2.0

#include "engine/path/mobility.h"

#include "engine/common/tree_sets.h"
#include "engine/path/motion.h"
#include "engine/path/stops.h"
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
  TakeRows(scratch);
  reference_ = scratch.Take<mjtNum>(ties_);
  for (int i = 0; i < ties_; ++i) {
    CopyRow(m, d, i, row(i));
    SolveInertia(m, d, answer(i), row(i));
  }
  // A + R
  mju_mulMatMatT(factor_, rows_, answer_, ties_, nv, ties_);
  MakeReferences(m, d, factor_);
  for (int i = 0; i < ties_; ++i) factor_[i * (ties_ + 1)] += d->efc_R[i];
  mju_copy(reference_, d->efc_aref, ties_);
  mju_cholFactor(factor_, ties_, mjMINVAL);
  FindGroups(scratch);
}

size_t Mobility::StopBytes(const mjModel* m, const Mobility& others, const Stops& stops) {
  return stops.held() == 0 ? 0 : TieBytes(m, others.ties_ + stops.held());
}

Mobility::Mobility(const Mobility& others, const Stops& stops, Scratch& scratch)
    : Mobility(others) {
  constexpr mjtNum kSoft = 1e-12;  // of A: two stops may hold the same
  if (stops.held() == 0) return;
  stops_ = stops.held();
  ties_ += stops_;
  TakeRows(scratch);
  for (int i = 0; i < others.ties_; ++i) {
    mju_copy(row(i), others.row(i), m_->nv);
    SolveInertia(m_, d_, answer(i), row(i));
  }
  int next = others.ties_;
  stops.ForHeld([&](const mjtNum* stop) {
    mju_copy(row(next), stop, m_->nv);
    mju_copy(answer(next), stop, m_->nv);
    ForTrees(next,
             [&](int tree, int begin) { SolveTreeInertia(m_, d_, tree, answer(next) + begin); });
    ++next;
  });
  mju_mulMatMatT(factor_, rows_, answer_, ties_, m_->nv, ties_);
  for (int i = 0; i < ties_; ++i) {
    mjtNum& own = factor_[i * (ties_ + 1)];
    own += i < others.ties_ ? d_->efc_R[i] : kSoft * own;
  }
  mju_cholFactor(factor_, ties_, mjMINVAL);
  FindGroups(scratch);
}

void Mobility::TakeRows(Scratch& scratch) {
  rows_ = scratch.Take<mjtNum>(ties_ * m_->nv);
  answer_ = scratch.Take<mjtNum>(ties_ * m_->nv);
  factor_ = scratch.Take<mjtNum>(ties_ * ties_);
  work_ = scratch.Take<mjtNum>(2 * ties_);
}

void Mobility::FindGroups(Scratch& scratch) {
  TreeSets sets(m_->ntree, scratch);
  for (int i = 0; i < ties_; ++i) {
    int first = -1;
    ForTrees(i, [&](int tree, int) {
      if (first >= 0) sets.Join(first, tree);
      first = tree;
    });
  }
  group_ = scratch.Take<int>(m_->ntree);
  for (int tree = 0; tree < m_->ntree; ++tree) group_[tree] = sets.Root(tree);
}

void Mobility::Solve(mjtNum* x, const mjtNum* y) const {
  SolveInertia(m_, d_, x, y);
  Tie(x);
}

void Mobility::Tie(mjtNum* x, mjtNum* force) const {
  if (ties_ == 0) return;
  mjtNum *rate = work_, *pull = force ? force : work_ + ties_;
  // −(A + R)⁻¹J x
  mju_mulMatVec(rate, rows_, x, ties_, m_->nv);
  SolveTies(pull, rate);
  mju_scl(pull, pull, -1, ties_);
  AddForces(pull, x);
}

void Mobility::Halt(mjtNum* x) const {
  if (stops_ == 0) return;
  mjtNum *rate = work_, *pull = work_ + ties_;
  mju_mulMatVec(rate, rows_, x, ties_, m_->nv);
  mju_zero(rate, ties_ - stops_);
  SolveTies(pull, rate);
  mju_scl(pull, pull, -1, ties_);
  AddForces(pull, x);
}

void Mobility::AddStops(const mjtNum* impulse, mjtNum* sum, Scratch& scratch) const {
  if (stops_ == 0) return;
  mjtNum *x = scratch.Take<mjtNum>(m_->nv), *pull = scratch.Take<mjtNum>(ties_);
  SolveInertia(m_, d_, x, impulse);
  Tie(x, pull);
  for (int i = ties_ - stops_; i < ties_; ++i) mju_addToScl(sum, row(i), pull[i], m_->nv);
}

// x += M⁻¹ Jᵀ f
void Mobility::AddForces(const mjtNum* force, mjtNum* x) const {
  for (int i = 0; i < ties_; ++i) mju_addToScl(x, answer(i), force[i], m_->nv);
}

void Mobility::AddReference(mjtNum* a) const {
  if (ties_ == 0) return;
  mjtNum* force = work_;
  mju_zero(force, ties_);
  mju_copy(force, reference_, ties_ - stops_);
  mju_cholSolve(force, factor_, force, ties_);
  AddForces(force, a);
}

void Mobility::AddTieRates(int tree, const mjtNum* x, mjtNum* result) const {
  const int begin = m_->tree_dofadr[tree], dofs = m_->tree_dofnum[tree];
  for (int i = 0; i < ties_; ++i) result[i] += mju_dot(rows_ + i * m_->nv + begin, x, dofs);
}

}  // namespace mujoco_impact::engine
