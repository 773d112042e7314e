// SPDX-License-Identifier: Apache-2.0

#include "engine/mobility.h"

#include <algorithm>
#include <cmath>

#include "engine/motion.h"
#include "engine/tree_sets.h"

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

// How soft a tie is: R, and a_ref = −damping (J v) − stiffness (pos − margin).
struct Softness {
  mjtNum regularization, stiffness, damping;
};

// The impedance d by solimp, at the violation of the constraint.
mjtNum Impedance(const mjtNum* solimp, mjtNum violation) {
  const mjtNum x = std::min<mjtNum>(1, std::abs(violation) / std::max(mjMINVAL, solimp[2]));
  const mjtNum midpoint = solimp[3], power = solimp[4];
  // y = x^p / m^(p−1) up to the midpoint m, and the same turned by half a circle above
  const mjtNum y = x <= midpoint ? std::pow(x, power) / std::pow(midpoint, power - 1)
                                 : 1 - std::pow(1 - x, power) / std::pow(1 - midpoint, power - 1);
  return std::clamp<mjtNum>(solimp[0] + y * (solimp[1] - solimp[0]), mjMINIMP, mjMAXIMP);
}

// The integrator `discrete` makes them only after the passive forces.
Softness SoftnessBySolver(const mjModel* m, const mjData* d, int i, mjtNum A) {
  const mjtNum* solimp = m->eq_solimp + mjNIMP * d->efc_id[i];
  const mjtNum* solref = m->eq_solref + mjNREF * d->efc_id[i];
  const mjtNum impedance = Impedance(solimp, d->efc_pos[i] - d->efc_margin[i]);
  const mjtNum most = std::clamp<mjtNum>(solimp[1], mjMINIMP, mjMAXIMP);
  // no smaller for a row without effect, of which A_ii = 0
  const mjtNum regularization = (1 - impedance) / impedance * std::max(A, mjMINVAL);
  if (solref[0] <= 0) {
    return {regularization, -solref[0] / (most * most) * impedance, -solref[1] / most};
  }
  const mjtNum time = std::max(solref[0], 2 * m->opt.timestep), ratio = solref[1];
  return {regularization, impedance / (most * most * time * time * ratio * ratio),
          2 / (most * time)};
}

Softness SoftnessOf(const mjModel* m, const mjData* d, int i, mjtNum A) {
  if (m->opt.integrator == mjINT_DISCRETE) return SoftnessBySolver(m, d, i, A);
  const mjtNum* KBI = d->efc_KBIP + 4 * i;
  return {d->efc_R[i], KBI[0] * KBI[2], KBI[1]};
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
  for (int i = 0; i < ties_; ++i) {
    mjtNum& A = factor_[i * (ties_ + 1)];
    const Softness softness = SoftnessOf(m, d, i, A);
    reference_[i] = -softness.damping * mju_dot(rows_ + i * nv, d->qvel, nv) -
                    softness.stiffness * (d->efc_pos[i] - d->efc_margin[i]);
    A += softness.regularization;
  }
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
  if (ties_ > 0) Tie(x);
}

void Mobility::Tie(mjtNum* x) const {
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
