// SPDX-License-Identifier: Apache-2.0
// The work that the impacts of a step may do.
//
// It is counted, in units of about a nanosecond, never timed: the same state gives the same step
// on any machine. All rounds, trials and steps of the law of a step share one budget, which is in
// proportion to what the scene costs MuJoCo itself. When it runs out, everything that still closes
// is ended at once (law/short_end.h).

#ifndef MUJOCO_IMPACT_ENGINE_RESOLVE_BUDGET_H_
#define MUJOCO_IMPACT_ENGINE_RESOLVE_BUDGET_H_

#include <mujoco/mujoco.h>

#include <algorithm>

#include "engine/foresee/gather.h"
#include "engine/island/island_system.h"

namespace mujoco_impact::engine {

class Budget {
 public:
  Budget(const mjModel* m, bool elastic, bool friction, const Gathered& contacts);

  void Spend(double work) { spent_ += work; }
  // What was spent, over what may be: more than 1 where the last round had to be ended.
  double part() const { return spent_ / total_; }

  // What one solution of the law may take, and its end besides, so that whatever comes later in the
  // step has a share.
  double OfLaw() const { return 0.7 * left(); }
  double OfEnd() const { return 0.2 * left(); }

  // Whether the round that begins must be the last.
  bool IsLow() const { return left() < 0.25 * total_; }

  // Whether no island must be looked at any more.
  bool IsSpent() const { return left() <= 0; }

  // What it costs to move the bodies to another time and to look at the contacts there, and to make
  // the rows of one that takes part in an impact.
  void SpendRound(const mjModel* m, const Gathered& contacts);
  void SpendRow(const mjModel* m, const ContactRow& row, int directions);

  // What it costs to ask the narrow phase where so many pairs of geoms touch.
  void SpendPairs(int pairs) { Spend(1e4 * pairs); }

 private:
  // Without what the rows of a last round may take.
  double left() const {
    return std::max(0.0, total_ - spent_ - std::max(for_rows_, most_for_rows_));
  }

  double total_ = 0, spent_ = 0;
  double for_rows_ = 0, most_for_rows_ = 0;  // of this round, and of the dearest one before
};

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_RESOLVE_BUDGET_H_
