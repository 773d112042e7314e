// SPDX-License-Identifier: Apache-2.0

#include "engine/sensor.h"

#include "engine/line_of_action.h"
#include "engine/ownership.h"
#include "engine/state.h"
#include "law/waveform.h"

namespace mujoco_impact::engine {

namespace {

void WriteRecord(const GeomRecord& record, mjtNum* output) {
  mju_zero3(output);
  output[3] = record.impulse;
  output[4] = record.peak;
  output[5] = record.alpha;
  output[6] = record.count;
}

// Adds a pulse that acts in this step; one that begins in it is not in the records yet.
void AddPulse(const mjModel* m, const Ownership& ownership, const Pulse& pulse, mjtNum* output) {
  const Vector3 direction = PulseDirection(pulse);
  const mjtNum part = pulse.delivered_next - pulse.delivered;
  const mjtNum force = part * pulse.scale_next * pulse.impulse / m->opt.timestep;
  for (int side = 0; side < 2; ++side) {
    const int index = ownership.Index(static_cast<int>(pulse.geom[side]));
    if (index < 0) continue;
    mjtNum* of_geom = output + kNumbersPerGeom * index;
    Store(Load(of_geom) + (side == 0 ? -force : force) * direction, of_geom);
    if (pulse.serial > 0) continue;
    of_geom[3] = pulse.impulse;
    of_geom[4] = law::WaveformHeight(pulse.impulse, pulse.duration);
    of_geom[5] = pulse.alpha;
    of_geom[6] += 1;
  }
}

void WriteOutput(const mjModel* m, int instance, bool impacts, State& state, mjtNum* output) {
  for (int i = 0; i < state.capacity(); ++i) {
    WriteRecord(state.record(i), output + kNumbersPerGeom * i);
  }
  if (!impacts) return;
  const Ownership ownership(m, instance);
  for (int i = 0; i < state.slots(); ++i) {
    const Pulse& pulse = state.pulse(i);
    if (pulse.delivered_next > pulse.delivered) AddPulse(m, ownership, pulse, output);
  }
}

}  // namespace

void ComputeSensors(const mjModel* m, mjData* d, int instance, bool impacts) {
  if (m->opt.disableflags & mjDSBL_SENSOR) return;
  State state(m, d, instance);
  for (int i = 0; i < m->nsensor; ++i) {
    if (m->sensor_type[i] != mjSENS_PLUGIN || m->sensor_plugin[i] != instance) continue;
    WriteOutput(m, instance, impacts, state, d->sensordata + m->sensor_adr[i]);
  }
}

}  // namespace mujoco_impact::engine
