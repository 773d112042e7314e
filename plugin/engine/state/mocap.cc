// SPDX-License-Identifier: Apache-2.0

#include "engine/state/mocap.h"

#include <algorithm>

#include "engine/scene/ownership.h"
#include "engine/state/state.h"

namespace mujoco_impact::engine {

namespace {

// Widest of the geoms that the body carries [m]; a plane has no width, and the scene takes its
// place.
mjtNum SizeOf(const mjModel* m, int mocap) {
  mjtNum size = 0;
  for (int geom = 0; geom < m->ngeom; ++geom) {
    if (MocapOf(m, m->geom_bodyid[geom]) != mocap) continue;
    const mjtNum radius = m->geom_rbound[geom];
    size = std::max(size, radius > 0 ? 2 * radius : m->stat.extent);
  }
  return size;
}

bool Touches(const mjModel* m, const mjData* d, const Ownership& ownership, int mocap) {
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    if (!IsOffered(contact) || !ownership.Owns(contact)) continue;
    for (const int geom : contact.geom) {
      if (MocapOf(m, m->geom_bodyid[geom]) == mocap) return true;
    }
  }
  return false;
}

void Warn(const mjModel* m, int body) {
  const char* name = mj_id2name(m, mjOBJ_BODY, body);
  mju_warning(
      "mujoco_impact.waveform: the mocap body '%s' (%d) went farther than its size in one step, so "
      "it strikes as if it were still; move it in smaller steps to strike with its velocity",
      name ? name : "", body);
}

void FindVelocity(const mjModel* m, const mjData* d, int mocap, MocapRecord& record) {
  constexpr mjtNum kMostTurn = 1;  // [rad]
  const mjtNum rate = 1 / m->opt.timestep;
  mjtNum quaternion[4], turn[3];
  mju_copy4(quaternion, d->mocap_quat + 4 * mocap);
  mju_normalize4(quaternion);
  // the rotation from then to now, in the frame of then
  mju_subQuat(turn, quaternion, record.quaternion);
  mju_rotVecQuat(turn, turn, record.quaternion);
  const Vector3 shift = Load(d->mocap_pos + 3 * mocap) - Load(record.position);
  const mjtNum distance = Norm(shift);
  // no number of a damaged state is less than any
  const bool near = distance == 0 || distance <= SizeOf(m, mocap);
  record.jumped = !(near && mju_norm3(turn) <= kMostTurn);
  const bool jumped = record.jumped != 0;
  // not by a factor of zero, which a number that is none survives
  Store(jumped ? Vector3{} : rate * shift, record.linear);
  Store(jumped ? Vector3{} : rate * Load(turn), record.angular);
}

}  // namespace

void FindMocapVelocities(const mjModel* m, const mjData* d, int instance, State& state) {
  for (int body = 1; body < m->nbody; ++body) {
    const int mocap = m->body_mocapid[body];
    if (mocap < 0) continue;
    MocapRecord& record = state.mocap()[mocap];
    record.jumped = 0;
    if (record.known == 0) {
      Store(Vector3{}, record.linear);
      Store(Vector3{}, record.angular);
      continue;
    }
    FindVelocity(m, d, mocap, record);
    if (record.jumped == 0 || record.warned != 0) continue;
    if (Touches(m, d, Ownership(m, instance), mocap)) {
      Warn(m, body);
    } else {
      record.jumped = 0;
    }
  }
}

void CommitMocap(const mjModel* m, const mjData* d, State& state) {
  for (int mocap = 0; mocap < m->nmocap; ++mocap) {
    MocapRecord& record = state.mocap()[mocap];
    mju_copy3(record.position, d->mocap_pos + 3 * mocap);
    mju_copy4(record.quaternion, d->mocap_quat + 4 * mocap);
    mju_normalize4(record.quaternion);
    record.known = 1;
    if (record.jumped != 0) record.warned = 1;
  }
}

void MoveMocap(const mjModel* m, mjData* d, const MocapRecord* records, mjtNum t) {
  for (int mocap = 0; mocap < m->nmocap; ++mocap) {
    const MocapRecord& record = records[mocap];
    mju_addToScl3(d->mocap_pos + 3 * mocap, record.linear, t);
    // the rate is in the frame of the world, mju_quatIntegrate takes that of the body
    mjtNum inverse[4], local[3];
    mju_normalize4(d->mocap_quat + 4 * mocap);
    mju_negQuat(inverse, d->mocap_quat + 4 * mocap);
    mju_rotVecQuat(local, record.angular, inverse);
    mju_quatIntegrate(d->mocap_quat + 4 * mocap, local, t);
  }
}

}  // namespace mujoco_impact::engine
