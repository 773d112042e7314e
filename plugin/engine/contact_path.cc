// SPDX-License-Identifier: Apache-2.0

#include "engine/contact_path.h"

#include <algorithm>
#include <cmath>

namespace mujoco_impact::engine {

namespace {

BodyPoint RepresentativePoint(const mjModel* m, const mjData* d, const mjContact& contact, int i) {
  const int geom = contact.geom[i];
  BodyPoint point{m->geom_bodyid[geom], {}};
  const bool sphere = m->geom_type[geom] == mjGEOM_SPHERE;
  mju_copy3(point.position, sphere ? d->geom_xpos + 3 * geom : contact.pos);
  return point;
}

bool IsSphere(const mjModel* m, int geom) { return m->geom_type[geom] == mjGEOM_SPHERE; }

}  // namespace

mjtNum ClosingSpeed(const mjModel* m, const mjData* d, const mjContact& contact) {
  mjtNum v[2][3];
  for (int i = 0; i < 2; ++i) {
    BodyPoint point{m->geom_bodyid[contact.geom[i]], {}};
    mju_copy3(point.position, contact.pos);
    PointVelocity(m, d, point, v[i]);
  }
  // c = −n·(v₂ − v₁)
  return mju_dot3(contact.frame, v[0]) - mju_dot3(contact.frame, v[1]);
}

ContactPath::ContactPath(const mjModel* m, const mjData* d, const mjContact& contact,
                         const Motion& motion)
    : spheres_(IsSphere(m, contact.geom[0]) && IsSphere(m, contact.geom[1])), gap_(contact.dist) {
  mju_copy3(normal_, contact.frame);
  for (int i = 0; i < 2; ++i) {
    side_[i] = RepresentativePoint(m, d, contact, i);
    // a contact point slides over any other shape, so the turning of the body does not move it
    const bool turning = IsSphere(m, contact.geom[i]);
    of_side_[i] = PointMotion(m, d, side_[i], motion, turning);
  }
}

void ContactPath::SideAt(int i, mjtNum tau, mjtNum position[3]) const {
  mju_copy3(position, side_[i].position);
  MovePoint(of_side_[i], tau, position);
}

void ContactPath::Distance(mjtNum tau, mjtNum distance[3]) const {
  mjtNum first[3];
  SideAt(0, tau, first);
  SideAt(1, tau, distance);
  mju_subFrom3(distance, first);
}

mjtNum ContactPath::Gap(mjtNum tau) const {
  mjtNum change[3] = {0, 0, 0}, first[3] = {0, 0, 0};
  MovePoint(of_side_[1], tau, change);
  MovePoint(of_side_[0], tau, first);
  mju_subFrom3(change, first);
  if (!spheres_) return gap_ + mju_dot3(normal_, change);
  // |D(τ)| − |D(0)| without cancellation: (D(τ) − D(0))·(D(τ) + D(0)) / (|D(τ)| + |D(0)|)
  mjtNum before[3], after[3], sum[3];
  mju_sub3(before, side_[1].position, side_[0].position);
  mju_add3(after, before, change);
  mju_add3(sum, before, after);
  return gap_ + mju_dot3(change, sum) / (mju_norm3(before) + mju_norm3(after));
}

void ContactPath::Normal(mjtNum tau, mjtNum normal[3]) const {
  mju_copy3(normal, normal_);
  if (!spheres_) return;
  Distance(tau, normal);
  mju_normalize3(normal);
}

mjtNum ContactPath::GapRate(mjtNum tau) const {
  mjtNum n[3], rate[3] = {0, 0, 0};
  Normal(tau, n);
  for (int i = 0; i < 2; ++i) {
    const PointDerivatives& x = of_side_[i];
    const mjtNum sign = i == 0 ? -1 : 1;
    mju_addToScl3(rate, x.velocity, sign);
    mju_addToScl3(rate, x.acceleration, sign * tau);
    mju_addToScl3(rate, x.jerk, sign * tau * tau / 2);
  }
  return mju_dot3(n, rate);
}

bool ContactPath::ClosingTime(mjtNum timestep, mjtNum touch, mjtNum* tau) const {
  constexpr int kNewtonSteps = 6;
  constexpr mjtNum kLatest = 0.25;  // of a step: closing that the last step could not see
  mjtNum rate = GapRate(0);
  if (rate >= 0 || Gap(timestep) >= -touch) return false;
  mjtNum t = 0;
  for (int i = 0; i < kNewtonSteps; ++i) {
    rate = GapRate(t);
    if (rate >= 0) break;
    const mjtNum step = -Gap(t) / rate;
    t += step;
    if (std::abs(step) < 1e-12 * timestep) break;
    if (t < -timestep || t > 2 * timestep) break;
  }
  // an overlap that this closing speed cannot have made was there before: it closes now
  *tau = t < -kLatest * timestep ? 0 : std::min(t, timestep);
  return true;
}

}  // namespace mujoco_impact::engine
