// SPDX-License-Identifier: Apache-2.0
// Groups contacts into islands: contacts that share a moving kinematic tree, directly or through
// other contacts, ties or limits of tendons. Only islands in which something closes are of
// interest.

#ifndef MUJOCO_IMPACT_ENGINE_ISLAND_ISLANDS_H_
#define MUJOCO_IMPACT_ENGINE_ISLAND_ISLANDS_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/path/mobility.h"
#include "engine/path/stops.h"

namespace mujoco_impact::engine {

// Contacts sorted by island, as positions in the list that was given.
struct Islands {
  int number;
  const int* start;     // (number + 1) into position
  const int* position;  // in the list of contacts
};

// `due[i]` says whether contacts[i] closes in this step, `near[i]` whether it takes part at all.
Islands FindIslands(const mjModel* m, const Mobility& mobility, const Stops& stops,
                    const mjContact* const* contacts, const bool* due, const bool* near, int count,
                    Scratch& scratch);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_ISLAND_ISLANDS_H_
