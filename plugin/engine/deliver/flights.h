// SPDX-License-Identifier: Apache-2.0
// Kinematic trees that tumble, after an impact in the middle of a step.
//
// The integrators of MuJoCo take a force as one of the whole step, with the inertia and the
// gyroscopic terms of its start (Euler), or with derivatives about it (implicit). A ball and a
// pendulum of one hinge do not notice. For any other tree an impulse at time t changes what those
// terms are for the rest of the step, by as much as a tenth of the impulse. And where contacts of
// MuJoCo carry a body, the solver would answer the force of an impact with friction of its own. So
// such trees get no force: MuJoCo integrates the step as if nothing had struck them, and what the
// impacts change is added when the step is committed. Two twins fly from the first impact to the
// end of the step, one struck and one not, and their difference is what the impacts did. A free
// body flies by itself (rigid_flights.h), trees of several joints by MuJoCo's functions
// (arm_flights.h).

#ifndef MUJOCO_IMPACT_ENGINE_DELIVER_FLIGHTS_H_
#define MUJOCO_IMPACT_ENGINE_DELIVER_FLIGHTS_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/deliver/arm_flights.h"
#include "engine/deliver/rigid_flights.h"
#include "engine/path/motion.h"
#include "engine/state/state.h"

namespace mujoco_impact::engine {

// The trees of a step that tumble or rest on something, and that no constraint of MuJoCo but
// contacts holds and no pulse that lasts.
class Flights {
 public:
  // None.
  Flights() = default;

  // `motion` is that of the bodies from the start of the step, where they are in `d`; `friction`
  // says whether any contact has it.
  Flights(const mjModel* m, mjData* d, const Motion& motion, bool pulses, bool friction,
          Scratch& scratch);

  // Whether the tree flies here: its impulses are no forces.
  bool Has(int tree) const { return rigid_.Has(tree) || arms_.Has(tree); }

  // Whether it flies as a rigid body.
  bool IsRigid(int tree) const { return rigid_.Has(tree); }

  // The acceleration of `motion` without the gyroscopic part of the rigid bodies that fly (nv).
  const mjtNum* SteadyAcceleration(const Motion& motion, Scratch& scratch) const {
    return rigid_.SteadyAcceleration(motion, scratch);
  }

  // Adds an impulse of an impact: ΔV = M⁻¹Jᵀ P with the rows of the time t, and its moment
  // M⁻¹Jᵀ ∫ s F ds, s from the start of the step (dofs of the tree) [s]. The bodies in `d` are
  // where they are at the time `there`, with the velocity of their path (nv).
  void Add(mjData* d, int tree, mjtNum there, mjtNum t, const mjtNum* velocity, const mjtNum* kick,
           const mjtNum* moment);

  // Arms take part in the impact at hand.
  void FollowArms() { arms_.Follow(); }

  // Puts the bodies that were struck or are followed where they are at time t: position and
  // velocity in `d`, and the same velocity and its rate in `path`.
  void Place(mjData* d, mjtNum t, Motion& path);

  // Flies on to the end of the step; whether that has moved bodies in `d`.
  bool FlyToEnd(mjData* d);

  // What all that has taken since the last call, in the units of budget.h.
  double TakeWork() { return arms_.TakeWork(); }

  // Leaves what the impacts did to each tree until the end of the step pending in the state.
  void Finish(const mjModel* m, State& state);

 private:
  RigidFlights rigid_;
  ArmFlights arms_;
};

// Adds what is pending to the velocity that MuJoCo's integrator gave the trees, and to the position
// of free bodies; that of arms is left in the correction.
void CommitFlights(const mjModel* m, mjData* d, State& state);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_DELIVER_FLIGHTS_H_
