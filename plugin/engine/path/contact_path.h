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

// Closing speed of a contact at the start of the step [m/s], from mjData.cvel: what the scan of
// every step pays per contact; `mocap` is null if there is no such body.
mjtNum ClosingSpeed(const mjModel* m, const mjData* d, const mjContact& contact,
                    const MocapRecord* mocap);

// How far bodies that close with c at the start of the step may come in it, if that is an impact
// [m]. They are pressed by some a, reach c + 3/2 a h by its end, and must be faster than
// u_rest = 2 a h (rest.h) there: so a h ≤ 2 c, and c h + a h² ≤ 3 c h. Nor is u_rest more than its
// largest, where a h is 1.5 g h.
inline mjtNum FarthestImpact(const mjModel* m, const mjData* d, mjtNum c) {
  return std::min(3 * c, c + LargestRestSpeed(m, d) / 2) * m->opt.timestep;
}

// Whether the contact may close as an impact by the end of the step; one that MuJoCo carries, if it
// is faster than at rest.
inline bool MayClose(const mjModel* m, const mjData* d, const mjContact& contact,
                     const MocapRecord* mocap, mjtNum touch) {
  const mjtNum c = ClosingSpeed(m, d, contact, mocap);
  if (c <= 0 || contact.dist - FarthestImpact(m, d, c) >= -touch) return false;
  return !IsCarried(contact) || c > LargestRestSpeed(m, d);
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
