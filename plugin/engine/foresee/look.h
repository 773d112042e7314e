// SPDX-License-Identifier: Apache-2.0
// One look at the contacts: all that most steps ever ask.
//
// It takes velocities that MuJoCo has at hand, no Jacobian and no memory. A scene at rest, or one
// in which nothing is near, is left after it.

#ifndef MUJOCO_IMPACT_ENGINE_FORESEE_LOOK_H_
#define MUJOCO_IMPACT_ENGINE_FORESEE_LOOK_H_

#include <mujoco/mujoco.h>

#include <algorithm>

#include "engine/common/scratch.h"
#include "engine/foresee/narrow_phase.h"
#include "engine/state/mocap.h"

namespace mujoco_impact::engine {

// Of the contacts that are offered to us.
struct Look {
  bool closes;  // one may be deeper than `touch` at the end of the step and is not at rest
  bool moves;   // one that MuJoCo carries closes or parts faster than at rest, or may (rest.h)
};

Look LookAtContacts(const mjModel* m, mjData* d, const MocapRecord* mocap, mjtNum touch);

// Whether `holds` for any point of the pair of contact i, which is in doubt, as it is found again.
template <typename Predicate>
bool AnyFoundAgain(const mjModel* m, mjData* d, int i, Predicate holds) {
  Scratch scratch(d);
  // the step asks for more, and says so
  if (!scratch.Fits(NarrowPhaseBytes(m))) return true;
  mjContact* points = scratch.Take<mjContact>(kMostPoints);
  const int number = FindPoints(m, d, d->contact[i], d->contact[i].dist, points);
  return std::any_of(points, points + number, holds);
}

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_FORESEE_LOOK_H_
