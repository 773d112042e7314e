// SPDX-License-Identifier: Apache-2.0

#include "engine/foresee/silence.h"

#include <cmath>
#include <optional>

#include "engine/common/scratch.h"
#include "engine/foresee/step_memory.h"
#include "engine/handover/silent_rows.h"
#include "engine/path/contact_path.h"
#include "engine/path/mobility.h"
#include "engine/path/motion.h"
#include "engine/path/rest.h"

namespace mujoco_impact::engine {

namespace {

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

void SilenceMoving(const mjModel* m, mjData* d, int instance, bool moving, State& state) {
  const bool pressed = state.header().pressed_until > state.header().clock;
  if (d->nefc == d->ne || !(moving || pressed)) return;
  const Ownership ownership(m, instance);
  const mjtNum at_rest = LargestRestSpeed(m, d);
  std::optional<RestOfContacts> rest;
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    if (!IsTakenOver(ownership, contact)) continue;
    const mjtNum c = ClosingSpeed(m, d, contact, state.mocap());
    // what falls back meanwhile is MuJoCo's to carry
    if (pressed && HasPulse(state, contact, c < 0)) {
      Silence(d, i);
      continue;
    }
    if (!moving || std::abs(c) <= at_rest) continue;
    if (!rest) {
      // without memory the impacts of the step wait (step.cc), and MuJoCo carries them meanwhile
      if (!StepFits(m, d, Scratch(d))) return;
      rest.emplace(m, d, state.mocap());
    }
    if (rest->IsExceeded(contact)) Silence(d, i);
  }
}

}  // namespace mujoco_impact::engine
