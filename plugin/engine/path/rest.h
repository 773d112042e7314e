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
// already, a is at least that, for what presses them may come through others, and as much as
// presses either body. Nor is a contact an impact that overlaps by more than it closes in two
// steps: it has been pressed for longer, by what no impulse on its bodies turns back, such as a
// trunk on a leg at the stop of its joint. Nothing presses the balls of a cradle: there every
// closing is an impact. g is the gravity of the scene or, without it, that of the earth if anything
// else may press: actuators, springs, applied forces.

#ifndef MUJOCO_IMPACT_ENGINE_PATH_REST_H_
#define MUJOCO_IMPACT_ENGINE_PATH_REST_H_

#include <mujoco/mujoco.h>

#include <algorithm>

namespace mujoco_impact::engine {

// The largest u_rest of a contact that MuJoCo does not carry, and the smallest of one that it does
// [m/s].
mjtNum LargestRestSpeed(const mjModel* m, const mjData* d);

// u_rest of a contact whose gap closes with the acceleration `pressing` [m/s].
inline mjtNum RestSpeed(const mjModel* m, const mjData* d, mjtNum pressing) {
  if (pressing <= 0) return 0;
  return std::min(2 * m->opt.timestep * pressing, LargestRestSpeed(m, d));
}

// u_rest of a contact that MuJoCo carries, each of its bodies pressed by up to `pressing`, with an
// overlap y: max(2 h a, y / 2h) [m/s].
inline mjtNum CarriedRestSpeed(const mjModel* m, const mjData* d, mjtNum pressing, mjtNum overlap) {
  const mjtNum h = m->opt.timestep;
  return std::max({2 * h * pressing, LargestRestSpeed(m, d), overlap / (2 * h)});
}

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_PATH_REST_H_
