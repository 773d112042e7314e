// SPDX-License-Identifier: Apache-2.0
// The Delassus matrix of an island, from its rows.

#ifndef MUJOCO_IMPACT_ENGINE_ISLAND_DELASSUS_H_
#define MUJOCO_IMPACT_ENGINE_ISLAND_DELASSUS_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/island/island_system.h"
#include "engine/path/mobility.h"
#include "law/delassus.h"

namespace mujoco_impact::engine {

// Sums over the bodies of an island, tied ones together: the squares of their numbers of contacts,
// and for each contact the degrees of freedom of its bodies.
struct DelassusSize {
  size_t couplings, dofs;
};

// Whether the matrix of such an island is kept by bodies, not in compressed rows.
bool IsByBody(const DelassusSize& size);

// Degrees of freedom of each tree, or of all trees that are tied to it at the one that stands for
// them (ntree); `offset`, unless null, gets where each tree begins among them.
int* GroupDofs(const mjModel* m, const Mobility& mobility, int* offset, Scratch& scratch);

// Bytes of scratch for the matrix of so many contacts.
size_t DelassusBytes(const mjModel* m, const Mobility& mobility, int contacts,
                     const DelassusSize& size);

// W = J M̃⁻¹ Jᵀ in the form in which it is cheaper to multiply by; the rows must stay where they
// are.
law::DelassusMatrix BuildDelassus(const mjModel* m, const Mobility& mobility, const ContactRow* row,
                                  int size, Scratch& scratch);

// Further rows by bodies: two parts each, in their order.
law::BodyRow* RowParts(const mjModel* m, const Mobility& mobility, const RowSegment* const* rows,
                       int number, Scratch& scratch);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_ISLAND_DELASSUS_H_
