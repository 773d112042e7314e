// SPDX-License-Identifier: Apache-2.0

#include "engine/deliver/arm_flights.h"

#include <algorithm>
#include <cmath>

#include "engine/path/inertia_there.h"
#include "engine/scene/tree_kinds.h"

namespace mujoco_impact::engine {

namespace {

bool MayFly(const mjModel* m, const mjData* d, int tree, Hold hold) {
  return !IsAsleep(d, tree) && hold != Hold::kTied && !KeepsInertia(m, tree) &&
         !IsFreeBody(m, tree);
}

// Stiffness of a joint that its springs have on one degree of freedom [N/m or N m/rad].
mjtNum SpringOf(const mjModel* m, int dof) {
  const int joint = m->dof_jntid[dof];
  const bool scalar = m->jnt_type[joint] == mjJNT_HINGE || m->jnt_type[joint] == mjJNT_SLIDE;
  const bool off = m->opt.disableflags & mjDSBL_SPRING;
  return scalar && !off ? m->jnt_stiffness[joint] : 0;
}

bool Resists(const mjModel* m, int tree) {
  const int begin = m->tree_dofadr[tree], end = begin + m->tree_dofnum[tree];
  const bool damped = !(m->opt.disableflags & mjDSBL_DAMPER);
  for (int i = begin; i < end; ++i) {
    if ((damped && m->dof_damping[i] > 0) || SpringOf(m, i) > 0) return true;
  }
  return false;
}

}  // namespace

ArmFlights::ArmFlights(const mjModel* m, mjData* d, const Motion& motion, const Hold* held,
                       Scratch& scratch)
    : m_(m) {
  bool* flies = scratch.Take<bool>(m->ntree);
  bool any = false;
  for (int tree = 0; tree < m->ntree; ++tree) {
    any |= flies[tree] = MayFly(m, d, tree, held[tree]);
    resists_ |= flies[tree] && Resists(m, tree);
  }
  if (!any) return;
  const int nq = static_cast<int>(m->nq), nv = static_cast<int>(m->nv);
  flies_ = flies;
  struck_ = scratch.Take<bool>(m->ntree);
  std::fill_n(struck_, m->ntree, false);
  force_ = scratch.Take<mjtNum>(nv);
  for (Twin* twin : {&now_, &unstruck_}) *twin = {scratch.Take<mjtNum>(nq), scratch.Zeros(nv)};
  moved_ = scratch.Take<mjtNum>(nv);
  faster_ = scratch.Take<mjtNum>(nv);
  mj_mulM(m, d, force_, motion.acceleration);
  mjtNum* bias = scratch.Zeros(nv);
  mj_rne(m, d, 0, bias);
  mju_addTo(force_, bias, nv);
  Begin(0, d->qpos, motion.velocity);
}

template <typename Visit>
void ArmFlights::ForEach(const bool* which, Visit visit) const {
  for (int tree = 0; tree < m_->ntree; ++tree) {
    if (which[tree]) visit(tree);
  }
}

// Both twins are there at time t.
void ArmFlights::Begin(mjtNum t, const mjtNum* qpos, const mjtNum* qvel) {
  time_ = t;
  for (const Twin* twin : {&now_, &unstruck_}) {
    mju_copy(twin->qpos, qpos, m_->nq);
    ForEach(flies_, [&](int tree) {
      const int begin = m_->tree_dofadr[tree];
      mju_copy(twin->qvel + begin, qvel + begin, m_->tree_dofnum[tree]);
    });
  }
}

void ArmFlights::Add(mjData* d, int tree, mjtNum t, const mjtNum* velocity, const mjtNum* kick,
                     const mjtNum* moment) {
  if (!followed_) {
    Begin(t, d->qpos, velocity);
    followed_ = true;
  }
  struck_[tree] = any_ = true;
  const int begin = m_->tree_dofadr[tree], dofs = m_->tree_dofnum[tree];
  mju_addTo(now_.qvel + begin, kick, dofs);
  // the impulse came t_P = moment / impulse instead of t: Δq = (t − t_P) ΔV
  Scratch scratch(d);
  mjtNum* late = scratch.Zeros(static_cast<int>(m_->nv));
  for (int i = 0; i < dofs; ++i) late[begin + i] = t * kick[i] - moment[i];
  mj_integratePos(m_, now_.qpos, late, 1);
}

void ArmFlights::Place(mjData* d, mjtNum t, Motion& path) {
  if (!followed_) return;
  Scratch scratch(d);
  const int nq = static_cast<int>(m_->nq), nv = static_cast<int>(m_->nv);
  mjtNum *qpos = scratch.Take<mjtNum>(nq), *qvel = scratch.Take<mjtNum>(nv);
  mjtNum *rate = scratch.Take<mjtNum>(nq), *acceleration = scratch.Take<mjtNum>(nv);
  mju_copy(qpos, d->qpos, nq);
  mju_copy(qvel, d->qvel, nv);
  FlyTo(d, t);
  {
    const InertiaThere restored(m_, d, scratch);
    FindRate(d, now_, rate, acceleration);
  }
  ForEach(flies_, [&](int tree) {
    const int begin = m_->tree_dofadr[tree], dofs = m_->tree_dofnum[tree];
    const int first = FirstPosition(m_, tree);
    mju_copy(qpos + first, now_.qpos + first, PositionNumber(m_, tree));
    mju_copy(qvel + begin, now_.qvel + begin, dofs);
    mju_copy(path.velocity + begin, now_.qvel + begin, dofs);
    mju_copy(path.acceleration + begin, acceleration + begin, dofs);
  });
  mju_copy(d->qpos, qpos, nq);
  mju_copy(d->qvel, qvel, nv);
}

bool ArmFlights::FlyToEnd(mjData* d) {
  if (!any_) return false;
  const mjtNum h = m_->opt.timestep;
  FlyTo(d, h);
  mj_differentiatePos(m_, moved_, 1, unstruck_.qpos, now_.qpos);
  // the velocities of MuJoCo's bodies are behind their path, by forces at the pose that it has
  if (PathLag(m_) > 0) {
    Scratch scratch(d);
    const InertiaThere restored(m_, d, scratch);
    for (const Twin& twin : {now_, unstruck_}) Advance(d, -PathLag(m_), false, false, twin);
  }
  mju_sub(faster_, now_.qvel, unstruck_.qvel, static_cast<int>(m_->nv));
  return true;
}

void ArmFlights::Finish(State& state) const {
  if (!any_) return;
  ForEach(struck_, [&](int tree) {
    const int begin = m_->tree_dofadr[tree], dofs = m_->tree_dofnum[tree];
    mju_copy(state.correction() + begin, moved_ + begin, dofs);
    mju_copy(state.held_force() + begin, faster_ + begin, dofs);
    state.flight(tree).struck = FlightRecord::kArm;
  });
}

double ArmFlights::TakeWork() {
  constexpr double kPerBody = 500, kPerVelocity = 100, kPerInertia = 10;
  const double evaluations = evaluations_;
  evaluations_ = 0;
  return evaluations == 0 ? 0
                          : evaluations * (kPerBody * static_cast<double>(m_->nbody) +
                                           kPerVelocity * static_cast<double>(m_->nv) +
                                           kPerInertia * static_cast<double>(m_->nM));
}

// In substeps that turn by at most 1/10 rad: the error of the classical Runge-Kutta method is then
// below 1e-7 of the velocities. Springs and dampers are split off, half before and half after.
void ArmFlights::FlyTo(mjData* d, mjtNum t) {
  constexpr mjtNum kMostTurn = 0.1, kMostSubsteps = 10;
  constexpr int kOfResistance = 4;
  const mjtNum time = t - time_;
  time_ = t;
  if (std::abs(time) <= 1e-12 * m_->opt.timestep) return;
  mjtNum fastest = 0;
  for (int i = 0; i < m_->nv; ++i) {
    if (m_->jnt_type[m_->dof_jntid[i]] == mjJNT_SLIDE) continue;
    fastest = std::max({fastest, std::abs(now_.qvel[i]), std::abs(unstruck_.qvel[i])});
  }
  const mjtNum turn = std::min(kMostSubsteps - 1, std::abs(time) * fastest / kMostTurn);
  const bool resist = any_ && resists_ && time > 0;
  const int substeps = std::max(1 + static_cast<int>(turn), resist ? kOfResistance : 1);
  Scratch scratch(d);
  const InertiaThere restored(m_, d, scratch);
  for (int i = 0; i < substeps; ++i) {
    Advance(d, time / substeps, true, resist, unstruck_);
    if (!any_) continue;
    if (resist) Resist(d, time / substeps / 2);
    Advance(d, time / substeps, true, resist, now_);
    if (resist) Resist(d, time / substeps / 2);
  }
  if (!any_) {
    mju_copy(now_.qpos, unstruck_.qpos, m_->nq);
    mju_copy(now_.qvel, unstruck_.qvel, m_->nv);
  }
}

// The classical Runge-Kutta method or, where what it is split from is of second order, that of the
// midpoint; `moves`: not only the velocities.
void ArmFlights::Advance(mjData* d, mjtNum time, bool moves, bool second, const Twin& twin) {
  const int nq = static_cast<int>(m_->nq), nv = static_cast<int>(m_->nv);
  constexpr mjtNum kNext[4] = {0.5, 0.5, 1, 0}, kWeight[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
  constexpr mjtNum kMidpoint[2] = {0, 1};
  const mjtNum* weight = second ? kMidpoint : kWeight;
  Scratch scratch(d);
  const Twin stage{scratch.Take<mjtNum>(nq), scratch.Take<mjtNum>(nv)};
  const Twin start{scratch.Take<mjtNum>(nq), scratch.Take<mjtNum>(nv)};
  const Twin rate{scratch.Take<mjtNum>(nq), scratch.Take<mjtNum>(nv)};
  for (const Twin* copy : {&stage, &start}) {
    mju_copy(copy->qpos, twin.qpos, nq);
    mju_copy(copy->qvel, twin.qvel, nv);
  }
  for (int i = 0; i < (second ? 2 : 4); ++i) {
    FindRate(d, stage, rate.qpos, rate.qvel);
    if (!moves) mju_zero(rate.qpos, nq);
    mju_addToScl(twin.qpos, rate.qpos, weight[i] * time, nq);
    mju_addToScl(twin.qvel, rate.qvel, weight[i] * time, nv);
    mju_addScl(stage.qpos, start.qpos, rate.qpos, kNext[i] * time, nq);
    mju_addScl(stage.qvel, start.qvel, rate.qvel, kNext[i] * time, nv);
  }
  mj_normalizeQuat(m_, twin.qpos);
}

// v' = M⁻¹(τ − c) of the trees that fly, 0 of others; leaves their inertia in `d`.
void ArmFlights::FindRate(mjData* d, const Twin& twin, mjtNum* qpos_rate, mjtNum* acceleration) {
  ++evaluations_;
  mju_copy(d->qpos, twin.qpos, m_->nq);
  mju_copy(d->qvel, twin.qvel, m_->nv);
  mj_kinematics(m_, d);
  mj_comPos(m_, d);
  mj_makeM(m_, d);
  mj_factorM(m_, d);
  mj_comVel(m_, d);
  Scratch scratch(d);
  mjtNum* bias = scratch.Zeros(static_cast<int>(m_->nv));
  mj_rne(m_, d, 0, bias);
  mju_zero(qpos_rate, m_->nq);
  mju_zero(acceleration, m_->nv);
  ForEach(flies_, [&](int tree) {
    const int begin = m_->tree_dofadr[tree];
    mju_sub(acceleration + begin, force_ + begin, bias + begin, m_->tree_dofnum[tree]);
    SolveTreeInertia(m_, d, tree, acceleration + begin);
    FindPositionRate(tree, twin, qpos_rate);
  });
}

void ArmFlights::FindPositionRate(int tree, const Twin& twin, mjtNum* qpos_rate) const {
  const int begin = m_->tree_dofadr[tree], last = begin + m_->tree_dofnum[tree] - 1;
  for (int joint = m_->dof_jntid[begin]; joint <= m_->dof_jntid[last]; ++joint) {
    int position = m_->jnt_qposadr[joint], dof = m_->jnt_dofadr[joint];
    const int type = m_->jnt_type[joint];
    if (type == mjJNT_HINGE || type == mjJNT_SLIDE) {
      qpos_rate[position] = twin.qvel[dof];
      continue;
    }
    if (type == mjJNT_FREE) {
      mju_copy3(qpos_rate + position, twin.qvel + dof);
      position += 3;
      dof += 3;
    }
    // q' = ½ q ⊗ (0, ω)
    const mjtNum spin[4] = {0, twin.qvel[dof] / 2, twin.qvel[dof + 1] / 2, twin.qvel[dof + 2] / 2};
    mju_mulQuat(qpos_rate + position, twin.qpos + position, spin);
  }
}

// What springs K and dampers B of the joints do to the difference of the twins in a short time,
//
//   (M + s B) Δv⁺ = M Δv − s K Δq
//
// implicit in the dampers, as MuJoCo is: light joints may have strong ones.
void ArmFlights::Resist(mjData* d, mjtNum time) {
  const int nv = static_cast<int>(m_->nv);
  Scratch scratch(d);
  mjtNum *difference = scratch.Take<mjtNum>(nv), *momentum = scratch.Zeros(nv);
  mju_sub(difference, now_.qvel, unstruck_.qvel, nv);
  mj_mulM(m_, d, momentum, difference);
  for (int i = 0; i < nv; ++i) {
    const mjtNum stiffness = struck_[m_->dof_treeid[i]] ? SpringOf(m_, i) : 0;
    if (stiffness == 0) continue;
    const int position = m_->jnt_qposadr[m_->dof_jntid[i]];
    momentum[i] -= time * stiffness * (now_.qpos[position] - unstruck_.qpos[position]);
  }
  const bool damped = !(m_->opt.disableflags & mjDSBL_DAMPER);
  SolveDamped(m_, d, damped ? time : 0, momentum, scratch);
  ForEach(struck_, [&](int tree) {
    const int begin = m_->tree_dofadr[tree];
    mju_add(now_.qvel + begin, unstruck_.qvel + begin, momentum + begin, m_->tree_dofnum[tree]);
  });
}

void CommitArm(const mjModel* m, mjData* d, int tree, State& state) {
  const int begin = m->tree_dofadr[tree], dofs = m->tree_dofnum[tree];
  mju_addTo(d->qvel + begin, state.held_force() + begin, dofs);
  mju_zero(state.held_force() + begin, dofs);
}

}  // namespace mujoco_impact::engine
