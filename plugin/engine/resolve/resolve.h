// SPDX-License-Identifier: Apache-2.0
// Asks the law for the impulses of an island and turns them into pulses.

#ifndef MUJOCO_IMPACT_ENGINE_RESOLVE_RESOLVE_H_
#define MUJOCO_IMPACT_ENGINE_RESOLVE_RESOLVE_H_

#include <mujoco/mujoco.h>

#include "engine/common/vector3.h"
#include "engine/island/impact.h"
#include "engine/island/island_system.h"
#include "engine/resolve/budget.h"
#include "engine/scene/config.h"
#include "engine/scene/ownership.h"

namespace mujoco_impact::engine {

struct Tangents;

struct ImpactTime {
  mjtNum start;     // of the path, from the start of the step [s]
  mjtNum tau;       // when the first contact of the island closes, from there [s]
  mjtNum timestep;  // h [s]
  mjtNum flight;    // contacts that close after a longer flight are left for later [s]
  mjtNum horizon;   // as are those that begin to close later than this after τ [s]
  mjtNum longest;   // flight, whatever the law takes for the same impact [s]
  int first;        // which contact of the island that is
  mjtNum short_of;  // pulses of a Hertz contact that are shorter come at once [s]
  mjtNum seen;      // how long after τ the bodies are where their inertia and speeds were taken [s]

  mjtNum left() const { return timestep - start - tau; }  // of the step
};

// m of the body that comes in at contact k: effective mass along the normal of the one that closes
// faster, of both together if neither does [kg].
mjtNum IncomingMass(const mjModel* m, const IslandSystem& system, int k, const mjtNum* velocity);

// `stiffer` is the least λ of the step so far: bodies that had to be stiffer in one round, y ~ λ,
// begin so in the next. `velocity` is what the bodies have at τ when all pulses under way have been
// delivered, `acceleration` what other forces give them meanwhile (nv). `tangents` are those of the
// system, null without friction; `impacts` has room for system.size.
void ResolveIsland(const mjModel* m, const Config& config, const Ownership& ownership,
                   const IslandSystem& system, const ImpactTime& time, const mjtNum* velocity,
                   const mjtNum* acceleration, Tangents* tangents, Budget& budget, mjtNum* stiffer,
                   Impact* impacts, Scratch& scratch);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_RESOLVE_RESOLVE_H_
