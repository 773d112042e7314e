// SPDX-License-Identifier: Apache-2.0
// What the impacts of a step have done to the kinematic trees so far.

#ifndef MUJOCO_IMPACT_ENGINE_RESOLVE_STRUCK_H_
#define MUJOCO_IMPACT_ENGINE_RESOLVE_STRUCK_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/foresee/gather.h"
#include "engine/island/island_system.h"
#include "engine/path/mobility.h"
#include "engine/path/motion.h"
#include "engine/state/state.h"

namespace mujoco_impact::engine {

class Struck {
 public:
  Struck(const mjModel* m, mjData* d, const Mobility& mobility, Scratch& scratch);

  // Until when each tree is taken by an impact, from the start of the step [s] (ntree).
  const mjtNum* busy() const { return busy_; }

  // The path of the round with the velocity that its impacts have left so far.
  const Motion& kicked() const { return kicked_; }

  // Velocity that new pulses will add after this step (nv), null if none will.
  mjtNum* owed() const { return owes_ ? owed_ : nullptr; }

  // Impacts that are added from now on belong to a round on this path.
  void BeginRound(const Motion& path);

  // Adds the impulse of a contact: what is delivered in this step, and the rest.
  void Add(const ContactRow& row, mjtNum delivered, mjtNum rest);

  // The same of a stop, tie i of those of an impact, and takes its trees until `end`.
  void AddStop(const Mobility& ties, int i, mjtNum delivered, mjtNum rest, mjtNum end);

  // Takes the trees that the contact moves until `end`.
  void TakeUntil(const ContactRow& row, mjtNum end);

  // Takes the trees of pulses under way until `end`.
  void TakeForPulses(const State& state, mjtNum end);

  // Whether an impact of this step has changed the velocity of one of the bodies of the contact.
  bool Moved(const mjContact& contact) const;

  // Whether a body struck in this round may reach an island before that closes at τ.
  bool MayReach(Gathered& contacts, const int* position, int count, mjtNum tau);

 private:
  template <typename Visit>
  void ForMoved(const ContactRow& row, Visit visit) const;
  void Mark(const Gathered& contacts, const int* position, int count, int mark);

  const mjModel* m_;
  mjData* d_;
  const Mobility& mobility_;
  mjtNum* busy_;
  int* mark_;  // (ntree)
  Motion kicked_;
  mjtNum* owed_;
  bool owes_ = false;
};

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_RESOLVE_STRUCK_H_
