// SPDX-License-Identifier: Apache-2.0

#include "engine/silence.h"

#include <cmath>
#include <optional>

#include "engine/contact_path.h"
#include "engine/mobility.h"
#include "engine/motion.h"
#include "engine/rest.h"
#include "engine/scratch.h"
#include "engine/step_memory.h"

namespace mujoco_impact::engine {

namespace {

// a_ref is then beyond any acceleration of a sane state [m]; half of it tells such a row, for 1e15
// less a depth is rounded.
constexpr mjtNum kApart = 1e15;

// Whether bodies move faster than those at rest on each other at least may.
bool IsOnTheMove(const mjModel* m, const mjData* d, const mjContact& contact,
                 const MocapRecord* mocap) {
  return std::abs(ClosingSpeed(m, d, contact, mocap)) > LargestRestSpeed(m, d);
}

// Whether they move faster than what presses them lets those at rest.
class RestOfContacts {
 public:
  RestOfContacts(const mjModel* m, mjData* d, const MocapRecord* mocap)
      : m_(m),
        d_(d),
        mocap_(mocap),
        scratch_(d),
        mobility_(m, d, scratch_),
        motion_(PredictMotion(m, d, mobility_, scratch_)) {
    motion_.mocap = mocap;
  }

  bool IsExceeded(const mjContact& contact) const {
    const ContactAnchor anchor = AnchorContact(m_, d_, contact);
    const ContactPath path(m_, d_, anchor, motion_);
    return std::abs(ClosingSpeed(m_, d_, contact, mocap_)) > path.RestSpeed(m_, d_, 0);
  }

 private:
  const mjModel* m_;
  mjData* d_;
  const MocapRecord* mocap_;
  Scratch scratch_;
  const Mobility mobility_;
  Motion motion_;
};

}  // namespace

bool HasPulse(const State& state, const mjContact& contact, bool parting) {
  for (int i = 0; i < state.slots(); ++i) {
    const Pulse& pulse = state.pulse(i);
    if (pulse.geom[0] != contact.geom[0] || pulse.geom[1] != contact.geom[1]) continue;
    const mjtNum until = parting ? pulse.parts_until() : pulse.end();
    if (pulse.serial > 0 && until > state.header().clock) return true;
  }
  return false;
}

void SilenceMoving(const mjModel* m, mjData* d, int instance, bool pulses, State& state) {
  if (d->nefc == d->ne) return;
  const bool pressed = state.header().pressed_until > state.header().clock;
  const Ownership ownership(m, instance);
  std::optional<RestOfContacts> rest;
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    if (!IsTakenOver(ownership, contact)) continue;
    // what falls back meanwhile is MuJoCo's to carry
    if (pressed && HasPulse(state, contact, ClosingSpeed(m, d, contact, state.mocap()) < 0)) {
      Silence(d, i);
      continue;
    }
    if (pulses || !IsOnTheMove(m, d, contact, state.mocap())) continue;
    if (!rest) {
      // without memory the impacts of the step wait (step.cc), and MuJoCo carries them meanwhile
      if (!StepFits(m, d, Scratch(d))) return;
      rest.emplace(m, d, state.mocap());
    }
    if (rest->IsExceeded(contact)) Silence(d, i);
  }
}

// All rows of a pyramid push the bodies apart. Of an elliptic cone only the first does: the others
// are friction, to which a reference is a demand. The distance does it, for the integrator
// `discrete` computes stiffness and damping anew.
void Silence(mjData* d, int contact) {
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

bool IsSilent(const mjData* d, const mjContact& contact) {
  return contact.efc_address >= 0 && d->efc_pos[contact.efc_address] >= 0.5 * kApart;
}

}  // namespace mujoco_impact::engine
