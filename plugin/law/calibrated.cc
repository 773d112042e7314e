// SPDX-License-Identifier: Apache-2.0

#include "law/calibrated.h"

#include "law/waveform.h"

namespace mujoco_impact::law {

double CalibratedDuration(const CalibratedWaveform& waveform, double momentum) {
  // W = κ S_w / p + W₀ (6), the first term in ms
  return waveform.unit_factor * waveform.duration_factor / momentum * 1e-3 + waveform.base_duration;
}

double CalibratedImpulse(const CalibratedWaveform& waveform, double momentum) {
  // H = S_h p (6)
  const double height = waveform.height_factor * momentum;
  return WaveformImpulse(height, CalibratedDuration(waveform, momentum));
}

}  // namespace mujoco_impact::law
