// SPDX-License-Identifier: Apache-2.0

#include "engine/resolve/reach.h"

#include <algorithm>

#include "engine/scene/contact_stiffness.h"
#include "engine/scene/tree_kinds.h"
#include "law/impact_clock.h"

namespace mujoco_impact::engine {

namespace {

// Over the speed of the fastest closing: a heavy ball sends a light one off at twice its own.
constexpr mjtNum kFastest = 2;

// Of 1/(1/R₁ + 1/R₂): so far bodies may fly within an impact of a crowded island, whose lines do
// not turn with them.
constexpr mjtNum kOfRadius = 0.5;

}  // namespace

mjtNum ReachOfRound(const mjModel* m, const mjData* d, const Materials& materials,
                    const Outlook& outlook, mjtNum flight, Gathered& contacts) {
  flight = std::min(flight, m->opt.timestep - outlook.start);
  mjtNum reach = 0;
  for (int k = 0; k < contacts.count; ++k) {
    if (!contacts.due[k]) continue;
    const ContactPath path(m, d, Anchor(m, d, contacts, k), outlook.motion);
    const mjtNum speed = -path.GapRate(contacts.tau[k]);
    if (speed <= 0) continue;
    const mjtNum contact_time = EstimateContactTime(m, d, materials, *contacts.contact[k], speed);
    const mjtNum time = std::max(flight, law::kSameImpactTimes * contact_time);
    reach = std::max(reach, kFastest * speed * time);
  }
  return reach;
}

bool IsCrowded(const mjModel* m, mjData* d, const Gathered& contacts, const int* position,
               int count) {
  constexpr double kMostCouplings = 4e5;
  // a contact couples with the others of its two bodies
  if (2.0 * count * count <= kMostCouplings) return false;
  Scratch scratch(d);
  int* of_tree = scratch.Take<int>(m->ntree);
  std::fill_n(of_tree, m->ntree, 0);
  for (int i = 0; i < count; ++i) {
    for (const int tree : TreesOf(m, *contacts.contact[position[i]]).tree) {
      if (tree >= 0) ++of_tree[tree];
    }
  }
  double couplings = 0;
  for (int tree = 0; tree < m->ntree; ++tree) couplings += 1.0 * of_tree[tree] * of_tree[tree];
  return couplings > kMostCouplings;
}

Islands ReachedPart(const mjModel* m, const mjData* d, const Mobility& mobility,
                    const Outlook& outlook, const int* position, int count, Gathered& contacts,
                    ImpactTime& time, Scratch& scratch) {
  mjtNum* gap = scratch.Take<mjtNum>(count);
  mjtNum* speed = scratch.Take<mjtNum>(count);
  mjtNum fastest = 0;
  for (int i = 0; i < count; ++i) {
    const ContactPath path(m, d, Anchor(m, d, contacts, position[i]), outlook.motion);
    gap[i] = path.Gap(time.tau);
    speed[i] = std::max<mjtNum>(0, -path.GapRate(time.tau));
    fastest = std::max(fastest, speed[i]);
  }
  const int first = position[time.first];
  const mjtNum room = kOfRadius / ContactCurvature(m, d, *contacts.contact[first]);
  time.longest = room / std::max(kFastest * fastest, mjMINVAL);
  time.flight = std::min(time.flight, time.longest);
  time.horizon = std::min(time.horizon, time.longest);

  bool* begins = scratch.Take<bool>(contacts.count);
  bool* reached = scratch.Take<bool>(contacts.count);
  std::fill_n(begins, contacts.count, false);
  std::fill_n(reached, contacts.count, false);
  begins[first] = true;
  for (int i = 0; i < count; ++i) {
    const mjtNum distance = (kFastest * fastest + speed[i]) * time.longest;
    reached[position[i]] = position[i] == first || gap[i] <= distance;
  }
  return FindIslands(m, mobility, contacts.contact, begins, reached, contacts.count, scratch);
}

}  // namespace mujoco_impact::engine
