// SPDX-License-Identifier: Apache-2.0
// Finds the contacts that close within the step.
//
// In order, each a reason to stop: no contact that was released to us; none that may close by the
// velocities MuJoCo has at hand; only then the path of the bodies and the time of closing.

#ifndef MUJOCO_IMPACT_ENGINE_GATHER_H_
#define MUJOCO_IMPACT_ENGINE_GATHER_H_

#include <mujoco/mujoco.h>

#include "engine/deliver.h"
#include "engine/motion.h"
#include "engine/ownership.h"
#include "engine/scratch.h"

namespace mujoco_impact::engine {

// Whether any released contact may close within the step: all that most steps ever ask.
bool AnyMayClose(const mjModel* m, const mjData* d, mjtNum touch);

// The path of the bodies through the step and what comes after it.
struct Outlook {
  Motion motion;    // path, bent by the step average of the pulses under way
  mjtNum* bend;     // acceleration of those pulses (nv), null if there are none
  mjtNum* arrears;  // M⁻¹ Jᵀ of what they have yet to deliver (nv)
};

Outlook LookAhead(const mjModel* m, mjData* d, const Delivery& delivery, bool pulses,
                  Scratch& scratch);

// Velocity at τ, every pulse under way delivered: impacts are decided on the velocity the bodies
// will have, or a body struck in the middle of a long pulse would get too small a share (nv).
mjtNum* SettledVelocity(const mjModel* m, const Outlook& outlook, mjtNum tau, Scratch& scratch);

struct Gathered {
  int count;
  int* contact;  // indices into mjData.contact
  bool* due;     // whether it closes within the step
  mjtNum* tau;   // when, if due [s]
};

// All owned contacts between bodies of which at least one moves.
Gathered GatherContacts(const mjModel* m, const mjData* d, const Ownership& ownership, mjtNum touch,
                        const Outlook& outlook, Scratch& scratch);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_GATHER_H_
