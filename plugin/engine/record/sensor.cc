// SPDX-License-Identifier: Apache-2.0

#include "engine/record/sensor.h"

#include "engine/state/state.h"

namespace mujoco_impact::engine {

namespace {

void Write(const GeomReading& reading, const double* force, mjtNum* output) {
  mju_copy3(output, force);
  output[3] = reading.impulse;
  output[4] = reading.peak;
  output[5] = reading.alpha;
  output[6] = reading.count;
  mju_copy3(output + 7, reading.total);
  output[10] = reading.largest;
}

}  // namespace

void ComputeSensors(const mjModel* m, mjData* d, int instance, bool impacts) {
  if (m->opt.disableflags & mjDSBL_SENSOR) return;
  State state(m, d, instance);
  for (int i = 0; i < m->nsensor; ++i) {
    if (m->sensor_type[i] != mjSENS_PLUGIN || m->sensor_plugin[i] != instance) continue;
    mjtNum* output = d->sensordata + m->sensor_adr[i];
    for (int k = 0; k < state.capacity(); ++k) {
      const GeomRecord& record = state.record(k);
      constexpr double kNone[3] = {0, 0, 0};
      Write(impacts ? record.next : record.last, impacts ? record.force : kNone,
            output + kNumbersPerGeom * k);
    }
  }
}

}  // namespace mujoco_impact::engine
