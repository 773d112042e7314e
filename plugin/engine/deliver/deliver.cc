// SPDX-License-Identifier: Apache-2.0

#include "engine/deliver/deliver.h"

#include <algorithm>

#include "engine/path/motion.h"
#include "law/waveform.h"

namespace mujoco_impact::engine {

namespace {

// The impulse by which gravity and springs differ along the bent path, as a force of the step.
void AddDetour(const mjModel* m, mjData* d, const Mobility& mobility, const Delivery& delivery,
               mjtNum* force, Scratch& scratch) {
  mjtNum* detour = scratch.Take<mjtNum>(m->nv);
  mjtNum* displacement = scratch.Take<mjtNum>(m->nv);
  const PathWeights weights = DetourWeights(m);
  for (int i = 0; i < m->nv; ++i) {
    detour[i] = weights.impulse * delivery.impulse[i] + weights.moment * delivery.moment[i] +
                weights.second * delivery.second[i];
  }
  mobility.Solve(displacement, detour);
  mju_scl(displacement, displacement, 1 / m->opt.timestep, m->nv);
  AddWeightGradient(m, d, displacement, force);
}

// All that is left, in the middle of the step.
Share RestAtOnce(const Pulse& pulse, mjtNum h) {
  const mjtNum impulse = pulse.remaining();
  return {impulse, 0.5 * h * impulse, 1};
}

}  // namespace

Delivery MakeDelivery(const mjModel* m, Scratch& scratch) {
  return {scratch.Zeros(m->nv), scratch.Zeros(m->nv), scratch.Zeros(m->nv), scratch.Zeros(m->nv)};
}

Kicks MakeKicks(const mjModel* m, Scratch& scratch) {
  return {scratch.Zeros(m->nv), scratch.Zeros(m->nv), scratch.Zeros(m->nv), false};
}

void AddKicks(const mjModel* m, const mjData* d, const Kicks& kicks, const Delivery& delivery,
              Scratch& scratch) {
  if (!kicks.any) return;
  mjtNum* impulse = scratch.Take<mjtNum>(m->nv);
  const auto add = [&](const mjtNum* kick, mjtNum* sum) {
    mj_mulM(m, d, impulse, kick);
    mju_addTo(sum, impulse, m->nv);
  };
  add(kicks.velocity, delivery.impulse);
  add(kicks.moment, delivery.moment);
  add(kicks.second, delivery.second);
}

void AddTo(const mjModel* m, const Delivery& within, Delivery& delivery) {
  mju_addTo(delivery.impulse, within.impulse, m->nv);
  mju_addTo(delivery.moment, within.moment, m->nv);
  mju_addTo(delivery.second, within.second, m->nv);
}

Share ShareOfStep(const Pulse& pulse, mjtNum clock, mjtNum h) {
  if (pulse.finishing != 0) return RestAtOnce(pulse, h);
  const mjtNum W = pulse.duration, E = pulse.restitution;
  const mjtNum begin = (clock - pulse.onset) / W;
  const mjtNum end = (clock + h - pulse.onset) / W;
  const mjtNum next = law::WaveformCumulative(end, E);
  // the part of a new pulse that lies before this step comes now, with its own time
  const mjtNum from = pulse.delivered == 0 ? 0 : begin;
  const mjtNum P = pulse.scale_next * pulse.impulse;
  Share share;
  share.delivered_next = next;
  share.impulse = P * (next - pulse.delivered);
  share.moment = P * W * (law::WaveformMoment(end, E) - law::WaveformMoment(from, E)) +
                 (pulse.onset - clock) * share.impulse;
  return share;
}

void WakeStruck(const mjModel* m, mjData* d, const mjtNum* force, Scratch& scratch) {
  mjtNum* kick = scratch.Take<mjtNum>(m->nv);
  for (int tree = 0; tree < m->ntree; ++tree) {
    const int begin = m->tree_dofadr[tree], dofs = m->tree_dofnum[tree];
    if (!IsAsleep(d, tree) || mju_isZero(force + begin, dofs)) continue;
    mju_scl(kick, force + begin, m->opt.timestep, dofs);
    SolveTreeInertia(m, d, tree, kick);
    mju_addTo(d->qvel + begin, kick, dofs);
  }
}

void Apply(const mjModel* m, mjData* d, const Mobility& mobility, State& state,
           const Delivery& delivery, Scratch& scratch) {
  const mjtNum h = m->opt.timestep;
  mjtNum* correction = state.correction();
  mjtNum* force = state.held_force();
  mjtNum* moment = scratch.Take<mjtNum>(m->nv);
  // Δq = M⁻¹ (a h ΔP − M₁)
  const mjtNum a = ImpulseLag(m);
  for (int i = 0; i < m->nv; ++i) moment[i] = a * h * delivery.impulse[i] - delivery.moment[i];
  mobility.Solve(correction, moment);
  for (int tree = 0; tree < m->ntree; ++tree) {
    if (!IsAsleep(d, tree)) continue;
    const int begin = m->tree_dofadr[tree], dofs = m->tree_dofnum[tree];
    mju_addScl(correction + begin, moment + begin, delivery.impulse + begin, (1 - a) * h, dofs);
    SolveTreeInertia(m, d, tree, correction + begin);
  }
  const bool damped = ImplicitDamping(m);
  for (int i = 0; i < m->nv; ++i) {
    force[i] = delivery.impulse[i] / h;
    if (damped) force[i] -= m->dof_damping[i] * correction[i] / h;
  }
  AddDetour(m, d, mobility, delivery, force, scratch);
  mju_addTo(d->qfrc_passive, force, m->nv);
  state.header().pending = 1;
}

}  // namespace mujoco_impact::engine
