// SPDX-License-Identifier: Apache-2.0

#include "engine/record/visualize.h"

#include "engine/state/state.h"

namespace mujoco_impact::engine {

namespace {

void DrawArrow(const mjModel* m, const mjtNum from[3], const mjtNum force[3], mjvScene* scene) {
  if (scene->ngeom >= scene->maxgeom) return;
  mjvGeom* arrow = scene->geoms + scene->ngeom;
  mjv_initGeom(arrow, mjGEOM_NONE, nullptr, nullptr, nullptr, m->vis.rgba.contactforce);
  // the scale of MuJoCo's own contact forces
  const mjtNum scale = m->vis.map.force / m->stat.meanmass;
  mjtNum to[3];
  mju_addScl3(to, from, force, scale);
  const mjtNum width = m->vis.scale.forcewidth * m->stat.meansize;
  mjv_connector(arrow, mjGEOM_ARROW, width, from, to);
  arrow->category = mjCAT_DECOR;
  arrow->segid = scene->ngeom++;
}

// Part of the impulse that acts in the step that `compute` has looked at or, after mj_step has
// taken it, in that step.
mjtNum PartShown(const Header& header, const Pulse& pulse) {
  if (header.pending != 0) return pulse.delivered_next - pulse.delivered;
  if (pulse.serial <= 0 || header.clock != header.pushed_until) return 0;
  return pulse.delivered - pulse.delivered_last;
}

}  // namespace

void DrawPulses(const mjModel* m, mjData* d, const mjvOption* option, mjvScene* scene,
                int instance) {
  if (!option->flags[mjVIS_CONTACTFORCE]) return;
  const State state(m, d, instance);
  for (int i = 0; i < state.slots(); ++i) {
    const Pulse& pulse = state.pulse(i);
    const mjtNum part = PartShown(state.header(), pulse);
    if (part <= 0) continue;
    mjtNum from[3], force[3];
    mju_add3(from, d->xpos + 3 * BodyOf(m, pulse, 1), pulse.line_next.arm[1]);
    const mjtNum normal_force = part * pulse.scale_next * pulse.impulse / m->opt.timestep;
    Store(normal_force * PulseDirection(pulse), force);
    DrawArrow(m, from, force, scene);
  }
}

}  // namespace mujoco_impact::engine
