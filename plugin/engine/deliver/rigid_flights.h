// SPDX-License-Identifier: Apache-2.0
// Free rigid bodies that fly (flights.h), struck and unstruck (rigid_body.h), with the
// accelerations a and α that the other forces give at the start of the step. The differences
//
//   Δx = x − x°    Δv = v − v°    R = R° exp([ρ]×)    Δω = ω − ω°
//
// are what the impacts did: momentum is exact however the body turns, and the energy of rotation is
// set to that of MuJoCo's step plus the work of the impulses.

#ifndef MUJOCO_IMPACT_ENGINE_DELIVER_RIGID_FLIGHTS_H_
#define MUJOCO_IMPACT_ENGINE_DELIVER_RIGID_FLIGHTS_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/handover/hold.h"
#include "engine/path/motion.h"
#include "engine/state/state.h"

namespace mujoco_impact::engine {

class RigidFlights {
 public:
  // None.
  RigidFlights() = default;

  // Of the trees that are not tied (ntree); of balls as well if friction turns them.
  RigidFlights(const mjModel* m, const mjData* d, const Motion& motion, const Hold* held,
               bool friction, Scratch& scratch);

  bool Has(int tree) const { return index_ && index_[tree] >= 0; }

  // As in Flights.
  const mjtNum* SteadyAcceleration(const Motion& motion, Scratch& scratch) const;

  void Add(const mjData* d, int tree, mjtNum there, mjtNum t, const mjtNum* velocity,
           const mjtNum* kick, const mjtNum* moment);

  void Place(mjtNum t, mjtNum* qpos, mjtNum* qvel, mjtNum* velocity, mjtNum* acceleration);
  void Finish(State& state);

 private:
  struct Flight;

  Flight& Of(int tree) const;

  const mjModel* m_ = nullptr;
  int* index_ = nullptr;  // of the flight of each tree, −1: none (ntree)
  int number_ = 0;
  Flight* flights_ = nullptr;
};

// Adds what is pending for a body to the position and velocity that MuJoCo's integrator gave it.
void CommitRigidFlight(const mjModel* m, mjData* d, int tree, State& state);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_DELIVER_RIGID_FLIGHTS_H_
