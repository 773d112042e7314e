// SPDX-License-Identifier: Apache-2.0

#include "engine/scene/contact_stiffness.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/common/vector3.h"
#include "law/hertz_contact.h"

namespace mujoco_impact::engine {

namespace {

// Cosine up to which a face counts as facing the normal: 2.6 degrees.
constexpr mjtNum kFacing = 0.999;

// Curvature of an edge or corner.
mjtNum EdgeCurvature(mjtNum smallest) {
  constexpr mjtNum kRounding = 0.05;
  return 1 / std::max(mjMINVAL, kRounding * smallest);
}

mjtNum CylinderCurvature(const mjtNum* size, const Vector3& normal) {
  if (std::abs(normal.z) > kFacing) return 0;
  if (std::hypot(normal.x, normal.y) > kFacing) return 1 / size[0];
  return EdgeCurvature(std::min(size[0], size[1]));
}

mjtNum EllipsoidCurvature(const mjtNum* size, const Vector3& normal) {
  const Vector3 scaled{size[0] * normal.x, size[1] * normal.y, size[2] * normal.z};
  return Dot(scaled, scaled) / (size[0] * size[1] * size[2]);
}

bool BoxFaces(const Vector3& normal) {
  return std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)}) > kFacing;
}

// By the faces of the convex hull.
bool MeshFaces(const mjModel* m, int mesh, const Vector3& normal) {
  const int begin = m->mesh_polyadr[mesh];
  for (int i = begin; i < begin + m->mesh_polynum[mesh]; ++i) {
    if (Dot(Load(m->mesh_polynormal + 3 * i), normal) > kFacing) return true;
  }
  return false;
}

// Of the geom where its outward normal is `outward`, world frame [1/m].
mjtNum Curvature(const mjModel* m, const mjData* d, int geom, const Vector3& outward) {
  const mjtNum* size = m->geom_size + 3 * geom;
  const mjtNum smallest = std::min({size[0], size[1], size[2]});
  const Vector3 normal = RotateBack(d->geom_xmat + 9 * geom, outward);
  switch (m->geom_type[geom]) {
    case mjGEOM_PLANE:
    case mjGEOM_HFIELD:
      return 0;
    case mjGEOM_SPHERE:
    case mjGEOM_CAPSULE:
      return 1 / size[0];
    case mjGEOM_CYLINDER:
      return CylinderCurvature(size, normal);
    case mjGEOM_ELLIPSOID:
      return EllipsoidCurvature(size, normal);
    case mjGEOM_BOX:
      return BoxFaces(normal) ? 0 : EdgeCurvature(smallest);
    case mjGEOM_MESH:
      return MeshFaces(m, m->geom_dataid[geom], normal) ? 0 : EdgeCurvature(smallest);
    default:
      return 1 / m->geom_rbound[geom];
  }
}

// Radius about the smaller body; a plane has none.
mjtNum SmallerRadius(const mjModel* m, const mjContact& contact) {
  const mjtNum first = m->geom_rbound[contact.geom[0]], second = m->geom_rbound[contact.geom[1]];
  return first > 0 && second > 0 ? std::min(first, second) : std::max(first, second);
}

}  // namespace

mjtNum ContactCurvature(const mjModel* m, const mjData* d, const mjContact& contact) {
  const Vector3 normal = Load(contact.frame);
  const mjtNum curvature =
      Curvature(m, d, contact.geom[0], normal) + Curvature(m, d, contact.geom[1], -1 * normal);
  return curvature > 0 ? curvature : 1 / SmallerRadius(m, contact);
}

mjtNum EstimateContactTime(const mjModel* m, const mjData* d, const Materials& materials,
                           const mjContact& contact, mjtNum speed) {
  mjtNum mass = std::numeric_limits<mjtNum>::infinity();
  for (const int geom : contact.geom) {
    const int body = m->geom_bodyid[geom];
    if (m->body_treeid[body] >= 0) mass = std::min(mass, m->body_mass[body]);
  }
  const mjtNum stiffness =
      law::HertzStiffness(materials.EffectiveModulus(contact), ContactCurvature(m, d, contact));
  return law::ContactTime(stiffness, mass, speed);
}

}  // namespace mujoco_impact::engine
