// SPDX-License-Identifier: Apache-2.0

#include "engine/resolve/reach.h"

#include <algorithm>

#include "engine/scene/contact_stiffness.h"
#include "law/impact_clock.h"

namespace mujoco_impact::engine {

namespace {

// Over the speed of the fastest closing: a heavy ball sends a light one off at twice its own.
constexpr mjtNum kFastest = 2;

}  // namespace

mjtNum ReachOfRound(const mjModel* m, const mjData* d, const Config& config, const Outlook& outlook,
                    mjtNum flight, Gathered& contacts) {
  flight = std::min(flight, m->opt.timestep - outlook.start);
  mjtNum reach = 0;
  for (int k = 0; k < contacts.count; ++k) {
    if (!contacts.due[k]) continue;
    const ContactPath path(m, d, Anchor(m, d, contacts, k), outlook.motion);
    const mjtNum speed = -path.GapRate(contacts.tau[k]);
    if (speed <= 0) continue;
    const mjtNum contact_time = EstimateContactTime(m, d, config, *contacts.contact[k], speed);
    const mjtNum time = std::max(flight, law::kSameImpactTimes * contact_time);
    reach = std::max(reach, kFastest * speed * time);
  }
  return reach;
}

}  // namespace mujoco_impact::engine
