// SPDX-License-Identifier: Apache-2.0

#include <algorithm>

#include "engine/resolve/resolver.h"

namespace mujoco_impact::engine {

// Whether other stops hold against these impacts than were held for them.
bool Resolver::ChangesStops(const Outlook& outlook, const ImpactTime& time,
                            const IslandSolution& island) {
  if (!stops_.Any()) return false;
  Scratch scratch(d_);
  mjtNum* change = scratch.Zeros(static_cast<int>(m_->nv));
  mjtNum end = time.start + time.tau;
  bool at_once = true;
  for (int k = 0; k < island.system.size; ++k) {
    const Impact& impact = island.impacts[k];
    if (impact.impulse <= 0) continue;
    AddUntied(m_, island.system.row[k].segment, impact.impulse, change);
    end = std::max(end, impact.onset + impact.duration);
    at_once = at_once && impact.at_once;
  }
  mobility_.Tie(change);
  const mjtNum* velocity = SettledVelocity(m_, outlook, there_ ? 0 : time.tau, scratch);
  double work = 0;
  const bool changes =
      stops_.FindHeld(mobility_, velocity, change, end - time.start - time.tau, at_once, &work);
  budget_.Spend(work);
  if (changes) return true;
  stops_.NoteStruck(velocity, change);
  return false;
}

// Adds the impulses of the stops that hold against those of the contacts.
void Resolver::AddStops(const IslandSolution& island, const ImpactTime& time, const Share* shares,
                        mjtNum end) {
  const Mobility& mobility = island.mobility;
  const int nv = static_cast<int>(m_->nv), ties = mobility.ties();
  if (mobility.stops() == 0) return;
  Scratch scratch(d_);
  // what the contacts deliver in this step, its moment, and what is left
  mjtNum* pull[3];
  for (int of = 0; of < 3; ++of) {
    mjtNum* kick = scratch.Zeros(nv);
    for (int k = 0; k < island.system.size; ++k) {
      const mjtNum parts[] = {shares[k].impulse, shares[k].moment,
                              island.impacts[k].impulse - shares[k].impulse};
      AddUntied(m_, island.system.row[k].segment, parts[of], kick);
    }
    mobility.Tie(kick, pull[of] = scratch.Take<mjtNum>(ties));
  }
  for (int i = ties - mobility.stops(); i < ties; ++i) {
    const Share share{pull[0][i], pull[1][i], 1};
    mobility.ForTrees(i, [&](int tree, int begin) {
      AddShare({tree, mobility.row(i) + begin, mobility.answer(i) + begin}, time, share);
    });
    struck_.AddStop(mobility, i, share.impulse, pull[2][i], end);
  }
}

}  // namespace mujoco_impact::engine
