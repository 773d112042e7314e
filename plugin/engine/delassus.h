// SPDX-License-Identifier: Apache-2.0
// The Delassus matrix of an island, from its rows.

#ifndef MUJOCO_IMPACT_ENGINE_DELASSUS_H_
#define MUJOCO_IMPACT_ENGINE_DELASSUS_H_

#include <mujoco/mujoco.h>

#include "engine/island_system.h"
#include "engine/mobility.h"
#include "engine/scratch.h"
#include "law/delassus.h"

namespace mujoco_impact::engine {

// Bytes of scratch for a matrix of `size` contacts with that many couplings, and degrees of freedom
// summed over their rows.
size_t DelassusBytes(const mjModel* m, const Mobility& mobility, int size, size_t couplings,
                     size_t dofs);

// W = J M̃⁻¹ Jᵀ in the form in which it is cheaper to multiply by; the rows must stay where they
// are.
law::DelassusMatrix BuildDelassus(const mjModel* m, const Mobility& mobility, const ContactRow* row,
                                  int size, Scratch& scratch);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_DELASSUS_H_
