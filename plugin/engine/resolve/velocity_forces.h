// SPDX-License-Identifier: Apache-2.0
// How gyroscopic, centrifugal and Coriolis forces change when an impact changes velocities.
//
// Such forces are quadratic in the velocities: for a change Δv they change by C = L + Q with
//
//   L = ½ (c(v + Δv) − c(v − Δv)),   Q = ½ (c(v + Δv) + c(v − Δv)) − c(v)
//
// After an impact at time t the velocities go on changing by −M⁻¹C (h − t) until the end of the
// step. Those of a semi-implicit integrator are behind their path by half a step (motion.h): a = ½;
// those of Runge-Kutta are not: a = 0. And the integrators take the impulse for one of the whole
// step, and count a part of C on their own:
//
//   0                Euler; implicitfast and discrete, but for single free bodies
//   h (½ L + ⅓ Q)    RK4, whose velocities grow through the step
//   h L              implicit; implicitfast and discrete for single free bodies
//
// so that part − C (h − t − a h) goes into the impulse of the step. Correct to first order in the
// angle turned. Bodies that nothing holds are followed exactly instead (flights.h).

#ifndef MUJOCO_IMPACT_ENGINE_RESOLVE_VELOCITY_FORCES_H_
#define MUJOCO_IMPACT_ENGINE_RESOLVE_VELOCITY_FORCES_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/deliver/deliver.h"
#include "engine/deliver/flights.h"

namespace mujoco_impact::engine {

// Adds that to the kicks of the trees that do not fly, for an impact at time t [s] where the bodies
// are in `d`, with their inertia there; velocities before and after it (nv).
void AddVelocityForces(const mjModel* m, mjData* d, const Flights& flights, mjtNum t,
                       const mjtNum* before, const mjtNum* after, Kicks& kicks, Scratch& scratch);

// The acceleration of the step without what such forces give arms, a + M⁻¹(c(q, v) − c(q, 0)): what
// goes on while bodies touch (nv).
const mjtNum* WithoutVelocityForces(const mjModel* m, mjData* d, const Flights& flights,
                                    const mjtNum* acceleration, Scratch& scratch);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_RESOLVE_VELOCITY_FORCES_H_
