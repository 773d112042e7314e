// SPDX-License-Identifier: Apache-2.0
// Stops: the limits of joints and tendons, while an impact lasts.
//
// A joint that stands at its stop cannot give way there. MuJoCo's own limit is soft: it answers an
// impulse over some twenty milliseconds. In an impact a stop is rigid while it is pushed, and is
// not there otherwise:
//
//   J_s v⁺ ≥ min(0, J_s v)   ⊥   Λ ≥ 0        J_s v: rate of the gap, positive away from the stop
//
// A stop that holds is a tie of the bodies (mobility.h), and Λ comes with the impulses of the
// contacts. Which stops hold follows from those impulses, and they follow from which stops hold: an
// impact is solved again until both agree. The speed with which a joint comes to its stop by itself
// is left to MuJoCo's limit, which goes on to brake it.

#ifndef MUJOCO_IMPACT_ENGINE_PATH_STOPS_H_
#define MUJOCO_IMPACT_ENGINE_PATH_STOPS_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/common/tree_sets.h"
#include "engine/path/motion.h"

namespace mujoco_impact::engine {

class Stops {
 public:
  // Of the limits in whose reach `motion` brings the bodies in this step, from where they are in
  // `d`; none where MuJoCo's limits are off.
  Stops(const mjModel* m, mjData* d, const Motion& motion, Scratch& scratch);

  // Finds those at which joints stand at τ on a path from where the bodies are now; none holds.
  void Look(const Motion& path, mjtNum tau);

  // Finds those that hold against a `change` of the velocity, M̃⁻¹ Jᵀ P of the contacts with the
  // ties alone (nv each); whether they are others than before.
  bool FindHeld(const Mobility& ties, const mjtNum* velocity, const mjtNum* change);

  // Whether there are any, and how many hold.
  bool Any() const { return number_ > 0; }
  int held() const { return held_; }

  // Calls visit(J_s) for those that hold (nv).
  template <typename Visit>
  void ForHeld(Visit visit) const {
    for (int i = 0; i < number_; ++i) {
      if (stop_[i].holds) visit(stop_[i].row);
    }
  }

  // Joins the trees that tendons would tie together.
  void Join(TreeSets& sets) const;

 private:
  struct Stop {
    mjtNum gap;   // at the start of the step, negative where MuJoCo's limit gives way [m or rad]
    mjtNum* row;  // J_s then (nv)
    bool stands;  // a joint stands at it
    bool holds;
  };

  const mjModel* m_;
  mjData* d_;
  int number_ = 0, held_ = 0;
  Stop* stop_ = nullptr;
  mjtNum* start_ = nullptr;  // qpos at the start of the step (nq)
};

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_PATH_STOPS_H_
