// SPDX-License-Identifier: Apache-2.0
// Trees of several joints that fly (flights.h), struck and unstruck.
//
// From the first impact on in which one of them takes part they are followed from the start of the
// step: V and a of a path (motion.h) are not enough for what turns by a tenth of a radian. Both
// twins follow the equations of motion by MuJoCo's own functions,
//
//   q' = v    M(q) v' + c(q, v) = τ,    τ = M(q₀) a₀ + c(q₀, v₀)
//
// with the acceleration a₀ that the step has without impacts at its start. c holds gravity and all
// forces that are quadratic in the velocities; actuators, springs, dampers and applied forces stay
// in τ what they were. Springs and dampers of the joints answer the difference of the twins
// besides.

#ifndef MUJOCO_IMPACT_ENGINE_DELIVER_ARM_FLIGHTS_H_
#define MUJOCO_IMPACT_ENGINE_DELIVER_ARM_FLIGHTS_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/handover/hold.h"
#include "engine/path/motion.h"
#include "engine/state/state.h"

namespace mujoco_impact::engine {

class ArmFlights {
 public:
  // None.
  ArmFlights() = default;

  // Of the trees that are not tied (ntree), by the motion of the bodies where they are in `d`.
  ArmFlights(const mjModel* m, mjData* d, const Motion& motion, const Hold* held, Scratch& scratch);

  bool Has(int tree) const { return flies_ && flies_[tree]; }

  // As in Flights; t is the time at which the bodies are in `d`.
  void Follow() { followed_ = flies_ != nullptr; }
  void Add(mjData* d, int tree, mjtNum t, const mjtNum* velocity, const mjtNum* kick,
           const mjtNum* moment);
  void Place(mjData* d, mjtNum t, Motion& path);
  bool FlyToEnd(mjData* d);
  void Finish(State& state) const;

  // What it has taken since the last call, in the units of budget.h.
  double TakeWork();

 private:
  // Of all trees: position (nq) and velocity (nv), zero for those that do not fly.
  struct Twin {
    mjtNum *qpos, *qvel;
  };

  void Begin(mjtNum t, const mjtNum* qpos, const mjtNum* qvel);
  void FlyTo(mjData* d, mjtNum t);
  void Advance(mjData* d, mjtNum time, bool moves, bool second, const Twin& twin);
  void FindRate(mjData* d, const Twin& twin, mjtNum* qpos_rate, mjtNum* acceleration);
  void FindPositionRate(int tree, const Twin& twin, mjtNum* qpos_rate) const;
  void Resist(mjData* d, mjtNum time);
  template <typename Visit>
  void ForEach(const bool* which, Visit visit) const;

  const mjModel* m_ = nullptr;
  bool *flies_ = nullptr, *struck_ = nullptr;  // (ntree)
  bool followed_ = false;
  bool resists_ = false;     // one has springs or dampers
  bool any_ = false;         // was struck
  mjtNum time_ = 0;          // up to which the twins have flown [s]
  mjtNum* force_ = nullptr;  // τ (nv)
  Twin now_{}, unstruck_{};
  mjtNum *moved_ = nullptr, *faster_ = nullptr;  // by the end of the step (nv)
  double evaluations_ = 0;
};

// Adds what is pending for an arm to the velocity that MuJoCo's integrator gave it.
void CommitArm(const mjModel* m, mjData* d, int tree, State& state);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_DELIVER_ARM_FLIGHTS_H_
