// SPDX-License-Identifier: Apache-2.0
// What is an impact and what is rest.
//
// A contact that closes with less than
//
//   u_rest = 2 h a          a: the acceleration that presses the bodies together [m/s²]
//
// would fly for less than a step if it bounced: the step cannot resolve that, and the contact is
// left to MuJoCo's solver, which carries what rests. a is the acceleration with which the gap
// closes, and no more than 1.5 g: a light foot on a strong joint is pressed by hundreds of m/s²
// until it lands, and its landing is an impact. Where bodies overlap and the solver carries them
// already, a is that bound, for what presses them may come through others. Nothing presses the
// balls of a cradle: there every closing is an impact.

#ifndef MUJOCO_IMPACT_ENGINE_REST_H_
#define MUJOCO_IMPACT_ENGINE_REST_H_

#include <mujoco/mujoco.h>

#include <algorithm>

namespace mujoco_impact::engine {

// u_rest of a contact that MuJoCo carries, the largest of any [m/s].
inline mjtNum LargestRestSpeed(const mjModel* m) {
  if (m->opt.disableflags & mjDSBL_GRAVITY) return 0;
  return 2 * m->opt.timestep * 1.5 * mju_norm3(m->opt.gravity);
}

// u_rest of a contact whose gap closes with the acceleration `pressing` [m/s].
inline mjtNum RestSpeed(const mjModel* m, mjtNum pressing) {
  return std::clamp<mjtNum>(2 * m->opt.timestep * pressing, 0, LargestRestSpeed(m));
}

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_REST_H_
