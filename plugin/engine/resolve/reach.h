// SPDX-License-Identifier: Apache-2.0
// How far an impact reaches: which contacts may take part in it.

#ifndef MUJOCO_IMPACT_ENGINE_RESOLVE_REACH_H_
#define MUJOCO_IMPACT_ENGINE_RESOLVE_REACH_H_

#include <mujoco/mujoco.h>

#include "engine/foresee/gather.h"
#include "engine/foresee/outlook.h"
#include "engine/scene/config.h"

namespace mujoco_impact::engine {

// How far a body may get in an impact of this round: it may leave it at up to twice the speed of
// the fastest closing, and fly for as long as the law counts what follows as the same impact [m].
mjtNum ReachOfRound(const mjModel* m, const mjData* d, const Config& config, const Outlook& outlook,
                    mjtNum flight, Gathered& contacts);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_RESOLVE_REACH_H_
