// SPDX-License-Identifier: Apache-2.0

#include "engine/pulses/line_of_action.h"

#include "engine/path/point.h"

namespace mujoco_impact::engine {

namespace {

int GeomOf(const Pulse& pulse, int side) { return static_cast<int>(pulse.geom[side]); }

// The line of centres of two spheres; otherwise, or without one, as it was.
Vector3 NormalNow(const mjModel* m, const mjData* d, const Pulse& pulse) {
  const Vector3 before = Load(pulse.line.normal);
  const int first = GeomOf(pulse, 0), second = GeomOf(pulse, 1);
  if (!IsSphere(m, first) || !IsSphere(m, second)) return before;
  return UnitOr(Load(d->geom_xpos + 3 * second) - Load(d->geom_xpos + 3 * first), before);
}

}  // namespace

LineOfAction LineNow(const mjModel* m, const mjData* d, const Pulse& pulse) {
  LineOfAction line;
  const Vector3 normal = NormalNow(m, d, pulse);
  Store(normal, line.normal);
  for (int side = 0; side < 2; ++side) {
    const int body = BodyOf(m, pulse, side);
    const Vector3 centre = Load(d->xpos + 3 * body);
    const Vector3 then = centre + Rotate(d->xmat + 9 * body, Load(pulse.point[side]));
    const Vector3 outward = (side == 0 ? 1 : -1) * normal;
    Store(PointWithNormal(m, d, GeomOf(pulse, side), then, outward) - centre, line.arm[side]);
  }
  return line;
}

void AddPulseRow(const mjModel* m, const mjData* d, const Pulse& pulse, const LineOfAction& line,
                 mjtNum s, mjtNum* row) {
  const Vector3 normal = Load(line.normal);
  for (int side = 0; side < 2; ++side) {
    const int body = BodyOf(m, pulse, side);
    const int last = LastDof(m, body);
    if (last < 0) continue;
    BodyPoint point{body, Load(d->xpos + 3 * body) + Load(line.arm[side])};
    mjtNum* segment = row + m->tree_dofadr[m->dof_treeid[last]];
    const mjtNum sign = side == 0 ? -s : s;
    AddRow(m, d, point, normal, sign, segment);
    if (!pulse.slides()) continue;
    // friction acts where the surfaces touch
    point.position = SurfacePoint(m, GeomOf(pulse, side), side, point.position, normal);
    AddRow(m, d, point, Load(pulse.tangent), sign, segment);
  }
}

}  // namespace mujoco_impact::engine
