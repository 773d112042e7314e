// SPDX-License-Identifier: Apache-2.0

#include "engine/commit.h"

#include "engine/common/scratch.h"
#include "engine/deliver/deliver.h"
#include "engine/deliver/flights.h"
#include "engine/foresee/look.h"
#include "engine/handover/runge_kutta.h"
#include "engine/path/motion.h"
#include "engine/record/record.h"
#include "engine/record/slots.h"
#include "engine/state/state.h"

namespace mujoco_impact::engine {

namespace {

// The correction was computed for the integrator of the options. mj_step2 integrates with Euler
// even where the option says RK4: then the impulse acted from the start of the step.
void CorrectForEuler(const mjModel* m, mjData* d, State& state) {
  Scratch scratch(d);
  mjtNum* shift = scratch.Take<mjtNum>(m->nv);
  Mobility(m, d, scratch).Solve(shift, state.held_force());
  // Δq for lag 0 = Δq for lag a − a h ΔV
  const mjtNum h = m->opt.timestep;
  mju_addToScl(state.correction(), shift, -ImpulseLag(m) * h * h, m->nv);
}

// With both flags MuJoCo calls no passive plugin, though it does call advance. Compiled in they are
// refused; this is for flags that are set afterwards.
void WarnIfSilenced(const mjModel* m, mjData* d, State& state) {
  constexpr int kSilenced = mjDSBL_SPRING | mjDSBL_DAMPER;
  if ((m->opt.disableflags & kSilenced) != kSilenced ||
      !LookAtContacts(m, d, state.mocap(), state.header().touch).closes)
    return;
  mju_warning(
      "mujoco_impact.waveform: an impact is missed, for the flags spring and damper are both "
      "disabled and MuJoCo calls no passive plugin; enable one of them");
}

}  // namespace

void CommitStep(const mjModel* m, mjData* d, int instance) {
  State state(m, d, instance);
  Header& header = state.header();
  const bool half_step_missing = m->opt.integrator == mjINT_RK4 && !WasRungeKutta(state);
  header.stage_open = 0;
  WarnIfSilenced(m, d, state);
  if (header.pending != 0) {
    CommitFlights(m, d, state);
    if (half_step_missing) CorrectForEuler(m, d, state);
    mj_integratePos(m, d->qpos, state.correction(), 1);
    Scratch scratch(d);
    WakeStruck(m, d, state.held_force(), scratch);
    CommitPulses(state);
    CommitRecords(state);
    header.pending = 0;
    header.pushed_until = header.clock + m->opt.timestep;
  }
  CommitMocap(m, d, state);
  header.clock += m->opt.timestep;
}

}  // namespace mujoco_impact::engine
