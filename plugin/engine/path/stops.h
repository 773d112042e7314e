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
// impact is solved again until both agree. To the law a joint at such a stop stands still, and what
// speed it had it keeps: that with which it comes to its stop by itself is left to MuJoCo's limit,
// which goes on to brake it. By M the impulses of an impact that is held are orthogonal to that
// speed, so energy does not grow.

#ifndef MUJOCO_IMPACT_ENGINE_PATH_STOPS_H_
#define MUJOCO_IMPACT_ENGINE_PATH_STOPS_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/common/tree_sets.h"
#include "engine/path/motion.h"

namespace mujoco_impact::engine {

class Stops {
 public:
  // Of the limits near which `motion` brings the bodies in this step, from where they are in `d`;
  // none where MuJoCo's limits are off.
  Stops(const mjModel* m, mjData* d, const Motion& motion, Scratch& scratch);

  // Looks how far they are at τ on a path from where the bodies are now; none holds.
  void Look(const Motion& path, mjtNum tau);

  // Finds those that hold against contacts that last for `time` and change the velocity, with the
  // ties alone, by `change` M̃⁻¹ Jᵀ P (nv each); whether they are others than before. A joint is at
  // a stop that it would reach in the first tenth of the way that it is pushed, unless it leaves it
  // faster than with a tenth of the push. If the impulses do not come `at_once`, it must be there
  // already. `work` is what it took, in multiplications; none holds if it takes too long.
  bool FindHeld(const Mobility& ties, const mjtNum* velocity, const mjtNum* change, mjtNum time,
                bool at_once, double* work = nullptr);

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

  // None holds.
  void Release();

  // Notes those that joints are leaving, so that they do not hold, but are pushed back into.
  void NoteStruck(const mjtNum* velocity, const mjtNum* change);

  // Calls visit(whether of a tendon, which joint or tendon) for those.
  template <typename Visit>
  void ForStruck(Visit visit) const {
    for (int i = 0; i < number_; ++i) {
      if (stop_[i].struck) visit(stop_[i].tendon, stop_[i].id);
    }
  }

  // Joins the trees that tendons would tie together.
  void Join(TreeSets& sets) const;

 private:
  struct Stop {
    mjtNum start;  // gap at the start of the step, negative where MuJoCo's limit gives way
    mjtNum gap;    // at the last look [m or rad]
    mjtNum* row;   // J_s at the start of the step (nv)
    bool holds, struck;
    bool tendon;
    int id;
  };

  const mjModel* m_;
  mjData* d_;
  int number_ = 0, held_ = 0;
  Stop* stop_ = nullptr;
  mjtNum* start_ = nullptr;  // qpos at the start of the step (nq)
};

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_PATH_STOPS_H_
