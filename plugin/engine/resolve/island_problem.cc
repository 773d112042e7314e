// SPDX-License-Identifier: Apache-2.0

#include "engine/resolve/island_problem.h"

#include <algorithm>

#include "law/hertz_contact.h"
#include "law/impact_law.h"

namespace mujoco_impact::engine {

IslandProblem MakeProblem(const mjModel* m, const Config& config, const Materials& materials,
                          const IslandSystem& system, const mjtNum* velocity, Tangents* tangents,
                          Scratch& scratch) {
  const int n = system.size;
  IslandProblem problem{n,
                        scratch.Take<mjtNum>(n),
                        scratch.Take<mjtNum>(n),
                        scratch.Take<mjtNum>(n),
                        scratch.Take<mjtNum>(n),
                        scratch.Zeros(n),
                        scratch.Zeros(n),
                        scratch.Zeros(n),
                        scratch.Zeros(n),
                        scratch.Zeros(n),
                        scratch.Take<mjtNum>(n),
                        {scratch.Take<mjtNum>(law::ImpactNumbers(n, tangents != nullptr)),
                         scratch.Take<int>(law::ImpactIndices(n))},
                        tangents};
  mjtNum fastest = 0;
  for (int k = 0; k < n; ++k) {
    const ContactRow& row = system.row[k];
    mjtNum& closing = problem.closing_speed[k];
    closing = Dot(row.normal, row.driven) - RowTimes(m, row, velocity);
    problem.gap[k] = row.gap <= config.touch ? 0 : row.gap;
    problem.stiffness[k] =
        law::HertzStiffness(materials.EffectiveModulus(*row.contact), row.curvature);
    if (problem.gap[k] == 0) fastest = std::max(fastest, closing);
  }
  for (int k = 0; k < n; ++k) {
    const mjtNum speed = std::max(fastest, problem.closing_speed[k]);
    problem.restitution[k] = config.law == Law::kHertz
                                 ? materials.Restitution(*system.row[k].contact, speed)
                                 : config.waveform_restitution;
  }
  return problem;
}

}  // namespace mujoco_impact::engine
