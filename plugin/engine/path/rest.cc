// SPDX-License-Identifier: Apache-2.0

#include "engine/path/rest.h"

namespace mujoco_impact::engine {

namespace {

// Whether bodies may be pressed together without gravity.
bool MayPress(const mjModel* m, const mjData* d) {
  const int nv = static_cast<int>(m->nv);
  return m->nu > 0 || m->ntendon > 0 || !mju_isZero(d->qfrc_applied, nv) ||
         !mju_isZero(m->jnt_stiffness, static_cast<int>(m->njnt)) ||
         !mju_isZero(d->xfrc_applied, 6 * static_cast<int>(m->nbody));
}

}  // namespace

mjtNum LargestRestSpeed(const mjModel* m, const mjData* d) {
  constexpr mjtNum kOfGravity = 1.5, kEarth = 9.81;
  const bool off = m->opt.disableflags & mjDSBL_GRAVITY;
  mjtNum gravity = off ? 0 : mju_norm3(m->opt.gravity);
  if (gravity == 0 && MayPress(m, d)) gravity = kEarth;
  return 2 * m->opt.timestep * kOfGravity * gravity;
}

}  // namespace mujoco_impact::engine
