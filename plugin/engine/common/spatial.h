// SPDX-License-Identifier: Apache-2.0
// Spatial vectors as MuJoCo keeps them: (rotation, translation) about the tree's centre of mass.

#ifndef MUJOCO_IMPACT_ENGINE_COMMON_SPATIAL_H_
#define MUJOCO_IMPACT_ENGINE_COMMON_SPATIAL_H_

#include <mujoco/mujoco.h>

#include "engine/common/vector3.h"

namespace mujoco_impact::engine {

// Rate of a motion axis that moves with velocity v: v × axis.
inline void SpatialCross(const mjtNum v[6], const mjtNum axis[6], mjtNum result[6]) {
  const Vector3 turning = Load(v), rotation = Load(axis);
  Store(Cross(turning, rotation), result);
  Store(Cross(turning, Load(axis + 3)) + Cross(Load(v + 3), rotation), result + 3);
}

inline bool IsFreeRotation(const mjModel* m, int dof) {
  const int joint = m->dof_jntid[dof];
  return m->jnt_type[joint] == mjJNT_FREE && dof >= m->jnt_dofadr[joint] + 3;
}

// A rotation of a ball or free joint, whose axis turns with the body that it moves.
inline bool TurnsWithBody(const mjModel* m, int dof) {
  return m->jnt_type[m->dof_jntid[dof]] == mjJNT_BALL || IsFreeRotation(m, dof);
}

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_COMMON_SPATIAL_H_
