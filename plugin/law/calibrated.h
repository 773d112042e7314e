// SPDX-License-Identifier: Apache-2.0
// The law `calibrated`: Dondo and Noborio's equation (6), as printed, and its scaling by α_k.
//
//   H = S_h p        W = κ S_w / p · 1e-3 + W₀        P = (2/π) H W        P_k = α_k P
//
// p = m u_z [kg m/s] is the momentum of the incoming body along the normal, S_h [N per kg m/s] and
// S_w the printed parameters, W₀ [s] the mean duration they measured (7.5 ms), κ [-] the factor
// that gives S_w/p the unit ms: the paper does not state the unit, its data rule out κ = 1 and fit
// κ = 0.083 ± 0.024. The waveform is common to the island; α_k scales its height per contact.
//
// Taken literally this injects energy: P(p → 0) does not vanish. The passivity guard stops that.

#ifndef MUJOCO_IMPACT_LAW_CALIBRATED_H_
#define MUJOCO_IMPACT_LAW_CALIBRATED_H_

namespace mujoco_impact::law {

struct CalibratedWaveform {
  double height_factor;    // S_h [N s / (kg m)]
  double duration_factor;  // S_w [ms kg m/s before κ]
  double base_duration;    // W₀ [s]
  double unit_factor;      // κ [-]
};

// W [s] at the momentum p > 0.
double CalibratedDuration(const CalibratedWaveform& waveform, double momentum);

// P [N s] of the common waveform at the momentum p > 0, before α_k.
double CalibratedImpulse(const CalibratedWaveform& waveform, double momentum);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_CALIBRATED_H_
