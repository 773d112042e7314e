// SPDX-License-Identifier: Apache-2.0
// Contacts that MuJoCo's solver is to take for open in this step.
//
// A contact is ours down to its depth. Deeper, MuJoCo gives it rows of its solver, but while a
// pulse of ours presses there, the contact is still ours, and MuJoCo's must not push besides.
// Passive forces are computed after the rows are made and before their references are, so a row can
// be told then that its bodies are apart.

#ifndef MUJOCO_IMPACT_ENGINE_SILENCE_H_
#define MUJOCO_IMPACT_ENGINE_SILENCE_H_

#include <mujoco/mujoco.h>

#include "engine/ownership.h"
#include "engine/state.h"

namespace mujoco_impact::engine {

// Whether the contact is one of ours that overlaps deeper than its depth, so that it has rows.
inline bool IsTakenOver(const Ownership& ownership, const mjContact& contact) {
  return IsDeep(contact) && ownership.Owns(contact);
}

// Whether any pulse presses, or did a moment ago.
bool AnyPulsePresses(const State& state);

// Whether one between the geoms of the contact does.
bool HasPulse(const State& state, const mjContact& contact);

// Makes the solver see the contact as open, however fast it closes.
void Silence(mjData* d, int contact);

// Silences the contacts in which pulses press.
void SilencePressed(const mjModel* m, mjData* d, int instance, const State& state);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_SILENCE_H_
