// SPDX-License-Identifier: Apache-2.0

#include "engine/foresee/step_memory.h"

#include "engine/foresee/gather.h"
#include "engine/foresee/narrow_phase.h"
#include "engine/scene/materials.h"

namespace mujoco_impact::engine {

bool StepFits(const mjModel* m, const mjData* d, const Scratch& scratch) {
  // at most this many vectors of the length of each, MuJoCo's own in the functions we call
  // included, and a factor of the inertia
  constexpr size_t kVectors = 84;
  const size_t numbers = m->nq + m->nv + m->nbody + m->ntree + m->nu + m->nmocap;
  // the points of other shapes are found again, and more of them
  size_t points = 0;
  bool asks = false;
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    const bool follows = contact.geom[0] < 0 || FollowsFromCentres(m, contact);
    points += follows ? 1 : 1 + kMorePoints;
    asks = asks || !follows;
  }
  const size_t vectors = (kVectors * numbers + 4 * m->nC + 10 * m->nbody) * sizeof(mjtNum);
  return scratch.Fits(vectors + MaterialBytes(m) + points * kGatheredBytes +
                      (asks ? NarrowPhaseBytes(m) : 0));
}

}  // namespace mujoco_impact::engine
