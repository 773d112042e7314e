// SPDX-License-Identifier: Apache-2.0

#include "engine/path/stops.h"

#include <algorithm>
#include <cmath>

#include "law/delassus.h"
#include "law/stopping_impulses.h"

namespace mujoco_impact::engine {

namespace {

// So far it may be to a stop that a joint is at, and to one that it can reach while an impact lasts
// [m or rad].
constexpr mjtNum kAtStop = 1e-6, kNear = 1e-3;

// One end of the range of a joint or a tendon.
struct End {
  bool tendon;
  int id;
  mjtNum side;     // J_s is `side` times the rate of the joint or tendon
  mjtNum axis[3];  // of a ball joint; {1} of a hinge or a slide
  mjtNum gap;
};

// Only the angle of a ball joint has an end.
End EndOfBall(const mjModel* m, const mjData* d, int joint) {
  End end{false, joint, -1, {}, 0};
  mjtNum quat[4];
  mju_copy4(quat, d->qpos + m->jnt_qposadr[joint]);
  mju_normalize4(quat);
  mju_quat2Vel(end.axis, quat, 1);
  const mjtNum angle = mju_normalize3(end.axis);
  const mjtNum* range = m->jnt_range + 2 * joint;
  end.gap = std::max(range[0], range[1]) - angle - m->jnt_margin[joint];
  return end;
}

template <typename Visit>
void VisitBoth(bool tendon, int id, mjtNum value, const mjtNum* range, mjtNum margin, Visit visit) {
  visit(End{tendon, id, 1, {1, 0, 0}, value - range[0] - margin});
  visit(End{tendon, id, -1, {1, 0, 0}, range[1] - value - margin});
}

// Visits all ends, where the bodies are in `d`.
template <typename Visit>
void ForEnds(const mjModel* m, const mjData* d, Visit visit) {
  if (m->opt.disableflags & (mjDSBL_CONSTRAINT | mjDSBL_LIMIT)) return;
  for (int i = 0; i < m->njnt; ++i) {
    if (!m->jnt_limited[i]) continue;
    if (m->jnt_type[i] == mjJNT_BALL) {
      visit(EndOfBall(m, d, i));
    } else {
      const mjtNum value = d->qpos[m->jnt_qposadr[i]];
      VisitBoth(false, i, value, m->jnt_range + 2 * i, m->jnt_margin[i], visit);
    }
  }
  for (int i = 0; i < m->ntendon; ++i) {
    if (!m->tendon_limited[i]) continue;
    VisitBoth(true, i, d->ten_length[i], m->tendon_range + 2 * i, m->tendon_margin[i], visit);
  }
}

// Calls visit(degree of freedom, J_s there).
template <typename Visit>
void ForDofs(const mjModel* m, const mjData* d, const End& end, Visit visit) {
  if (end.tendon) {
    const int begin = m->ten_J_rowadr[end.id];
    for (int a = begin; a < begin + m->ten_J_rownnz[end.id]; ++a) {
      visit(m->ten_J_colind[a], end.side * d->ten_J[a]);
    }
    return;
  }
  const int dofs = m->jnt_type[end.id] == mjJNT_BALL ? 3 : 1;
  for (int i = 0; i < dofs; ++i) visit(m->jnt_dofadr[end.id] + i, end.side * end.axis[i]);
}

// Whether the joint comes near the end in the time h.
bool ComesNear(const mjModel* m, const mjData* d, const End& end, const Motion& motion) {
  const mjtNum h = m->opt.timestep;
  mjtNum moved = 0;
  ForDofs(m, d, end, [&](int dof, mjtNum J) {
    moved += J * h * (motion.velocity[dof] + 0.5 * h * motion.acceleration[dof]);
  });
  return end.gap + std::min<mjtNum>(0, moved) <= kNear;
}

}  // namespace

Stops::Stops(const mjModel* m, mjData* d, const Motion& motion, Scratch& scratch) : m_(m), d_(d) {
  int number = 0;
  ForEnds(m, d, [&](const End& end) { number += ComesNear(m, d, end, motion); });
  if (number == 0) return;
  if (!scratch.Fits(number * (sizeof(Stop) + m->nv * sizeof(mjtNum)) + m->nq * sizeof(mjtNum))) {
    mju_warning(
        "mujoco_impact.waveform: impacts do not see %d limits of joints or tendons, for which "
        "mjData has not enough memory left; raise <size memory=\"...\"/> in the model",
        number);
    return;
  }
  start_ = scratch.Take<mjtNum>(m->nq);
  mju_copy(start_, d->qpos, static_cast<int>(m->nq));
  stop_ = scratch.Take<Stop>(number);
  ForEnds(m, d, [&](const End& end) {
    if (!ComesNear(m, d, end, motion)) return;
    mjtNum* row = scratch.Zeros(static_cast<int>(m->nv));
    ForDofs(m, d, end, [row](int dof, mjtNum J) { row[dof] = J; });
    stop_[number_++] = {end.gap, end.gap, row, false, false, end.tendon, end.id};
  });
}

void Stops::Look(const Motion& path, mjtNum tau) {
  Release();
  if (number_ == 0) return;
  const int nv = static_cast<int>(m_->nv);
  Scratch scratch(d_);
  mjtNum* moved = scratch.Take<mjtNum>(nv);
  mj_differentiatePos(m_, moved, 1, start_, d_->qpos);
  for (int i = 0; i < nv; ++i) {
    moved[i] += tau * (path.velocity[i] + 0.5 * tau * path.acceleration[i]);
  }
  for (int i = 0; i < number_; ++i) {
    stop_[i].gap = stop_[i].start + mju_dot(stop_[i].row, moved, nv);
  }
}

void Stops::Release() {
  for (int i = 0; i < number_; ++i) stop_[i].holds = false;
  held_ = 0;
}

bool Stops::FindHeld(const Mobility& ties, const mjtNum* velocity, const mjtNum* change,
                     mjtNum time, bool at_once, double* work) {
  // a chain of 40 hinges at their stops takes 200 n³ multiplications
  constexpr mjtNum kRounding = 1e-12, kWork = 2000, kEarly = 0.1;
  const int n = number_, nv = static_cast<int>(m_->nv);
  Scratch scratch(d_);
  const size_t numbers = nv + n * (2 * n + law::StoppingImpulses::kArrays + 4);
  if (n == 0 || !scratch.Fits(numbers * sizeof(mjtNum))) return false;
  mjtNum *answer = scratch.Take<mjtNum>(nv), *A = scratch.Take<mjtNum>(n * n);
  mjtNum *diagonal = scratch.Take<mjtNum>(n), *pushed = scratch.Take<mjtNum>(n);
  mjtNum* room = scratch.Take<mjtNum>(n);
  int *row_start = scratch.Take<int>(n + 1), *column = scratch.Take<int>(n * n);
  const mjtNum within = std::max(at_once ? kEarly * time : 0, mjMINVAL);
  mjtNum fastest = 0;
  // A = J_s M̃⁻¹ J_sᵀ, and Λ ≥ 0 with A Λ ≥ −J_s Δv − room
  for (int i = 0; i < n; ++i) {
    SolveTouchedTrees(m_, d_, answer, stop_[i].row);
    ties.Tie(answer);
    for (int j = 0; j < n; ++j) {
      A[i * n + j] = mju_dot(stop_[j].row, answer, nv);
      column[i * n + j] = j;
    }
    row_start[i] = i * n;
    // what is tied all over does not move
    diagonal[i] = std::max(A[i * n + i], mjMINVAL);
    pushed[i] = -mju_dot(stop_[i].row, change, nv);
    const mjtNum leaving = std::max<mjtNum>(0, mju_dot(stop_[i].row, velocity, nv));
    room[i] = std::max<mjtNum>(0, stop_[i].gap - kAtStop) / within + leaving / kEarly;
    fastest = std::max(fastest, std::abs(pushed[i]));
  }
  row_start[n] = n * n;
  const law::DelassusMatrix matrix{n, row_start, column, A, diagonal};
  law::StoppingImpulses stopping(matrix, scratch.Take<mjtNum>(law::StoppingImpulses::kArrays * n));
  const double most = kWork * n * n * n;
  stopping.Solve(pushed, room, kRounding * fastest, most);
  if (work) *work = stopping.work() + 2.0 * n * n * nv;
  if (stopping.work() >= most) {
    Release();
    return false;
  }
  bool changed = false;
  for (int i = 0; i < n; ++i) {
    const bool holds = stopping.impulse()[i] * diagonal[i] > kRounding * fastest;
    changed |= holds != stop_[i].holds;
    held_ += holds - stop_[i].holds;
    stop_[i].holds = holds;
  }
  return changed;
}

void Stops::NoteStruck(const mjtNum* velocity, const mjtNum* change) {
  const int nv = static_cast<int>(m_->nv);
  for (int i = 0; i < number_; ++i) {
    Stop& stop = stop_[i];
    const bool leaving = mju_dot(stop.row, velocity, nv) > 0;
    stop.struck |= !stop.holds && leaving && mju_dot(stop.row, change, nv) < 0;
  }
}

void Stops::Join(TreeSets& sets) const {
  for (int i = 0; i < number_; ++i) {
    int first = -1;
    for (int dof = 0; dof < m_->nv; ++dof) {
      if (stop_[i].row[dof] == 0) continue;
      const int tree = m_->dof_treeid[dof];
      if (first >= 0) sets.Join(first, tree);
      first = tree;
    }
  }
}

}  // namespace mujoco_impact::engine
