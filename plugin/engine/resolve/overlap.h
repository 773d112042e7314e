// SPDX-License-Identifier: Apache-2.0
// How deep bodies overlap because an impact takes time, against how deep they may.
//
// A contact is ours down to the depth M, and below it while a pulse presses (silence.h). What shows
// of an impact at the ends of steps is kept within half of M, or of an overlap that does not matter
// to where bodies are, if that is more: 8 % of 1/(1/R₁ + 1/R₂). A compression is kept within what
// can be called the touching of two bodies at a point. The functions that say less return
// the λ ≤ 1 by which overlaps, and with them the times of the impact, must be smaller.

#ifndef MUJOCO_IMPACT_ENGINE_RESOLVE_OVERLAP_H_
#define MUJOCO_IMPACT_ENGINE_RESOLVE_OVERLAP_H_

#include <mujoco/mujoco.h>

#include "engine/island/island_system.h"
#include "engine/resolve/island_problem.h"
#include "engine/scene/config.h"

namespace mujoco_impact::engine {

// When the last pulse is over [s].
mjtNum EndOf(const IslandProblem& problem);

// For what closes at once, each contact by itself: an estimate before the law is asked.
mjtNum CloseLess(const IslandSystem& system, const IslandProblem& problem);

// For normals that turn while the pulses last: their impulses act along those of the onset.
mjtNum TurnLess(const IslandSystem& system, const IslandProblem& problem);

// For overlaps while the pulses last, y(t) = c t − g − W ∫∫ F of their waveforms. Two waveforms
// that press a light body from both sides are not the forces of the contacts, which would follow
// it.
mjtNum OverlapLess(const mjModel* m, const Config& config, const IslandSystem& system,
                   const IslandProblem& problem);

// Takes out of the moments what contacts that lost energy are left pressed at time t, for they do
// not expand as far as they were pressed: within half of M, so that they are not MuJoCo's then.
// Only positions change, and the common centre of mass stays where it is.
void PressOutDents(const IslandSystem& system, IslandProblem& problem, mjtNum t);

// Whether bodies overlap no deeper than that after the `time` left of the step if all impulses are
// delivered in it: each body is then put on the path that it will have when the impact is over.
bool MayComeAtOnce(const mjModel* m, const IslandSystem& system, const IslandProblem& problem,
                   mjtNum time);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_RESOLVE_OVERLAP_H_
