// SPDX-License-Identifier: Apache-2.0
// The artificial impulse waveform: when, within its duration, an impulse is delivered.
//
// A pulse of duration W and peak height H. Compression is a quarter sine that rises for
// W_c = W/(1+E), expansion a quarter sine that falls for W_e = W E/(1+E):
//
//   f(t) = H sin(π t / (2 W_c))            0 ≤ t ≤ W_c
//   f(t) = H cos(π (t − W_c) / (2 W_e))    W_c ≤ t ≤ W
//
// Area (impulse) P = (2/π) H W for every E; expansion impulse / compression impulse = E.
// Limits: E = 1 is a half sine; E = 0 ends at its peak.
//
// The figure of the source (Dondo and Noborio, figure 2) is lost; this shape is the reading that
// its measured impulses support as well as any. It lives here and nowhere else.
//
// All functions are of the pulse of unit area and unit duration; time is in units of W.

#ifndef MUJOCO_IMPACT_LAW_WAVEFORM_H_
#define MUJOCO_IMPACT_LAW_WAVEFORM_H_

namespace mujoco_impact::law {

// Height H [N] of the pulse with impulse P [N s] and duration W [s]: H = π P / (2 W).
double WaveformHeight(double impulse, double duration);

// Impulse P [N s] of the pulse with height H [N] and duration W [s]: P = (2/π) H W.
double WaveformImpulse(double height, double duration);

// f(t): the force; 0 before and after the pulse.
double WaveformForce(double t, double restitution);

// ∫₀^t f: the part of the impulse delivered by time t; 0 for t ≤ 0 and exactly 1 for t ≥ 1.
double WaveformCumulative(double t, double restitution);

// ∫₀^t s f(s) ds: first moment about the onset.
double WaveformMoment(double t, double restitution);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_WAVEFORM_H_
