// SPDX-License-Identifier: Apache-2.0
// How mocap bodies move: MuJoCo knows where they are, and takes them for still.
//
// A mocap body is put somewhere else before each step, and strikes what is in its way. Its velocity
// is taken from where it was in the step before,
//
//   v = (x − x') / h,    ω = 2 log(q q'⁻¹) / h
//
// and it goes on with that through the step. A body that goes farther than its size in one step, or
// turns by more than a radian, was put there and did not move: it strikes as one that is still, of
// which there is a warning. So does every mocap body in the first step.

#ifndef MUJOCO_IMPACT_ENGINE_STATE_MOCAP_H_
#define MUJOCO_IMPACT_ENGINE_STATE_MOCAP_H_

#include <mujoco/mujoco.h>

#include "engine/common/vector3.h"

namespace mujoco_impact::engine {

// One per mocap body.
struct MocapRecord {
  double position[3];    // in the step before [m]
  double quaternion[4];  // in the step before
  double known;          // 1: these are set
  double warned;         // 1: a jump was warned of
  // of this step, written by compute
  double linear[3];   // of the origin of the body, world frame [m/s]
  double angular[3];  // world frame [rad/s]
  double jumped;      // 1: it strikes as one that is still
};

class State;

// Finds the velocities of this step.
void FindMocapVelocities(const mjModel* m, const mjData* d, int instance, State& state);

// Remembers where the mocap bodies were in the step that ends.
void CommitMocap(const mjModel* m, const mjData* d, State& state);

// Id of the mocap body that carries the body, or is it; −1 if none.
inline int MocapOf(const mjModel* m, int body) { return m->body_mocapid[m->body_rootid[body]]; }

// Velocity that a mocap body gives to a point of the body; `records` is null if there is none.
inline Vector3 MocapVelocity(const mjModel* m, const mjData* d, const MocapRecord* records,
                             int body, const Vector3& position) {
  const int mocap = records ? MocapOf(m, body) : -1;
  if (mocap < 0) return {};
  const Vector3 arm = position - Load(d->xpos + 3 * m->body_rootid[body]);
  return Load(records[mocap].linear) + Cross(Load(records[mocap].angular), arm);
}

// Moves the mocap bodies on by the time t.
void MoveMocap(const mjModel* m, mjData* d, const MocapRecord* records, mjtNum t);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_STATE_MOCAP_H_
