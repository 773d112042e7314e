// SPDX-License-Identifier: Apache-2.0

#include "engine/resolve/friction.h"

#include <algorithm>
#include <cmath>

#include "engine/island/tangents.h"
#include "law/friction.h"

namespace mujoco_impact::engine {

namespace {

// The velocity with which side 0 slides over side 1 at τ, that of mocap bodies included.
Vector3 SlipVelocity(const mjModel* m, const mjData* d, const ContactRow& row, const Motion& motion,
                     mjtNum tau, const mjtNum* velocity, SlipRow& slip) {
  Vector3 result{};
  for (const Vector3& axis : TangentsOf(row.normal).axis) {
    FillSlipRow(m, d, row, motion, tau, axis, slip);
    result += (Dot(row.driven, axis) - SegmentsTimes(m, slip.segment, velocity)) * axis;
  }
  return result;
}

// x += Jᵀ s of a row.
void AddForce(const mjModel* m, const RowSegment segments[2], mjtNum s, mjtNum* x) {
  for (int i = 0; i < 2; ++i) {
    const auto& [tree, jacobian, inverse_inertia] = segments[i];
    if (tree >= 0) mju_addToScl(x + m->tree_dofadr[tree], jacobian, s, m->tree_dofnum[tree]);
  }
}

// Fills `slip` with the row of ρ t and returns ρ t; zero without friction.
Vector3 SlipOf(const mjModel* m, const mjData* d, const Config& config, const IslandSystem& system,
               int k, const Motion& motion, mjtNum tau, const mjtNum* velocity, mjtNum impulse,
               SlipRow& slip) {
  const ContactRow& row = system.row[k];
  const Vector3 u = SlipVelocity(m, d, row, motion, tau, velocity, slip);
  const mjtNum speed = Norm(u);
  if (speed < mjMINVAL) return {};
  const mjtNum mass = IncomingMass(m, system, k, velocity);
  const mjtNum closing =
      std::max<mjtNum>(0, Dot(row.normal, row.driven) - RowTimes(m, row, velocity));
  const mjtNum friction =
      law::FrictionImpulse(config.paper_friction, mass * closing, mass * speed, impulse);
  if (friction <= 0) return {};
  const Vector3 tangent = friction / (impulse * speed) * u;
  FillSlipRow(m, d, row, motion, tau, tangent, slip);
  SolveSegments(m, d, slip.segment);
  return tangent;
}

}  // namespace

void AddFriction(const mjModel* m, const mjData* d, const Config& config, const Motion& motion,
                 mjtNum tau, const mjtNum* velocity, IslandSystem& system, Impact* impacts,
                 Scratch& scratch) {
  const int nv = static_cast<int>(m->nv);
  SlipRow* slip = scratch.Take<SlipRow>(system.size);
  mjtNum* after = scratch.Take<mjtNum>(nv);  // velocity after the normal impulses
  mjtNum* force = scratch.Zeros(nv);         // f
  mjtNum* kick = scratch.Zeros(nv);          // M⁻¹ f
  mjtNum driven = 0;                         // Σ of the work of mocap bodies on f
  mju_copy(after, velocity, nv);
  for (int k = 0; k < system.size; ++k) {
    const mjtNum P = impacts[k].impulse;
    if (P <= 0) continue;
    slip[k] = MakeSlipRow(m, system.row[k], scratch);
    AddUntied(m, system.row[k].segment, P, after);
    impacts[k].tangent = SlipOf(m, d, config, system, k, motion, tau, velocity, P, slip[k]);
    if (Norm(impacts[k].tangent) == 0) continue;
    AddForce(m, slip[k].segment, P, force);
    AddUntied(m, slip[k].segment, P, kick);
    driven += P * Dot(impacts[k].tangent, system.row[k].driven);
  }
  mjtNum scale = 1;
  if (config.passive) {
    const mjtNum linear = driven - mju_dot(force, after, nv);
    const mjtNum quadratic = mju_dot(force, kick, nv);
    if (quadratic <= 0) return;
    scale = std::clamp<mjtNum>(2 * linear / quadratic, 0, 1);
  }
  for (int k = 0; k < system.size; ++k) {
    if (impacts[k].impulse <= 0 || Norm(impacts[k].tangent) == 0) continue;
    impacts[k].tangent = scale * impacts[k].tangent;
    for (int i = 0; i < 2; ++i) {
      const RowSegment& row = system.row[k].segment[i];
      if (row.tree < 0) continue;
      const int dofs = m->tree_dofnum[row.tree];
      mju_addToScl(row.jacobian, slip[k].segment[i].jacobian, scale, dofs);
      mju_addToScl(row.inverse_inertia, slip[k].segment[i].inverse_inertia, scale, dofs);
    }
  }
}

}  // namespace mujoco_impact::engine
