// SPDX-License-Identifier: Apache-2.0
// How far an impact reaches: which contacts may take part in it.

#ifndef MUJOCO_IMPACT_ENGINE_RESOLVE_REACH_H_
#define MUJOCO_IMPACT_ENGINE_RESOLVE_REACH_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/foresee/gather.h"
#include "engine/foresee/outlook.h"
#include "engine/island/islands.h"
#include "engine/resolve/resolve.h"
#include "engine/scene/materials.h"

namespace mujoco_impact::engine {

// How far a body may get in an impact of this round: it may leave it at up to twice the speed of
// the fastest closing, and fly for as long as the law counts what follows as the same impact [m].
mjtNum ReachOfRound(const mjModel* m, const mjData* d, const Materials& materials,
                    const Outlook& outlook, mjtNum flight, Gathered& contacts);

// Whether the contacts of an island are too many for one problem of the law: most of them are then
// between bodies that others keep apart, for balls touch 12 others at most.
bool IsCrowded(const mjModel* m, mjData* d, const Gathered& contacts, const int* position,
               int count);

// The part of a crowded island that the impact which begins in it can reach while its bodies get no
// farther than a part of their radius, as one island; what closes later is an impact of its own.
// Shortens `time` accordingly.
Islands ReachedPart(const mjModel* m, const mjData* d, const Mobility& mobility,
                    const Outlook& outlook, const int* position, int count, Gathered& contacts,
                    ImpactTime& time, Scratch& scratch);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_RESOLVE_REACH_H_
