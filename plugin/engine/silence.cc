// SPDX-License-Identifier: Apache-2.0

#include "engine/silence.h"

namespace mujoco_impact::engine {

namespace {

bool Presses(const Pulse& pulse, mjtNum clock) {
  // in durations: a waveform is not over just when its bodies have parted, and one that came at
  // once has them on the path that it leaves
  constexpr mjtNum kParting = 2;
  return pulse.serial > 0 && pulse.onset + kParting * pulse.duration > clock;
}

}  // namespace

bool AnyPulsePresses(const State& state) {
  for (int i = 0; i < state.slots(); ++i) {
    if (Presses(state.pulse(i), state.header().clock)) return true;
  }
  return false;
}

bool HasPulse(const State& state, const mjContact& contact) {
  for (int i = 0; i < state.slots(); ++i) {
    const Pulse& pulse = state.pulse(i);
    if (pulse.geom[0] != contact.geom[0] || pulse.geom[1] != contact.geom[1]) continue;
    if (Presses(pulse, state.header().clock)) return true;
  }
  return false;
}

// All rows of a pyramid push the bodies apart. Of an elliptic cone only the first does: the others
// are friction, to which a reference is a demand. The distance does it, for the integrator
// `discrete` computes stiffness and damping anew.
void Silence(mjData* d, int contact) {
  constexpr mjtNum kApart = 1e15;  // with it a_ref is beyond any acceleration of a sane state [m]
  const int begin = d->contact[contact].efc_address, type = d->efc_type[begin];
  const int end = type == mjCNSTR_CONTACT_ELLIPTIC ? begin + 1 : static_cast<int>(d->nefc);
  for (int i = begin; i < end && d->efc_type[i] == type && d->efc_id[i] == contact; ++i) {
    // a_ref = −b v − k d (pos − margin)
    d->efc_pos[i] = d->efc_margin[i] + kApart;
    mjtNum* KBI = d->efc_KBIP + 4 * i;
    KBI[0] = 1;
    KBI[1] = 0;
    KBI[2] = 1;
  }
}

void SilencePressed(const mjModel* m, mjData* d, int instance, const State& state) {
  if (!AnyPulsePresses(state)) return;
  const Ownership ownership(m, instance);
  for (int i = 0; i < d->ncon; ++i) {
    if (IsTakenOver(ownership, d->contact[i]) && HasPulse(state, d->contact[i])) Silence(d, i);
  }
}

}  // namespace mujoco_impact::engine
