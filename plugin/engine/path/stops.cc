// SPDX-License-Identifier: Apache-2.0

#include "engine/path/stops.h"

#include <algorithm>
#include <cmath>

#include "law/delassus.h"
#include "law/stopping_impulses.h"

namespace mujoco_impact::engine {

namespace {

// A joint this far from its stop stands at it [m or rad].
constexpr mjtNum kAtStop = 1e-6;

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

// Whether the joint comes to the end in the time h.
bool IsInReach(const mjModel* m, const mjData* d, const End& end, const Motion& motion) {
  const mjtNum h = m->opt.timestep;
  mjtNum moved = 0;
  ForDofs(m, d, end, [&](int dof, mjtNum J) {
    moved += J * h * (motion.velocity[dof] + 0.5 * h * motion.acceleration[dof]);
  });
  return end.gap + std::min<mjtNum>(0, moved) <= kAtStop;
}

}  // namespace

Stops::Stops(const mjModel* m, mjData* d, const Motion& motion, Scratch& scratch) : m_(m), d_(d) {
  int number = 0;
  ForEnds(m, d, [&](const End& end) { number += IsInReach(m, d, end, motion); });
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
    if (!IsInReach(m, d, end, motion)) return;
    mjtNum* row = scratch.Zeros(static_cast<int>(m->nv));
    ForDofs(m, d, end, [row](int dof, mjtNum J) { row[dof] = J; });
    stop_[number_++] = {end.gap, row, false, false};
  });
}

void Stops::Look(const Motion& path, mjtNum tau) {
  held_ = 0;
  if (number_ == 0) return;
  const int nv = static_cast<int>(m_->nv);
  Scratch scratch(d_);
  mjtNum* moved = scratch.Take<mjtNum>(nv);
  mj_differentiatePos(m_, moved, 1, start_, d_->qpos);
  for (int i = 0; i < nv; ++i) {
    moved[i] += tau * (path.velocity[i] + 0.5 * tau * path.acceleration[i]);
  }
  for (int i = 0; i < number_; ++i) {
    Stop& stop = stop_[i];
    stop.stands = stop.gap + mju_dot(stop.row, moved, nv) <= kAtStop;
    stop.holds = false;
  }
}

bool Stops::FindHeld(const Mobility& ties, const mjtNum* velocity, const mjtNum* change) {
  constexpr mjtNum kRounding = 1e-12, kWork = 1e6;
  const int nv = static_cast<int>(m_->nv);
  Scratch scratch(d_);
  int* standing = scratch.Take<int>(number_);
  int n = 0;
  for (int i = 0; i < number_; ++i) {
    if (stop_[i].stands) standing[n++] = i;
  }
  const size_t numbers = nv + n * (2 * n + law::StoppingImpulses::kArrays + 4);
  if (n == 0 || !scratch.Fits(numbers * sizeof(mjtNum))) return false;
  // A Λ ≥ −J_s Δv − max(0, J_s v),  A = J_s M̃⁻¹ J_sᵀ
  mjtNum *answer = scratch.Take<mjtNum>(nv), *A = scratch.Take<mjtNum>(n * n);
  mjtNum *diagonal = scratch.Take<mjtNum>(n), *closing = scratch.Take<mjtNum>(n);
  mjtNum* leaving = scratch.Take<mjtNum>(n);
  int *row_start = scratch.Take<int>(n + 1), *column = scratch.Take<int>(n * n);
  mjtNum fastest = 0;
  for (int a = 0; a < n; ++a) {
    const mjtNum* row = stop_[standing[a]].row;
    SolveTouchedTrees(m_, d_, answer, row);
    if (ties.ties() > 0) ties.Tie(answer);
    for (int b = 0; b < n; ++b) {
      A[a * n + b] = mju_dot(stop_[standing[b]].row, answer, nv);
      column[a * n + b] = b;
    }
    row_start[a] = a * n;
    // what is tied all over does not move
    diagonal[a] = std::max(A[a * n + a], mjMINVAL);
    closing[a] = -mju_dot(row, change, nv);
    leaving[a] = std::max<mjtNum>(0, mju_dot(row, velocity, nv));
    fastest = std::max(fastest, std::abs(closing[a]));
  }
  row_start[n] = n * n;
  const law::DelassusMatrix matrix{n, row_start, column, A, diagonal};
  law::StoppingImpulses stopping(matrix, scratch.Take<mjtNum>(law::StoppingImpulses::kArrays * n));
  stopping.Solve(closing, leaving, kRounding * fastest, kWork);
  bool changed = false;
  for (int a = 0; a < n; ++a) {
    Stop& stop = stop_[standing[a]];
    const bool holds = stopping.impulse()[a] * diagonal[a] > kRounding * fastest;
    changed |= holds != stop.holds;
    held_ += holds - stop.holds;
    stop.holds = holds;
  }
  return changed;
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
