// SPDX-License-Identifier: Apache-2.0

#include "engine/step.h"

#include "engine/common/scratch.h"
#include "engine/deliver/deliver.h"
#include "engine/deliver/flights.h"
#include "engine/foresee/gather.h"
#include "engine/foresee/look.h"
#include "engine/foresee/silence.h"
#include "engine/foresee/step_memory.h"
#include "engine/handover/runge_kutta.h"
#include "engine/path/mobility.h"
#include "engine/pulses/settled_energy.h"
#include "engine/pulses/under_way.h"
#include "engine/record/record.h"
#include "engine/record/sensor.h"
#include "engine/record/slots.h"
#include "engine/resolve/impacts.h"
#include "engine/state/state.h"

namespace mujoco_impact::engine {

void ComputeStep(const mjModel* m, mjData* d, int instance) {
  State state(m, d, instance);
  if (IsLaterStage(m, d, state)) {
    ApplyHeldForce(m, d, instance, state);
    return;
  }
  if (state.header().active > 0 || state.header().pending != 0) state.ResetUnlessSound(m, instance);
  OpenStage(m, d, state);
  DiscardPending(m, state);
  state.header().work = 0;
  const bool pulses = state.header().active > 0;
  const mjtNum touch = state.header().touch;
  if (m->nmocap > 0) FindMocapVelocities(m, d, instance, state);
  Look look{};
  if (!pulses) look = LookAtContacts(m, d, state.mocap(), touch);
  SilenceMoving(m, d, instance, look.moves, state);
  if (!pulses && !look.closes) return;

  Scratch scratch(d);
  if (!StepFits(m, d, scratch)) {
    mju_warning(
        "mujoco_impact.waveform: the impacts of a step need more memory than mjData has left and "
        "wait; raise <size memory=\"...\"/> in the model");
    return;
  }
  BeginRecords(state);
  const Mobility mobility(m, d, scratch);
  Delivery delivery = MakeDelivery(m, scratch);
  mjtNum* kick = nullptr;
  if (pulses) {
    DeliverActive(m, d, mobility, state, delivery, scratch);
    kick = scratch.Take<mjtNum>(m->nv);
    mobility.Solve(kick, delivery.impulse);
  }
  Flights flights;
  if (!pulses || AnyMayCloseByPulses(m, d, state.mocap(), touch, kick)) {
    flights = ResolveImpacts(m, d, instance, mobility, kick, state, delivery, scratch);
  }
  if (pulses && state.header().pending_pulses > 0) {
    EndOverfullByImpacts(m, d, mobility, state, delivery, scratch);
  }
  Apply(m, d, mobility, state, delivery, scratch);
  flights.Finish(m, state);
  RecordForces(m, instance, state);
  NoteCarried(m, d, instance, state);
  ComputeSensors(m, d, instance, true);
}

}  // namespace mujoco_impact::engine
