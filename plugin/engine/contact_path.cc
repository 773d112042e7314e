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
  mjtNum v[2][3], a[2][3];
  for (int i = 0; i < 2; ++i) {
    side_[i] = RepresentativePoint(m, d, contact, i);
    // a contact point slides over any other shape, so the turning of the body does not move it
    const bool turning = IsSphere(m, contact.geom[i]);
    PointMotion(m, d, side_[i], motion, turning, v[i], a[i]);
  }
  mju_sub3(distance_, side_[1].position, side_[0].position);
  mju_sub3(velocity_, v[1], v[0]);
  mju_sub3(acceleration_, a[1], a[0]);
}

// D(τ) = D + Ḋ τ + D̈ τ²/2
void ContactPath::Offset(mjtNum tau, mjtNum offset[3]) const {
  mju_copy3(offset, distance_);
  mju_addToScl3(offset, velocity_, tau);
  mju_addToScl3(offset, acceleration_, 0.5 * tau * tau);
}

mjtNum ContactPath::Gap(mjtNum tau) const {
  mjtNum moved[3];
  Offset(tau, moved);
  if (!spheres_) {
    mju_subFrom3(moved, distance_);
    return gap_ + mju_dot3(normal_, moved);
  }
  // |D(τ)| − |D(0)| without cancellation: (|D(τ)|² − |D(0)|²) / (|D(τ)| + |D(0)|)
  mjtNum change[3], sum[3];
  mju_sub3(change, moved, distance_);
  mju_add3(sum, moved, distance_);
  return gap_ + mju_dot3(change, sum) / (mju_norm3(moved) + mju_norm3(distance_));
}

void ContactPath::Normal(mjtNum tau, mjtNum normal[3]) const {
  mju_copy3(normal, normal_);
  if (!spheres_) return;
  Offset(tau, normal);
  mju_normalize3(normal);
}

mjtNum ContactPath::GapRate(mjtNum tau) const {
  mjtNum n[3], rate[3];
  Normal(tau, n);
  mju_copy3(rate, velocity_);
  mju_addToScl3(rate, acceleration_, tau);
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
