// SPDX-License-Identifier: Apache-2.0

#include "engine/path/contact_path.h"

#include <algorithm>
#include <cmath>

namespace mujoco_impact::engine {

namespace {

// Distance of the two points, along the normal unless both are centres of spheres.
mjtNum Separation(const ContactAnchor& anchor, const Vector3& first, const Vector3& second) {
  const Vector3 between = second - first;
  return anchor.spheres() ? Norm(between) : Dot(anchor.normal, between);
}

}  // namespace

ContactAnchor AnchorContact(const mjModel* m, const mjData* d, const mjContact& contact) {
  ContactAnchor anchor;
  Vector3 position[2];
  anchor.normal = Load(contact.frame);
  for (int i = 0; i < 2; ++i) {
    const int geom = contact.geom[i];
    const int body = anchor.body[i] = m->geom_bodyid[geom];
    anchor.sphere[i] = IsSphere(m, geom);
    position[i] = anchor.sphere[i] ? Load(d->geom_xpos + 3 * geom)
                                   : PointWithNormal(m, d, geom, Load(contact.pos),
                                                     (i == 0 ? 1 : -1) * anchor.normal);
    anchor.local[i] = RotateBack(d->xmat + 9 * body, position[i] - Load(d->xpos + 3 * body));
  }
  anchor.carried = IsCarried(contact);
  anchor.rest = Separation(anchor, position[0], position[1]) - contact.dist;
  return anchor;
}

ContactPath::ContactPath(const mjModel* m, const mjData* d, const ContactAnchor& anchor,
                         const Motion& motion)
    : anchor_(anchor) {
  for (int i = 0; i < 2; ++i) {
    const int body = side_[i].body = anchor.body[i];
    side_[i].position = Load(d->xpos + 3 * body) + Rotate(d->xmat + 9 * body, anchor.local[i]);
    // a contact point slides over any other shape, so the turning of the body does not move it
    of_side_[i] = PointMotion(m, d, side_[i], motion, anchor.sphere[i]);
  }
  gap_ = Separation(anchor, side_[0].position, side_[1].position) - anchor.rest;
}

mjtNum ContactPath::Gap(mjtNum tau) const {
  const Vector3 change = Displacement(of_side_[1], tau) - Displacement(of_side_[0], tau);
  if (!anchor_.spheres()) return gap_ + Dot(anchor_.normal, change);
  // |D(τ)| − |D(0)| without cancellation: (D(τ) − D(0))·(D(τ) + D(0)) / (|D(τ)| + |D(0)|)
  const Vector3 before = side_[1].position - side_[0].position, after = before + change;
  return gap_ + Dot(change, before + after) / (Norm(before) + Norm(after));
}

Vector3 ContactPath::Normal(mjtNum tau) const {
  if (!anchor_.spheres()) return anchor_.normal;
  // concentric spheres have no line of centres
  return UnitOr(Distance(tau), anchor_.normal);
}

mjtNum ContactPath::TurnRate(mjtNum tau) const {
  if (!anchor_.spheres()) return 0;
  // |n × D'| / |D|
  return Norm(Cross(Normal(tau), DistanceRate(tau))) / std::max(Norm(Distance(tau)), mjMINVAL);
}

Vector3 ContactPath::Distance(mjtNum tau) const { return SideAt(1, tau) - SideAt(0, tau); }

Vector3 ContactPath::DistanceRate(mjtNum tau) const {
  const auto velocity = [tau](const PointDerivatives& x) {
    return x.velocity + tau * (x.acceleration + tau / 2 * x.jerk);
  };
  return velocity(of_side_[1]) - velocity(of_side_[0]);
}

mjtNum ContactPath::GapRate(mjtNum tau) const { return Dot(Normal(tau), DistanceRate(tau)); }

mjtNum ContactPath::RestSpeed(const mjModel* m, const mjData* d, mjtNum tau) const {
  const Vector3 normal = Normal(tau);
  const mjtNum first = Dot(normal, of_side_[0].acceleration);
  const mjtNum second = Dot(normal, of_side_[1].acceleration);
  if (!anchor_.carried) return engine::RestSpeed(m, d, first - second);
  const mjtNum pressing = std::max({first - second, std::abs(first), std::abs(second)});
  return CarriedRestSpeed(m, d, pressing, -gap_);
}

mjtNum ContactPath::NearestTime(mjtNum from, mjtNum end) const {
  if (!anchor_.spheres()) return end;
  // d/dt ½ |D|² = D·D', and its derivative without the slow change of D'
  mjtNum t = from;
  for (int i = 0; i < 2; ++i) {
    const Vector3 rate = DistanceRate(t);
    const mjtNum speed2 = Dot(rate, rate);
    if (speed2 < mjMINVAL) return end;
    t = std::clamp<mjtNum>(t - Dot(Distance(t), rate) / speed2, from, end);
  }
  return t;
}

bool ContactPath::Closes(mjtNum tau, mjtNum time, mjtNum touch) const {
  constexpr mjtNum kNoDeeper = 1e-6;
  const mjtNum rate = GapRate(tau);
  return rate < 0 && (Gap(tau) >= -touch || -rate * time > kNoDeeper * touch);
}

bool ContactPath::ClosingTime(mjtNum from, mjtNum end, mjtNum late, mjtNum touch,
                              mjtNum* tau) const {
  constexpr int kNewtonSteps = 30;
  const mjtNum time = end - from;
  mjtNum t = from;
  if (!Closes(from, time, touch)) {
    // pulses may bend a path on which bodies part into one that closes
    if (GapRate(from) < 0 || GapRate(end) >= 0 || Gap(from) < -touch) return false;
    t = end;
  }
  // two balls that are apart at the end may have flown through each other
  if (Gap(end) >= -touch && (t == end || Gap(NearestTime(from, end)) >= -touch)) return false;
  for (int i = 0; i < kNewtonSteps; ++i) {
    const mjtNum rate = GapRate(t);
    if (rate >= 0) break;
    const mjtNum step = -Gap(t) / rate;
    t += step;
    if (std::abs(step) < 1e-12 * time || t < from - late || t > from + 2 * time) break;
  }
  // an overlap that this closing speed cannot have made was there before: it closes now
  *tau = t < from - late ? from : std::min(t, end);
  return true;
}

}  // namespace mujoco_impact::engine
