// SPDX-License-Identifier: Apache-2.0

#include "engine/narrow_phase.h"

#include <algorithm>

#include "engine/point.h"

namespace mujoco_impact::engine {

namespace {

mjfCollision FunctionOf(const mjModel* m, const mjContact& contact) {
  return mjCOLLISIONFUNC[m->geom_type[contact.geom[0]]][m->geom_type[contact.geom[1]]];
}

bool IsCentred(const mjModel* m, int geom) {
  return IsSphere(m, geom) || m->geom_type[geom] == mjGEOM_PLANE;
}

}  // namespace

bool FollowsFromCentres(const mjModel* m, const mjContact& contact) {
  return IsCentred(m, contact.geom[0]) && IsCentred(m, contact.geom[1]);
}

bool CanBeAsked(const mjModel* m, const mjContact& contact) {
  for (const int geom : contact.geom) {
    const int type = m->geom_type[geom];
    if (type == mjGEOM_HFIELD || type == mjGEOM_SDF) return false;
  }
  return FunctionOf(m, contact) != nullptr;
}

int FindPoints(const mjModel* m, mjData* d, const mjContact& like, mjtNum margin,
               mjContact points[kMostPoints]) {
  mjPreContact found[kMostPoints];
  const int count =
      std::min(kMostPoints, FunctionOf(m, like)(m, d, found, like.geom[0], like.geom[1], margin));
  for (int i = 0; i < count; ++i) {
    points[i] = like;
    points[i].dist = found[i].dist;
    mju_copy3(points[i].pos, found[i].pos);
    mju_copy3(points[i].frame, found[i].normal);
  }
  return count;
}

}  // namespace mujoco_impact::engine
