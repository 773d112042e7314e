// SPDX-License-Identifier: Apache-2.0

#include "engine/step.h"

#include "engine/deliver.h"
#include "engine/gather.h"
#include "engine/impacts.h"
#include "engine/mobility.h"
#include "engine/runge_kutta.h"
#include "engine/scratch.h"
#include "engine/sensor.h"
#include "engine/settled_energy.h"
#include "engine/slots.h"
#include "engine/state.h"

namespace mujoco_impact::engine {

namespace {

// Bytes of mjData's stack that a step with impacts takes besides those of its islands: at most
// this many vectors of the length of each, MuJoCo's own in the functions we call included, and a
// factor of the inertia.
size_t StepBytes(const mjModel* m, const mjData* d) {
  constexpr size_t kVectors = 48;
  const size_t numbers = m->nq + m->nv + m->nbody + m->ntree + m->nu;
  return (kVectors * numbers + m->nC) * sizeof(mjtNum) +
         d->ncon * (sizeof(ContactAnchor) + kVectors * 4);
}

}  // namespace

void ComputeStep(const mjModel* m, mjData* d, int instance) {
  State state(m, d, instance);
  if (IsLaterStage(m, d, state)) {
    ApplyHeldForce(m, d, instance, state);
    return;
  }
  if (state.header().active > 0 || state.header().pending != 0) state.ResetUnlessSound(m, instance);
  OpenStage(m, d, state);
  DiscardPending(state);
  state.header().work = 0;
  const bool pulses = state.header().active > 0;
  const bool closing = AnyMayClose(m, d, state.header().touch);
  if (!pulses && !closing) return;

  Scratch scratch(d);
  if (!scratch.Fits(StepBytes(m, d))) {
    mju_warning(
        "mujoco_impact.waveform: the impacts of a step need more memory than mjData has left and "
        "wait; raise <size memory=\"...\"/> in the model");
    return;
  }
  const Mobility mobility(m, d, scratch);
  Delivery delivery = MakeDelivery(m, scratch);
  if (pulses) DeliverActive(m, d, mobility, state, delivery, scratch);
  if (closing) ResolveImpacts(m, d, instance, mobility, state, delivery, scratch);
  if (pulses && state.header().pending_pulses > 0) {
    EndOverfullByImpacts(m, d, mobility, state, delivery, scratch);
  }
  Apply(m, d, mobility, state, delivery, scratch);
  NoteCarried(m, d, instance, state);
  ComputeSensors(m, d, instance, true);
}

}  // namespace mujoco_impact::engine
