// SPDX-License-Identifier: Apache-2.0
// How an impact in the middle of a step changes the gyroscopic forces of the rest of it.
//
// The bias c(v) of MuJoCo's equations, M v' = forces − c(v), is a quadratic form of the velocities
// that turns a spinning body and does no work. An impulse that changes v by ΔV at the time s of a
// step of length h leaves c(v + ΔV) behind it, but the integrator takes for the whole step
//
//   Euler                    c(v)
//   implicit                 c(v) + c'(v) ΔV     all degrees of freedom
//   implicitfast, discrete   c(v) + c'(v) ΔV     trees of one free joint; of others c(v)
//   RK4                      c of a velocity that changes evenly through the step
//
// and the difference does work. The v of the semi-implicit integrators lags half a step behind that
// of the path (motion.h), as if it were that of the middle between two positions. So the impulse of
// the step is corrected by
//
//   −(h/2 − s)(c(v + ΔV) − c(v)) = −c'(v + ΔV/2) D     D = (h/2 − s) ΔV
//   + h c'(v) ΔV                                       what an implicit integrator takes off
//
// with c'(w) e = (c(w + e) − c(w − e)) / 2, which is exact for a quadratic form. For balls, slides
// and single hinges c' is zero, and nothing is done.

#ifndef MUJOCO_IMPACT_ENGINE_GYROSCOPIC_H_
#define MUJOCO_IMPACT_ENGINE_GYROSCOPIC_H_

#include <mujoco/mujoco.h>

#include "engine/scratch.h"

namespace mujoco_impact::engine {

// Adds the correction to the force of the step [N, N m], shape (nv).
//
//   change   ΔV [m/s, rad/s], shape (nv)
//   detour   D [m, rad], shape (nv)
//
// mjData is left as it was.
void AddGyroscopicChange(const mjModel* m, mjData* d, const mjtNum* change, const mjtNum* detour,
                         mjtNum* force, Scratch& scratch);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_GYROSCOPIC_H_
