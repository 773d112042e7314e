// SPDX-License-Identifier: Apache-2.0
// The impacts of a step, as they are found: one round after the other (impacts.cc), each of one or
// more islands (island_impact.cc).

#ifndef MUJOCO_IMPACT_ENGINE_RESOLVE_RESOLVER_H_
#define MUJOCO_IMPACT_ENGINE_RESOLVE_RESOLVER_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/deliver/deliver.h"
#include "engine/deliver/flights.h"
#include "engine/foresee/gather.h"
#include "engine/foresee/outlook.h"
#include "engine/island/impact.h"
#include "engine/island/island_system.h"
#include "engine/island/islands.h"
#include "engine/path/mobility.h"
#include "engine/path/stops.h"
#include "engine/resolve/budget.h"
#include "engine/resolve/resolve.h"
#include "engine/resolve/struck.h"
#include "engine/scene/config.h"
#include "engine/scene/ownership.h"
#include "engine/state/state.h"

namespace mujoco_impact::engine {

// The contacts of an island with the stops that hold, and their impacts.
struct IslandSolution {
  Mobility mobility;
  IslandSystem system;
  Impact* impacts;
};

class Resolver {
 public:
  Resolver(const mjModel* m, mjData* d, int instance, const Mobility& mobility, const mjtNum* kick,
           State& state, Delivery& delivery, Scratch& scratch);

  void Run();

  const Flights& flights() const { return flights_; }

 private:
  // Rounds (impacts.cc).
  void RunRounds();
  void ResolveRound(Outlook& outlook);
  void ResolveIslands(const Outlook& outlook, const Islands& islands, const ImpactTime* times,
                      const int* order);
  Islands FindRound(const Outlook& outlook, Scratch& scratch);
  bool IsOnPath(const int* position, int count) const;
  bool Approach(Outlook& outlook, const ImpactTime& time, const int* position, int count);
  bool MoreMayClose(const Outlook& outlook);
  void AnchorAll();

  // Islands (island_impact.cc).
  ImpactTime FirstClosing(const Outlook& outlook, const int* position, int count) const;
  bool HasArms(const int* position, int count) const;
  void GoToCentre(Outlook& outlook, const ImpactTime& time, const int* position, int count);
  void ResolveFirstOf(const Outlook& outlook, ImpactTime time, const int* position, int count);
  bool ResolveIslandOf(const Outlook& outlook, ImpactTime time, const int* position, int count);
  template <typename Use>
  bool SolveIsland(const Outlook& outlook, const ImpactTime& time, const int* position, int count,
                   Use use);
  bool FitsIsland(const int* position, int count);
  IslandSolution TryIsland(const Outlook& outlook, ImpactTime time, const int* position, int count,
                           Scratch& scratch);
  mjtNum CentreOf(const Outlook& outlook, const ImpactTime& time, const int* position, int count);
  bool AnyFlies(const IslandSystem& system) const;
  void HoldUp(const Mobility& mobility, const IslandSystem& system, const int* position,
              mjtNum time, mjtNum* velocity);
  static void ComeAtOnce(const ImpactTime& time, int count, Impact* impacts);
  void AddImpacts(const IslandSolution& island, const ImpactTime& time, const int* position);
  Share AddImpact(const ContactRow& row, const ImpactTime& time, const Impact& impact);
  void AddShare(const RowSegment& segment, const ImpactTime& time, const Share& share);

  // Stops (island_stops.cc).
  bool ChangesStops(const Outlook& outlook, const ImpactTime& time, const IslandSolution& island);
  void AddStops(const IslandSolution& island, const ImpactTime& time, const Share* shares,
                mjtNum end);

  const mjModel* m_;
  mjData* d_;
  const Ownership ownership_;
  const Config config_;
  const Mobility& mobility_;
  State& state_;
  Delivery& delivery_;
  Scratch& scratch_;
  const bool bent_;         // pulses under way last on and bend the path
  const Delivery impacts_;  // what comes at times within the step
  Kicks kicks_;
  Gathered contacts_;
  Budget budget_;
  Struck struck_;
  const Outlook start_;
  Flights flights_;
  Stops stops_;
  const mjtNum* steady_;  // what gravity and other forces do to the velocities (nv)
  BodiesInStep bodies_;
  const mjtNum* path_velocity_ = nullptr;  // of the outlook of the round (nv)
  bool there_ = false;  // the bodies are where the impact at hand begins, and so is their inertia
  bool last_ = false;   // no further round is possible
  mjtNum stiffer_ = 1;  // λ of the bodies in this step
  mjtNum flight_ = 0;
  mjtNum round_end_ = 0;  // when the first impact of the round is over
  mjtNum left_ = 0;       // when the first contact closes that took no part in it
};

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_RESOLVE_RESOLVER_H_
