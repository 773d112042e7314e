// SPDX-License-Identifier: Apache-2.0
// One free rigid body between two times, whatever the integrator of MuJoCo does meanwhile:
//
//   ẋ = v    v̇ = a    R' = R [ω]×    J ω̇ = −ω × J ω + J α         (centre of mass; ω, J in the
//   body)

#ifndef MUJOCO_IMPACT_ENGINE_DELIVER_RIGID_BODY_H_
#define MUJOCO_IMPACT_ENGINE_DELIVER_RIGID_BODY_H_

#include <mujoco/mujoco.h>

#include "engine/common/vector3.h"

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

// What the other forces of the step do to a body: a [m/s²] and α [rad/s²].
struct RigidAcceleration {
  Vector3 linear, angular;
};

// a and α from the accelerations of the joint at the spin for which MuJoCo found them.
RigidAcceleration OtherForces(const RigidInertia& inertia, const mjtNum* rotation,
                              const mjtNum* acceleration, const Vector3& spin);

// The body after `time` [s], which may be negative.
void Fly(const RigidInertia& inertia, const RigidAcceleration& acceleration, mjtNum time,
         RigidState& state);

// −J⁻¹(ω × J ω)
Vector3 GyroscopicRate(const RigidInertia& inertia, const Vector3& spin);

// ½ ω·J ω
mjtNum SpinEnergy(const RigidInertia& inertia, const Vector3& spin);

// The spin that an impact leaves, whose energy is by `work` larger: ω° + κ Δω, κ the root next to 1
// of
//
//   ½ Δω·J Δω κ² + Δω·J ω° κ = work
//
// which leaves alone what the impact does, such as the spin about an axis of symmetry. Where Δω
// hardly changes the energy, all of the spin is scaled.
Vector3 SpinAfter(const RigidInertia& inertia, const Vector3& unstruck, const Vector3& change,
                  mjtNum work);

// Position and velocity of the joint from those of the centre of mass, and back. The velocity of
// the joint lags behind the pose by the time `lag` [s].
void ToJoint(const RigidInertia& inertia, const RigidState& state, mjtNum lag, mjtNum* qpos,
             mjtNum* qvel);
RigidState FromJoint(const RigidInertia& inertia, mjtNum lag, const mjtNum* qpos,
                     const mjtNum* qvel);

// A vector of the body in the world.
Vector3 ToWorld(const mjtNum* rotation, const Vector3& v);

// rotation ← rotation ⊗ exp([angle]×)
void Turn(const Vector3& angle, mjtNum* rotation);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_DELIVER_RIGID_BODY_H_
