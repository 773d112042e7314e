// SPDX-License-Identifier: Apache-2.0

#include "engine/contact_stiffness.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "law/hertz_contact.h"

namespace mujoco_impact::engine {

namespace {

// Curvature of the geom at a contact [1/m]: exact for spheres and planes, of the order of the size
// for other shapes, where it only sets how long a contact lasts and how it shares an impulse.
mjtNum Curvature(const mjModel* m, int geom) {
  const mjtNum* size = m->geom_size + 3 * geom;
  switch (m->geom_type[geom]) {
    case mjGEOM_PLANE:
    case mjGEOM_HFIELD:
    case mjGEOM_BOX:
      return 0;
    case mjGEOM_SPHERE:
    case mjGEOM_CAPSULE:
    case mjGEOM_CYLINDER:
      return 1 / size[0];
    case mjGEOM_ELLIPSOID:
      return 1 / std::cbrt(size[0] * size[1] * size[2]);
    default:
      return 1 / m->geom_rbound[geom];
  }
}

}  // namespace

mjtNum ContactCurvature(const mjModel* m, const mjContact& contact) {
  const mjtNum curvature = Curvature(m, contact.geom[0]) + Curvature(m, contact.geom[1]);
  if (curvature > 0) return curvature;
  // flat on flat: as a sphere of the size of the smaller body
  return 1 / std::max(m->geom_rbound[contact.geom[0]], m->geom_rbound[contact.geom[1]]);
}

mjtNum ContactStiffness(const mjModel* m, const Config& config, const mjContact& contact) {
  return law::HertzStiffness(config.effective_modulus, ContactCurvature(m, contact));
}

mjtNum EstimateContactTime(const mjModel* m, const Config& config, const mjContact& contact,
                           mjtNum speed) {
  mjtNum mass = std::numeric_limits<mjtNum>::infinity();
  for (const int geom : contact.geom) {
    const int body = m->geom_bodyid[geom];
    if (m->body_treeid[body] >= 0) mass = std::min(mass, m->body_mass[body]);
  }
  return law::ContactTime(ContactStiffness(m, config, contact), mass, speed);
}

}  // namespace mujoco_impact::engine
