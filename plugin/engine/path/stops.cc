// SPDX-License-Identifier: Apache-2.0

#include "engine/path/stops.h"

#include <algorithm>

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
    stop_[number_++] = {end.gap, row, Role::kAway};
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
    stop.role = stop.gap + mju_dot(stop.row, moved, nv) <= kAtStop ? Role::kFree : Role::kAway;
  }
}

bool Stops::Change(const mjtNum* velocity, const mjtNum* change, const mjtNum* impulse) {
  const int nv = static_cast<int>(m_->nv);
  bool any = false;
  int next = 0;
  for (int i = 0; i < number_; ++i) {
    Stop& stop = stop_[i];
    if (stop.role == Role::kHeld && impulse[next++] < 0) {
      stop.role = Role::kReleased;
      --held_;
      any = true;
    } else if (stop.role == Role::kFree) {
      // J_s v⁺ < min(0, J_s v)
      const mjtNum rate = mju_dot(stop.row, velocity, nv);
      if (mju_dot(stop.row, change, nv) >= -std::max<mjtNum>(0, rate)) continue;
      stop.role = Role::kHeld;
      ++held_;
      any = true;
    }
  }
  return any;
}

void Stops::Release() {
  for (int i = 0; i < number_; ++i) stop_[i].role = Role::kAway;
  held_ = 0;
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
