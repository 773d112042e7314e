// SPDX-License-Identifier: Apache-2.0

#include "engine/scene/meeting.h"

#include <array>
#include <cstring>

#include "engine/scene/config.h"
#include "engine/scene/ownership.h"

namespace mujoco_impact::engine {

namespace {

// Whether a contact has the same impact under both; the list `alpha` is of pairs within an
// instance.
bool AreSame(const Config& a, const Config& b) {
  const auto numbers = [](const Config& c) {
    return std::array{c.restitution,
                      c.effective_modulus,
                      c.duration,
                      c.touch,
                      c.tolerance,
                      c.calibrated.height_factor,
                      c.calibrated.duration_factor,
                      c.calibrated.base_duration,
                      c.calibrated.unit_factor,
                      c.waveform_restitution,
                      c.paper_friction.static_factor,
                      c.paper_friction.dynamic_factor};
  };
  return a.law == b.law && a.dissipation == b.dissipation && a.duration_rule == b.duration_rule &&
         a.passive == b.passive && a.friction == b.friction && numbers(a) == numbers(b) &&
         std::strcmp(a.material_pairs, b.material_pairs) == 0;
}

bool AreExcluded(const mjModel* m, int first, int second) {
  for (int i = 0; i < m->nexclude; ++i) {
    const int signature = m->exclude_signature[i];
    if (signature == (first << 16) + second || signature == (second << 16) + first) return true;
  }
  return false;
}

// Whether a body hangs on the other: MuJoCo lets them pass, but for what hangs on the world.
bool IsParent(const mjModel* m, int parent, int child) {
  return parent != 0 && m->body_weldid[m->body_parentid[child]] == parent;
}

bool CanMeet(const mjModel* m, int first, int second) {
  if (IsPair(m, first, second)) return true;
  const int body[2] = {m->geom_bodyid[first], m->geom_bodyid[second]};
  const int weld[2] = {m->body_weldid[body[0]], m->body_weldid[body[1]]};
  if (weld[0] == weld[1] || AreExcluded(m, body[0], body[1])) return false;
  const bool filtered = !(m->opt.disableflags & mjDSBL_FILTERPARENT);
  if (filtered && (IsParent(m, weld[0], weld[1]) || IsParent(m, weld[1], weld[0]))) return false;
  return (m->geom_contype[first] & m->geom_conaffinity[second]) ||
         (m->geom_contype[second] & m->geom_conaffinity[first]);
}

// Whether geoms of the two can meet, and which.
bool FindMeeting(const mjModel* m, const Ownership& ours, const Ownership& others,
                 Meeting& meeting) {
  for (int i = 0; i < ours.size(); ++i) {
    for (int j = 0; j < others.size(); ++j) {
      if (!CanMeet(m, ours.Geom(i), others.Geom(j))) continue;
      meeting.geom[0] = ours.Geom(i);
      meeting.geom[1] = others.Geom(j);
      return true;
    }
  }
  return false;
}

}  // namespace

bool IsPair(const mjModel* m, int first, int second) {
  for (int i = 0; i < m->npair; ++i) {
    const int one = m->pair_geom1[i], other = m->pair_geom2[i];
    if ((one == first && other == second) || (one == second && other == first)) return true;
  }
  return false;
}

Meeting FindConflict(const mjModel* m, int instance) {
  const Ownership ours(m, instance);
  const Config config = ReadConfig(m, instance, ours.size(), nullptr);
  for (int other = 0; other < m->nplugin; ++other) {
    if (other == instance || m->plugin[other] != m->plugin[instance]) continue;
    const Ownership others(m, other);
    if (AreSame(config, ReadConfig(m, other, others.size(), nullptr))) continue;
    Meeting meeting{other, {-1, -1}};
    if (FindMeeting(m, ours, others, meeting)) return meeting;
  }
  return {-1, {-1, -1}};
}

}  // namespace mujoco_impact::engine
