// SPDX-License-Identifier: Apache-2.0
// What an impact does at one contact.

#ifndef MUJOCO_IMPACT_ENGINE_ISLAND_IMPACT_H_
#define MUJOCO_IMPACT_ENGINE_ISLAND_IMPACT_H_

#include <mujoco/mujoco.h>

#include "engine/common/vector3.h"

namespace mujoco_impact::engine {

// An impulse of one contact and when it comes; times from the start of the step.
struct Impact {
  mjtNum impulse;      // P_k [N s]; 0: the contact takes no part
  mjtNum alpha;        // P_k over the impulse of the reference waveform [-]
  mjtNum onset;        // [s]
  mjtNum duration;     // W [s]
  mjtNum restitution;  // E of the waveform [-]
  mjtNum peak;         // largest force of the contact [N]; 0: that of the waveform
  mjtNum moment;       // ∫ t F dt [N s²], if the law knows it better than the waveform
  mjtNum loss;         // of kinetic energy, by the part of the impulse in that of the island [J]
  bool at_once;        // shorter than the step: deliver it whole, by its moment
  mjtNum closing;      // speed at which the contact closed; 0 or less: others closed it [m/s]
  Vector3 tangent;     // tangential impulse over P_k, on geom[1] (friction.h) [-]
};

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_ISLAND_IMPACT_H_
