// SPDX-License-Identifier: Apache-2.0
// Free rigid bodies after an impact in the middle of a step.
//
// The integrators of MuJoCo take a force as one of the whole step, and its gyroscopic terms from
// the spin at the start (Euler), or as derivatives about it (implicit). A ball does not notice. For
// any other free body an impulse at time t changes what −J⁻¹(ω × J ω) is for the rest of the step,
// by as much as a tenth of the impulse. And where contacts of MuJoCo carry a body, the solver would
// answer the force of an impact with friction of its own. So such bodies get no force: MuJoCo
// integrates the step as if nothing had struck it, and what the impacts change is added when the
// step is committed. Two twins fly from the first impact to the end of the step, one struck and one
// not,
//
//   ẋ = v    v̇ = a    R' = R [ω]×    J ω̇ = −ω × J ω + J α         (centre of mass; ω, J in the
//   body)
//
// with the accelerations a and α that the other forces give at its start, and the differences
//
//   Δx = x − x°    Δv = v − v°    R = R° exp([ρ]×)    Δω = ω − ω°
//
// are what the impacts did: momentum is exact however the body turns, and the energy of rotation is
// set to that of MuJoCo's step plus the work of the impulses.

#ifndef MUJOCO_IMPACT_ENGINE_RIGID_FLIGHT_H_
#define MUJOCO_IMPACT_ENGINE_RIGID_FLIGHT_H_

#include <mujoco/mujoco.h>

#include "engine/motion.h"
#include "engine/scratch.h"
#include "engine/state.h"
#include "engine/vector3.h"

namespace mujoco_impact::engine {

// Where a rigid body is and how it moves: its centre of mass in the world, its spin in the body.
struct RigidState {
  Vector3 position, velocity;  // [m], [m/s]
  mjtNum rotation[4];          // quaternion
  Vector3 spin;                // ω [rad/s]
};

// The inertia of a kinematic tree that is one free rigid body.
struct RigidInertia {
  mjtNum mass;
  Vector3 offset;     // of the centre of mass from the joint, in the body [m]
  mjtNum matrix[9];   // J about the centre of mass, in the body [kg m²]
  mjtNum inverse[9];  // J⁻¹

  RigidInertia(const mjModel* m, const mjData* d, int tree);
};

// Whether the tree hangs on one free joint and nothing in it moves against the rest.
bool IsFreeBody(const mjModel* m, int tree);

// Whether the inertia of the tree stays as it is while its bodies move: one degree of freedom,
// slides alone, or a ball whose centre is its joint.
bool KeepsInertia(const mjModel* m, int tree);

// The free bodies of a step that tumble or rest on something, and that no constraint of MuJoCo but
// contacts holds and no pulse that lasts.
class RigidFlights {
 public:
  // None.
  RigidFlights() = default;

  // `motion` is that of the bodies from the start of the step.
  RigidFlights(const mjModel* m, const mjData* d, const Motion& motion, bool pulses,
               Scratch& scratch);

  // Whether the tree flies here: its impulses are no forces.
  bool Has(int tree) const { return index_ && index_[tree] >= 0; }

  // The acceleration of `motion` without the gyroscopic part of the bodies that fly (nv).
  const mjtNum* SteadyAcceleration(const Motion& motion, Scratch& scratch) const;

  // Adds an impulse of an impact at time t [s]: ΔV = M⁻¹Jᵀ P at the pose of the bodies in `d` and
  // its moment M⁻¹Jᵀ ∫ s F ds, s from the start of the step (dofs of the tree).
  void Add(const mjData* d, int tree, mjtNum t, const mjtNum* velocity, const mjtNum* kick,
           const mjtNum* moment);

  // Puts the bodies that were struck where they are at time t: position and velocity in `qpos` and
  // `qvel`, and the same velocity and its rate in `velocity` and `acceleration` (nv).
  void Place(mjtNum t, mjtNum* qpos, mjtNum* qvel, mjtNum* velocity, mjtNum* acceleration);

  // Leaves what the impacts did to each body until the end of the step pending in the state.
  void Finish(const mjModel* m, State& state);

 private:
  struct Flight;

  Flight& Of(int tree) const;

  const mjModel* m_ = nullptr;
  int* index_ = nullptr;  // of the flight of each tree, −1: none (ntree)
  int number_ = 0;
  Flight* flights_ = nullptr;
};

// Adds what is pending to the position and velocity that MuJoCo's integrator gave the bodies.
void CommitFlights(const mjModel* m, mjData* d, State& state);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_RIGID_FLIGHT_H_
