// SPDX-License-Identifier: Apache-2.0
// What an island looks like to the laws, and what they say about it. Times are from the closing of
// its first contact on.

#ifndef MUJOCO_IMPACT_ENGINE_RESOLVE_ISLAND_PROBLEM_H_
#define MUJOCO_IMPACT_ENGINE_RESOLVE_ISLAND_PROBLEM_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/island/island_system.h"
#include "engine/island/tangents.h"
#include "engine/scene/materials.h"
#include "law/impact_problem.h"

namespace mujoco_impact::engine {

struct IslandProblem {
  int size;
  mjtNum* closing_speed;  // c_k [m/s]
  mjtNum* gap;            // g_k [m]
  mjtNum* stiffness;      // K_k [N/m^1.5]
  mjtNum* restitution;    // e_k of the law; afterwards E of the waveforms [-]
  mjtNum* impulse;        // P_k [N s]; 0: the contact takes no part
  mjtNum* moment;         // ∫ t F_k dt [N s²]
  mjtNum* onset;          // first time with force [s]
  mjtNum* duration;       // W_k [s], where P_k > 0
  mjtNum* peak;           // largest F_k [N]; 0: that of the waveform
  mjtNum* after;          // separation speeds
  law::Workspace work;
  Tangents* tangents = nullptr;  // null: no contact has friction
};

// Restitution is that at the speed of the fastest closing of the contacts that touch: a contact
// that others press does not close by itself. One that has yet to touch may close faster, and
// later, or not at all: its speed is its own alone.
IslandProblem MakeProblem(const mjModel* m, const Config& config, const Materials& materials,
                          const IslandSystem& system, const mjtNum* velocity, Tangents* tangents,
                          Scratch& scratch);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_RESOLVE_ISLAND_PROBLEM_H_
