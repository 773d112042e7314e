// SPDX-License-Identifier: Apache-2.0

#include "engine/contact_path.h"

#include <algorithm>
#include <cmath>

namespace mujoco_impact::engine {

namespace {

bool IsSphere(const mjModel* m, int geom) { return m->geom_type[geom] == mjGEOM_SPHERE; }

// Distance of the two points, along the normal unless both are centres of spheres.
mjtNum Separation(const ContactAnchor& anchor, const mjtNum first[3], const mjtNum second[3]) {
  mjtNum between[3];
  mju_sub3(between, second, first);
  return anchor.spheres() ? mju_norm3(between) : mju_dot3(anchor.normal, between);
}

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

ContactAnchor AnchorContact(const mjModel* m, const mjData* d, const mjContact& contact) {
  ContactAnchor anchor;
  const mjtNum* position[2];
  mju_copy3(anchor.normal, contact.frame);
  for (int i = 0; i < 2; ++i) {
    const int geom = contact.geom[i];
    const int body = anchor.body[i] = m->geom_bodyid[geom];
    anchor.sphere[i] = IsSphere(m, geom);
    position[i] = anchor.sphere[i] ? d->geom_xpos + 3 * geom : contact.pos;
    mjtNum offset[3];
    mju_sub3(offset, position[i], d->xpos + 3 * body);
    mju_mulMatTVec3(anchor.local[i], d->xmat + 9 * body, offset);
  }
  anchor.rest = Separation(anchor, position[0], position[1]) - contact.dist;
  return anchor;
}

ContactPath::ContactPath(const mjModel* m, const mjData* d, const ContactAnchor& anchor,
                         const Motion& motion)
    : anchor_(anchor) {
  for (int i = 0; i < 2; ++i) {
    const int body = side_[i].body = anchor.body[i];
    mju_mulMatVec3(side_[i].position, d->xmat + 9 * body, anchor.local[i]);
    mju_addTo3(side_[i].position, d->xpos + 3 * body);
    // a contact point slides over any other shape, so the turning of the body does not move it
    of_side_[i] = PointMotion(m, d, side_[i], motion, anchor.sphere[i]);
  }
  gap_ = Separation(anchor, side_[0].position, side_[1].position) - anchor.rest;
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
  if (!anchor_.spheres()) return gap_ + mju_dot3(anchor_.normal, change);
  // |D(τ)| − |D(0)| without cancellation: (D(τ) − D(0))·(D(τ) + D(0)) / (|D(τ)| + |D(0)|)
  mjtNum before[3], after[3], sum[3];
  mju_sub3(before, side_[1].position, side_[0].position);
  mju_add3(after, before, change);
  mju_add3(sum, before, after);
  return gap_ + mju_dot3(change, sum) / (mju_norm3(before) + mju_norm3(after));
}

void ContactPath::Normal(mjtNum tau, mjtNum normal[3]) const {
  mju_copy3(normal, anchor_.normal);
  if (!anchor_.spheres()) return;
  Distance(tau, normal);
  mju_normalize3(normal);
}

void ContactPath::DistanceRate(mjtNum tau, mjtNum rate[3]) const {
  mju_zero3(rate);
  for (int i = 0; i < 2; ++i) {
    const PointDerivatives& x = of_side_[i];
    const mjtNum sign = i == 0 ? -1 : 1;
    mju_addToScl3(rate, x.velocity, sign);
    mju_addToScl3(rate, x.acceleration, sign * tau);
    mju_addToScl3(rate, x.jerk, sign * tau * tau / 2);
  }
}

mjtNum ContactPath::GapRate(mjtNum tau) const {
  mjtNum n[3], rate[3];
  Normal(tau, n);
  DistanceRate(tau, rate);
  return mju_dot3(n, rate);
}

mjtNum ContactPath::NearestTime(mjtNum time) const {
  if (!anchor_.spheres()) return time;
  // d/dt ½ |D|² = D·D', and its derivative without the slow change of D'
  mjtNum t = 0;
  for (int i = 0; i < 2; ++i) {
    mjtNum distance[3], rate[3];
    Distance(t, distance);
    DistanceRate(t, rate);
    const mjtNum speed2 = mju_dot3(rate, rate);
    if (speed2 < mjMINVAL) return time;
    t = std::clamp<mjtNum>(t - mju_dot3(distance, rate) / speed2, 0, time);
  }
  return t;
}

bool ContactPath::ClosingTime(mjtNum time, mjtNum late, mjtNum touch, mjtNum* tau) const {
  constexpr int kNewtonSteps = 30;
  if (GapRate(0) >= 0) return false;
  // two balls that are apart at the end may have flown through each other
  if (Gap(time) >= -touch && Gap(NearestTime(time)) >= -touch) return false;
  mjtNum t = 0;
  for (int i = 0; i < kNewtonSteps; ++i) {
    const mjtNum rate = GapRate(t);
    if (rate >= 0) break;
    const mjtNum step = -Gap(t) / rate;
    t += step;
    if (std::abs(step) < 1e-12 * time || t < -late || t > 2 * time) break;
  }
  // an overlap that this closing speed cannot have made was there before: it closes now
  *tau = t < -late ? 0 : std::min(t, time);
  return true;
}

}  // namespace mujoco_impact::engine
