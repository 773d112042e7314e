// SPDX-License-Identifier: Apache-2.0
// The energy that pulses under way will leave is kept while their lines of action turn.
//
// With R the impulses yet to come along the rows J, the bodies will end with v + M⁻¹JᵀR and the
// kinetic energy T_s = T(v + M⁻¹JᵀR): what the law decided. Delivering a part of R along J leaves
// T_s as it is. But bodies that slide past each other turn the lines to J', so that the same R
// would add or take energy,
//
//   D = T(v + M⁻¹JᵀR) − T(v + M⁻¹J'ᵀR) = (v + ½ M⁻¹(J + J')ᵀR)ᵀ (J − J')ᵀR
//
// per set of bodies that the pulses join. R is scaled by s = 1 + σ ≥ 0 with
//
//   a σ² + c σ = D,    a = ½ RᵀJ'M⁻¹J'ᵀR,    c = (v + M⁻¹J'ᵀR)ᵀJ'ᵀR
//
// (the root that vanishes with D; if there is none, the σ of the least energy). Energy that turning
// would add (D < 0) is not added. Energy that it would take (D > 0) is pressed into the contact,
// which gives e² of it back: all, if it is elastic. A law of ours: a rigid body has no such phase.
//
// Elastic bodies never have more than T_s before the end, for what is pressed into contacts is not
// negative. Where waveforms would have it otherwise, one pulse parts what another has yet to stop:
// then all that is left of that set comes in this step, and leaves T_s.

#ifndef MUJOCO_IMPACT_ENGINE_PULSES_SETTLED_ENERGY_H_
#define MUJOCO_IMPACT_ENGINE_PULSES_SETTLED_ENERGY_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/deliver/deliver.h"
#include "engine/path/mobility.h"
#include "engine/state/state.h"

namespace mujoco_impact::engine {

// Finds the lines of this step of all pulses under way and scales what they have yet to deliver.
// Both are left pending in the pulses.
void FollowLines(const mjModel* m, const mjData* d, const Mobility& mobility, State& state,
                 Scratch& scratch);

// Once the impacts of the step are known: delivers all that is left of the sets that would
// otherwise end the step with more energy than they are to leave.
void EndOverfullByImpacts(const mjModel* m, mjData* d, const Mobility& ties, State& state,
                          const Delivery& delivery, Scratch& scratch);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_PULSES_SETTLED_ENERGY_H_
