// SPDX-License-Identifier: Apache-2.0

#include "engine/step.h"

#include "engine/deliver.h"
#include "engine/gather.h"
#include "engine/impacts.h"
#include "engine/runge_kutta.h"
#include "engine/scratch.h"
#include "engine/sensor.h"
#include "engine/slots.h"
#include "engine/state.h"

namespace mujoco_impact::engine {

void ComputeStep(const mjModel* m, mjData* d, int instance) {
  State state(m, d, instance);
  if (IsLaterStage(m, d, state)) {
    ApplyHeldForce(m, d, state);
    return;
  }
  OpenStage(m, d, state);
  DiscardPending(state);
  const bool pulses = state.header().active > 0;
  const bool closing = AnyMayClose(m, d, state.header().touch);
  if (!pulses && !closing) return;

  Scratch scratch(d);
  Delivery delivery = MakeDelivery(m, scratch);
  if (pulses) DeliverActive(m, d, state, delivery, scratch);
  if (closing) ResolveImpacts(m, d, instance, state, delivery, scratch);
  Apply(m, d, state, delivery, scratch);
  ComputeSensors(m, d, instance, true);
}

}  // namespace mujoco_impact::engine
