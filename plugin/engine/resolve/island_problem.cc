// SPDX-License-Identifier: Apache-2.0

#include "engine/resolve/island_problem.h"

#include "law/hertz_contact.h"
#include "law/impact_law.h"

namespace mujoco_impact::engine {

IslandProblem MakeProblem(const mjModel* m, const Config& config, const IslandSystem& system,
                          const mjtNum* velocity, Tangents* tangents, Scratch& scratch) {
  const int n = system.size;
  IslandProblem problem{n,
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
  for (int k = 0; k < n; ++k) {
    const ContactRow& row = system.row[k];
    problem.closing_speed[k] = Dot(row.normal, row.driven) - RowTimes(m, row, velocity);
    problem.gap[k] = row.gap <= config.touch ? 0 : row.gap;
    problem.stiffness[k] = law::HertzStiffness(config.effective_modulus, row.curvature);
  }
  return problem;
}

}  // namespace mujoco_impact::engine
