// SPDX-License-Identifier: Apache-2.0
// One contact along the path of the step: its gap, its normal, and when it closes.
//
// Each side is represented by a point of its body: the centre of a sphere, the contact point of any
// other shape. With D = x₂ − x₁ along the path,
//
//   two spheres:   gap(τ) = |D(τ)| − (r₁ + r₂),      n(τ) = D(τ) / |D(τ)|
//   otherwise:     gap(τ) = gap + n·(D(τ) − D(0)),   n constant
//
// Exact for spheres and planes up to the third derivative of the path; of first order for others.

#ifndef MUJOCO_IMPACT_ENGINE_PATH_CONTACT_PATH_H_
#define MUJOCO_IMPACT_ENGINE_PATH_CONTACT_PATH_H_

#include <mujoco/mujoco.h>

#include <algorithm>

#include "engine/path/motion.h"
#include "engine/path/point.h"
#include "engine/path/rest.h"
#include "engine/scene/ownership.h"

namespace mujoco_impact::engine {

// Closing speed of a contact at the start of the step [m/s], from mjData.cvel: what the look at
// every contact costs; `mocap` is null if there is no such body.
inline mjtNum ClosingSpeed(const mjModel* m, const mjData* d, const mjContact& contact,
                           const MocapRecord* mocap) {
  const Vector3 position = Load(contact.pos);
  const auto velocity = [&](int geom) {
    const int body = m->geom_bodyid[geom];
    Vector3 v{};
    // what no joint carries has none of MuJoCo's
    if (m->body_weldid[body] > 0) v = PointVelocity(m, d, {body, position});
    if (mocap) v += MocapVelocity(m, d, mocap, body, position);
    return v;
  };
  // c = −n·(v₂ − v₁)
  return Dot(Load(contact.frame), velocity(contact.geom[0]) - velocity(contact.geom[1]));
}

// Whether a contact that closes with c at the start of the step may close as an impact by its end;
// one that MuJoCo carries, if it is faster than `at_rest`, the largest u_rest, and than what has
// made its overlap (rest.h).
//
// The bodies are pressed by some a, reach c + 3/2 a h by the end, and must be faster than
// u_rest = 2 a h there: so a h ≤ 2 c, and they come c h + a h² ≤ 3 c h. Nor is u_rest more than
// its largest, where a h is half of it.
inline bool MayClose(const mjModel* m, const mjContact& contact, mjtNum c, mjtNum at_rest,
                     mjtNum touch) {
  const mjtNum h = m->opt.timestep;
  if (c <= (IsCarried(contact) ? std::max(at_rest, -contact.dist / (2 * h)) : 0)) return false;
  return contact.dist - std::min(3 * c, c + at_rest / 2) * h < -touch;
}

// A contact as two points of its bodies, so that its gap is known wherever the bodies are.
struct ContactAnchor {
  int body[2];
  Vector3 local[2];  // the points in the frames of the bodies
  bool sphere[2];    // the side is a sphere, its point the centre
  Vector3 normal;    // from geom[0] to geom[1], for other than two spheres
  mjtNum rest;       // distance of the points at which the gap is zero
  bool carried;      // MuJoCo's solver holds the contact

  bool spheres() const { return sphere[0] && sphere[1]; }
};

ContactAnchor AnchorContact(const mjModel* m, const mjData* d, const mjContact& contact);

// The path starts where the bodies are in `d`.
class ContactPath {
 public:
  ContactPath(const mjModel* m, const mjData* d, const ContactAnchor& anchor, const Motion& motion);

  const BodyPoint& side(int i) const { return side_[i]; }

  // Where the point of a side is at τ.
  Vector3 SideAt(int i, mjtNum tau) const {
    return side_[i].position + Displacement(of_side_[i], tau);
  }
  mjtNum Gap(mjtNum tau) const;
  mjtNum GapRate(mjtNum tau) const;
  // The speed up to which the contact is at rest [m/s].
  mjtNum RestSpeed(const mjModel* m, const mjData* d, mjtNum tau) const;
  Vector3 Normal(mjtNum tau) const;
  // How fast the normal turns [rad/s].
  mjtNum TurnRate(mjtNum tau) const;

  // Whether the contact closes at τ. One that overlaps must get deeper by a part of `touch` within
  // `time`: a plastic impact leaves the rounding of a common speed, and to call that an
  // impact would begin a pulse without an impulse, and one that lasts, for W ~ u^(-1/5).
  bool Closes(mjtNum tau, mjtNum time, mjtNum touch) const;

  // Time at which the contact closes between `from` and `end`; false if it does not get deeper than
  // `touch` meanwhile. May be earlier by up to `late`: it closed unnoticed at the end of the last
  // step, whose scan did not know the free acceleration.
  bool ClosingTime(mjtNum from, mjtNum end, mjtNum late, mjtNum touch, mjtNum* tau) const;

 private:
  Vector3 Distance(mjtNum tau) const;
  Vector3 DistanceRate(mjtNum tau) const;
  // When two spheres are closest between the two times, up to the curvature of their paths; for
  // other shapes the end.
  mjtNum NearestTime(mjtNum from, mjtNum end) const;

  const ContactAnchor& anchor_;
  BodyPoint side_[2];
  mjtNum gap_;
  PointDerivatives of_side_[2];
};

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_PATH_CONTACT_PATH_H_
