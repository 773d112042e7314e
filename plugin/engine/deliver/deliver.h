// SPDX-License-Identifier: Apache-2.0
// Delivers pulses: what they exert in this step, independent of the size of the step.
//
// With I(t) the part of the pulse delivered by time t, the force of a step is the exact average
// P (I(t + h) − I(t)) / h, so the total impulse is P for every h. The integrator moves the bodies
// as if that impulse had come at the fraction a of the step (motion.h); the position correction
//
//   Δq = M⁻¹ Jᵀ (a h ΔP − M₁)        M₁ = ∫ s F(s) ds over the step, s from its start
//
// puts them where the pulse's own timing puts them. Joint damping that is treated implicitly acts
// on the displacement the integrator made, Δq short of the true one; the force −B Δq/h makes up for
// it.

#ifndef MUJOCO_IMPACT_ENGINE_DELIVER_DELIVER_H_
#define MUJOCO_IMPACT_ENGINE_DELIVER_DELIVER_H_

#include <mujoco/mujoco.h>

#include <algorithm>

#include "engine/common/scratch.h"
#include "engine/path/mobility.h"
#include "engine/path/weight_gradient.h"
#include "engine/state/state.h"

namespace mujoco_impact::engine {

// Generalized sums over the pulses of a step (nv each).
struct Delivery {
  mjtNum* impulse;    // Σ Jᵀ ΔP
  mjtNum* moment;     // Σ Jᵀ M₁
  mjtNum* second;     // Σ Jᵀ M₂, M₂ = M₁²/ΔP: second moment of an impulse at one time
  mjtNum* remaining;  // Σ Jᵀ P (1 − delivered), of the pulses under way at the start of the step
};

Delivery MakeDelivery(const mjModel* m, Scratch& scratch);

// Sums over the impulses that came where the inertia was another than at the start of the step
// (nv each), with that inertia.
struct Kicks {
  mjtNum* velocity;  // Σ M⁻¹Jᵀ ΔP
  mjtNum* moment;    // Σ M⁻¹Jᵀ M₁
  mjtNum* second;    // Σ M⁻¹Jᵀ M₂
  bool any;
};

Kicks MakeKicks(const mjModel* m, Scratch& scratch);

// Adds the impulses that cause the kicks at the start of the step: M ΔV.
void AddKicks(const mjModel* m, const mjData* d, const Kicks& kicks, const Delivery& delivery,
              Scratch& scratch);

// Adds impulses that came within the step.
void AddTo(const mjModel* m, const Delivery& within, Delivery& delivery);

// Part of a pulse and its first moment in one step.
struct Share {
  mjtNum impulse;         // ΔP [N s]
  mjtNum moment;          // M₁ [N s²]
  mjtNum delivered_next;  // part delivered by the end of the step
};

// What a pulse exerts in the step of length h that starts at `clock`.
Share ShareOfStep(const Pulse& pulse, mjtNum clock, mjtNum h);

// As of an impulse at one time, in or about the step: where dents are pressed out (overlap.h) a
// push that is rounding may move bodies, and has no such time.
inline mjtNum SecondMoment(const Share& share, mjtNum h) {
  if (share.impulse <= 0) return 0;
  const mjtNum time = std::clamp(share.moment / share.impulse, -h, 4 * h);
  return time * time * share.impulse;
}

// What sleeps feels no force: when the step is committed, an impulse sets its velocity, which wakes
// it, and Δq = M⁻¹ Jᵀ (h ΔP − M₁) is all of its way. `force` is what Apply left in the state.
void WakeStruck(const mjModel* m, mjData* d, const mjtNum* force, Scratch& scratch);

// Puts the sums into qfrc_passive and leaves the position correction pending in the state.
void Apply(const mjModel* m, mjData* d, const Mobility& mobility, State& state,
           const Delivery& delivery, Scratch& scratch);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_DELIVER_DELIVER_H_
