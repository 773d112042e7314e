// SPDX-License-Identifier: Apache-2.0

#include "engine/foresee/outlook.h"

namespace mujoco_impact::engine {

Outlook LookAhead(const mjModel* m, mjData* d, const Mobility& mobility, const Delivery& delivery,
                  const MocapRecord* mocap, bool pulses, Scratch& scratch) {
  Outlook outlook{0, PredictMotion(m, d, mobility, scratch), nullptr, nullptr};
  outlook.motion.mocap = mocap;
  if (!pulses) return outlook;
  outlook.bend = scratch.Take<mjtNum>(m->nv);
  outlook.arrears = scratch.Take<mjtNum>(m->nv);
  mobility.Solve(outlook.bend, delivery.impulse);
  mju_scl(outlook.bend, outlook.bend, 1 / m->opt.timestep, m->nv);
  mju_addTo(outlook.motion.acceleration, outlook.bend, m->nv);
  mobility.Solve(outlook.arrears, delivery.remaining);
  return outlook;
}

mjtNum* SettledVelocity(const mjModel* m, const Outlook& outlook, mjtNum tau, Scratch& scratch) {
  mjtNum* velocity = scratch.Take<mjtNum>(m->nv);
  VelocityOnPath(m, outlook.motion, tau, velocity);
  if (outlook.arrears) mju_addTo(velocity, outlook.arrears, m->nv);
  // the part that the path already has by τ is not to come again
  if (outlook.bend) mju_addToScl(velocity, outlook.bend, -tau, m->nv);
  return velocity;
}

BodiesInStep::BodiesInStep(const mjModel* m, mjData* d, const Mobility& mobility,
                           const Outlook& start, Flights& flights, Scratch& scratch)
    : m_(m),
      d_(d),
      mobility_(mobility),
      start_(start),
      flights_(flights),
      qpos_(scratch.Take<mjtNum>(m->nq)),
      qvel_(scratch.Take<mjtNum>(m->nv)),
      mocap_pos_(scratch.Take<mjtNum>(3 * m->nmocap)),
      mocap_quat_(scratch.Take<mjtNum>(4 * m->nmocap)),
      moved_{scratch.Take<mjtNum>(m->nv), scratch.Take<mjtNum>(m->nv), scratch.Take<mjtNum>(m->nv),
             start.motion.mocap},
      kick_(scratch.Take<mjtNum>(m->nv)),
      displacement_(scratch.Take<mjtNum>(m->nv)),
      work_(scratch.Take<mjtNum>(m->nv)),
      arrears_(scratch.Take<mjtNum>(m->nv)) {
  mju_copy(qpos_, d->qpos, m->nq);
  mju_copy(qvel_, d->qvel, m->nv);
  mju_copy(mocap_pos_, d->mocap_pos, 3 * m->nmocap);
  mju_copy(mocap_quat_, d->mocap_quat, 4 * m->nmocap);
}

BodiesInStep::~BodiesInStep() { PutBack(); }

void BodiesInStep::PutBack() {
  if (away_) Place(0, nullptr, qvel_);
  away_ = false;
}

void BodiesInStep::FlyToEnd() { away_ = flights_.FlyToEnd(d_) || away_; }

Outlook BodiesInStep::MoveTo(mjtNum t, const Delivery& delivery, const Kicks& kicks, mjtNum* owed) {
  const int nv = m_->nv;
  const Motion& motion = start_.motion;
  // G M⁻¹ Jᵀ of P, P (t − s) and P (t − s)²/2
  const auto gradient = [&](const mjtNum* kick, mjtNum* result) {
    mju_zero(work_, nv);
    AddWeightGradient(m_, d_, kick, work_);
    mobility_.Solve(result, work_);
  };
  mjtNum *v = moved_.velocity, *a = moved_.acceleration, *b = moved_.jerk;
  mobility_.Solve(kick_, delivery.impulse);
  if (kicks.any) AddTied(kicks.velocity, 1, kick_);
  gradient(kick_, b);
  mju_scl(work_, delivery.impulse, t, nv);
  mju_subFrom(work_, delivery.moment, nv);
  mobility_.Solve(displacement_, work_);
  if (kicks.any) {
    AddTied(kicks.velocity, t, displacement_);
    AddTied(kicks.moment, -1, displacement_);
  }
  gradient(displacement_, a);
  for (int i = 0; i < nv; ++i) {
    work_[i] =
        0.5 * t * t * delivery.impulse[i] - t * delivery.moment[i] + 0.5 * delivery.second[i];
  }
  mobility_.Solve(v, work_);
  gradient(v, v);
  for (int i = 0; i < nv; ++i) {
    const mjtNum V = motion.velocity[i], A = motion.acceleration[i], B = motion.jerk[i];
    displacement_[i] += V * t + A * t * t / 2 + B * t * t * t / 6;
    v[i] += V + A * t + B * t * t / 2 + kick_[i];
    a[i] += A + B * t;
    b[i] += B;
  }
  Place(t, displacement_, v);
  return {t, moved_, start_.bend, ArrearsAt(t, owed)};
}

// result += s ΔV, and what ties make of it.
void BodiesInStep::AddTied(const mjtNum* kick, mjtNum s, mjtNum* result) {
  mju_copy(work_, kick, m_->nv);
  mobility_.Tie(work_);
  mju_addToScl(result, work_, s, m_->nv);
}

mjtNum* BodiesInStep::ArrearsAt(mjtNum t, mjtNum* owed) {
  if (!start_.arrears) return owed;
  // the pulses that bend the path have delivered a part by t
  mju_addScl(arrears_, start_.arrears, start_.bend, -t, m_->nv);
  if (owed) mju_addTo(arrears_, owed, m_->nv);
  return arrears_;
}

// MuJoCo's own kinematics at qpos ⊕ displacement, or at qpos if that is null: the same code with
// the same input gives the same bits when the bodies are put back.
void BodiesInStep::Place(mjtNum t, const mjtNum* displacement, const mjtNum* velocity) {
  mju_copy(d_->mocap_pos, mocap_pos_, 3 * m_->nmocap);
  mju_copy(d_->mocap_quat, mocap_quat_, 4 * m_->nmocap);
  if (displacement) MoveMocap(m_, d_, start_.motion.mocap, t);
  mju_copy(d_->qpos, qpos_, m_->nq);
  if (displacement) mj_integratePos(m_, d_->qpos, displacement, 1);
  mju_copy(d_->qvel, velocity, m_->nv);
  if (displacement) flights_.Place(d_, t, moved_);
  mj_kinematics(m_, d_);
  mj_comPos(m_, d_);
  mj_comVel(m_, d_);
  away_ = true;
}

}  // namespace mujoco_impact::engine
