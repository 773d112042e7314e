// SPDX-License-Identifier: Apache-2.0
// What the bodies are about to do, from a time within the step on.
//
// At the start of the step that is the free motion, bent by pulses under way. After impacts within
// the step it is the motion they leave: with impulses P at times s (sums P, P s, P s² in Delivery),
//
//   Δq(t) = V t + a t²/2 + b t³/6 + M⁻¹ Jᵀ P (t − s)
//   v(t) = V + a t + b t²/2 + (1 + G (t − s)²/2) M⁻¹ Jᵀ P
//   a(t) = a + b t + G M⁻¹ Jᵀ P (t − s),   b(t) = b + G M⁻¹ Jᵀ P,   G = M⁻¹ (∂Q/∂q)
//
// and the bodies are moved there, so that the next impact sees the geometry of its own time. Pulses
// that bend the free motion are part of it and not among P.

#ifndef MUJOCO_IMPACT_ENGINE_FORESEE_OUTLOOK_H_
#define MUJOCO_IMPACT_ENGINE_FORESEE_OUTLOOK_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/deliver/deliver.h"
#include "engine/deliver/flights.h"
#include "engine/path/motion.h"

namespace mujoco_impact::engine {

struct Outlook {
  mjtNum start;     // time it begins, from the start of the step [s]
  Motion motion;    // path from there on
  mjtNum* bend;     // acceleration by the pulses under way (nv), null if there is none
  mjtNum* arrears;  // M⁻¹ Jᵀ of what pulses have yet to deliver (nv), null if nothing
};

// From the start of the step; `pulses` says whether any is under way.
Outlook LookAhead(const mjModel* m, mjData* d, const Mobility& mobility, const Delivery& delivery,
                  const MocapRecord* mocap, bool pulses, Scratch& scratch);

// Velocity at τ, every pulse under way delivered: impacts are decided on the velocity the bodies
// will have, or a body struck in the middle of a long pulse would get too small a share (nv).
mjtNum* SettledVelocity(const mjModel* m, const Outlook& outlook, mjtNum tau, Scratch& scratch);

// The bodies at times within the step. They are put back where they were when it ends.
class BodiesInStep {
 public:
  // `start` is the outlook from the start of the step; struck bodies of `flights` follow those.
  BodiesInStep(const mjModel* m, mjData* d, const Mobility& mobility, const Outlook& start,
               Flights& flights, Scratch& scratch);
  ~BodiesInStep();
  BodiesInStep(const BodiesInStep&) = delete;
  BodiesInStep& operator=(const BodiesInStep&) = delete;

  // Moves the bodies to time t, after the impulses in `delivery` and the changes of velocity in
  // `kicks`, and looks ahead from there; `owed` is the velocity that their pulses will add after
  // this step (nv), null if none will.
  Outlook MoveTo(mjtNum t, const Delivery& delivery, const Kicks& kicks, mjtNum* owed);

  // What flies goes on to the end of the step.
  void FlyToEnd();

  // Puts the bodies back, if they are away.
  void PutBack();

 private:
  void Place(mjtNum t, const mjtNum* displacement, const mjtNum* velocity);
  void AddTied(const mjtNum* kick, mjtNum s, mjtNum* result);
  mjtNum* ArrearsAt(mjtNum t, mjtNum* owed);

  const mjModel* m_;
  mjData* d_;
  const Mobility& mobility_;
  const Outlook start_;
  Flights& flights_;
  mjtNum *qpos_, *qvel_;             // at the start of the step
  mjtNum *mocap_pos_, *mocap_quat_;  // then
  Motion moved_;
  mjtNum *kick_, *displacement_, *work_, *arrears_;
  bool away_ = false;
};

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_FORESEE_OUTLOOK_H_
