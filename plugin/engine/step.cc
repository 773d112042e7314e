// SPDX-License-Identifier: Apache-2.0

#include "engine/step.h"

#include "engine/config.h"
#include "engine/deliver.h"
#include "engine/gather.h"
#include "engine/island_system.h"
#include "engine/islands.h"
#include "engine/ownership.h"
#include "engine/resolve.h"
#include "engine/runge_kutta.h"
#include "engine/scratch.h"
#include "engine/slots.h"
#include "engine/state.h"

namespace mujoco_impact::engine {

namespace {

// What the stages of one step share.
struct Step {
  const mjModel* m;
  mjData* d;
  int instance;
  State& state;
  Delivery delivery;
};

// Delivers the part of a new pulse that belongs to this step. Without a free slot, and for an
// impact that is over within a step, that is all of it: no momentum is lost.
void AddImpact(Step& step, const Config& config, const ContactRow& row, const Impact& impact) {
  const Pulse pulse = MakePulse(step.d, row, impact, config, step.state);
  const Share whole{impact.impulse, impact.moment, 1};
  Share share =
      impact.at_once ? whole : ShareOfStep(pulse, step.state.header().clock, step.m->opt.timestep);
  if (!AddPending(step.state, pulse, share.delivered_next)) share = whole;
  AddRowTransposed(step.m, row, share.impulse, step.delivery.impulse);
  AddRowTransposed(step.m, row, share.moment, step.delivery.moment);
  AddRowTransposed(step.m, row, Detour(step.m, share), step.delivery.detour);
}

// The contact of the island that closes first.
ImpactTime FirstClosing(const Gathered& gathered, const int* position, int count, mjtNum timestep) {
  ImpactTime time{timestep, timestep, -1};
  for (int k = 0; k < count; ++k) {
    const int i = position[k];
    if (!gathered.due[i]) continue;
    if (time.first < 0 || gathered.tau[i] < time.tau) time = {gathered.tau[i], timestep, k};
  }
  return time;
}

void ResolveOne(Step& step, const Config& config, const Ownership& ownership,
                const Outlook& outlook, const Gathered& gathered, const int* position, int count) {
  const mjModel* m = step.m;
  Scratch scratch(step.d);
  int* contacts = scratch.Take<int>(count);
  for (int k = 0; k < count; ++k) contacts[k] = gathered.contact[position[k]];
  if (!scratch.Fits(IslandBytes(m, step.d, contacts, count))) {
    mju_warning(
        "mujoco_impact.waveform: an impact of %d contacts needs more memory than mjData has left "
        "and is skipped; raise <size memory=\"...\"/> in the model",
        count);
    return;
  }
  const ImpactTime time = FirstClosing(gathered, position, count, m->opt.timestep);
  const IslandSystem system =
      BuildIsland(m, step.d, contacts, count, outlook.motion, time.tau, scratch);
  const mjtNum* velocity = SettledVelocity(m, outlook, time.tau, scratch);
  Impact* impacts = scratch.Take<Impact>(count);
  ResolveIsland(m, config, ownership, system, time, velocity, impacts, scratch);
  for (int k = 0; k < count; ++k) {
    if (impacts[k].impulse > 0) AddImpact(step, config, system.row[k], impacts[k]);
  }
}

void ResolveContacts(Step& step, bool pulses, Scratch& scratch) {
  const mjModel* m = step.m;
  const Ownership ownership(m, step.instance);
  const Config config = ReadConfig(m, step.instance, ownership.size(), nullptr);
  const Outlook outlook = LookAhead(m, step.d, step.delivery, pulses, scratch);
  const Gathered gathered = GatherContacts(m, step.d, ownership, config.touch, outlook, scratch);
  const Islands islands =
      FindIslands(m, step.d, gathered.contact, gathered.due, gathered.count, scratch);
  for (int i = 0; i < islands.number; ++i) {
    const int begin = islands.start[i];
    ResolveOne(step, config, ownership, outlook, gathered, islands.position + begin,
               islands.start[i + 1] - begin);
  }
}

}  // namespace

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
  Step step{m, d, instance, state, MakeDelivery(m, scratch)};
  if (pulses) DeliverActive(m, d, state, step.delivery, scratch);
  if (closing) ResolveContacts(step, pulses, scratch);
  Apply(m, d, state, step.delivery, scratch);
}

}  // namespace mujoco_impact::engine
