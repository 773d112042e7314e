// SPDX-License-Identifier: Apache-2.0

#include "engine/deliver/rigid_body.h"

#include <algorithm>
#include <cmath>

namespace mujoco_impact::engine {

namespace {

Vector3 Times(const mjtNum* matrix, const Vector3& v) { return Rotate(matrix, v); }

// Spin and rotation as one vector, and its rate.
struct Turning {
  mjtNum rotation[4];
  Vector3 spin;
};

Turning Rate(const RigidInertia& inertia, const Vector3& angular, const Turning& x) {
  Turning rate;
  // d/dt q = ½ q ⊗ (0, ω)
  const mjtNum pure[4] = {0, x.spin.x, x.spin.y, x.spin.z};
  mju_mulQuat(rate.rotation, x.rotation, pure);
  for (mjtNum& number : rate.rotation) number *= 0.5;
  rate.spin = GyroscopicRate(inertia, x.spin) + angular;
  return rate;
}

Turning Along(const Turning& x, mjtNum time, const Turning& rate) {
  Turning moved = x;
  for (int i = 0; i < 4; ++i) moved.rotation[i] += time * rate.rotation[i];
  moved.spin += time * rate.spin;
  return moved;
}

// Velocity of the centre of mass against that of the joint, in the body: ω × r. A velocity that
// lags behind the pose by a time s is that of the joint then: ω × r − s ω × (ω × r), with the ω of
// half that time later in the second term.
Vector3 AroundJoint(const RigidInertia& inertia, const Vector3& spin, mjtNum lag) {
  const Vector3 later = spin + lag / 2 * GyroscopicRate(inertia, spin);
  return Cross(spin, inertia.offset) - lag * Cross(later, Cross(later, inertia.offset));
}

}  // namespace

RigidInertia::RigidInertia(const mjModel* m, const mjData* d, int tree) {
  const int begin = m->tree_dofadr[tree], body = m->dof_bodyid[begin];
  mass = m->body_subtreemass[body];
  offset =
      RotateBack(d->xmat + 9 * body, Load(d->subtree_com + 3 * body) - Load(d->xpos + 3 * body));
  // J about the joint is the rotational block of M; about the centre, J − m (|r|² − r rᵀ)
  mju_zero(matrix, 9);
  for (int i = 0; i < 3; ++i) {
    const int row = begin + 3 + i;
    for (int a = m->M_rowadr[row]; a < m->M_rowadr[row] + m->M_rownnz[row]; ++a) {
      const int j = m->M_colind[a] - begin - 3;
      if (j >= 0) matrix[3 * i + j] = matrix[3 * j + i] = d->M[a];
    }
  }
  const mjtNum r[3] = {offset.x, offset.y, offset.z};
  for (int i = 0; i < 3; ++i) {
    matrix[4 * i] -= mass * Dot(offset, offset);
    for (int j = 0; j < 3; ++j) matrix[3 * i + j] += mass * r[i] * r[j];
  }
  // J⁻¹ by columns of cofactors; J is symmetric
  const Vector3 a = Load(matrix), b = Load(matrix + 3), c = Load(matrix + 6);
  const mjtNum determinant = Dot(a, Cross(b, c));
  Store(1 / determinant * Cross(b, c), inverse);
  Store(1 / determinant * Cross(c, a), inverse + 3);
  Store(1 / determinant * Cross(a, b), inverse + 6);
}

RigidAcceleration OtherForces(const RigidInertia& inertia, const mjtNum* rotation,
                              const mjtNum* acceleration, const Vector3& spin) {
  const Vector3 rate = Load(acceleration + 3), r = inertia.offset;
  const Vector3 of_offset = Cross(rate, r) + Cross(spin, Cross(spin, r));
  return {Load(acceleration) + ToWorld(rotation, of_offset), rate - GyroscopicRate(inertia, spin)};
}

// The classical Runge-Kutta method, in substeps that turn by at most 1/20 rad: their error is then
// below 1e-8 of the spin.
void Fly(const RigidInertia& inertia, const RigidAcceleration& acceleration, mjtNum time,
         RigidState& state) {
  constexpr mjtNum kMostTurn = 0.05;
  constexpr int kMostSubsteps = 100;
  const Vector3& a = acceleration.linear;
  state.position += time * (state.velocity + time / 2 * a);
  state.velocity += time * a;
  const mjtNum turn =
      std::min<mjtNum>(kMostSubsteps, std::abs(time) * Norm(state.spin) / kMostTurn);
  const int substeps = 1 + static_cast<int>(turn);
  const mjtNum h = time / substeps;
  Turning x;
  mju_copy4(x.rotation, state.rotation);
  x.spin = state.spin;
  for (int i = 0; i < substeps; ++i) {
    const Vector3& alpha = acceleration.angular;
    const Turning k1 = Rate(inertia, alpha, x);
    const Turning k2 = Rate(inertia, alpha, Along(x, h / 2, k1));
    const Turning k3 = Rate(inertia, alpha, Along(x, h / 2, k2));
    const Turning k4 = Rate(inertia, alpha, Along(x, h, k3));
    x = Along(Along(Along(Along(x, h / 6, k1), h / 3, k2), h / 3, k3), h / 6, k4);
    mju_normalize4(x.rotation);
  }
  mju_copy4(state.rotation, x.rotation);
  state.spin = x.spin;
}

Vector3 GyroscopicRate(const RigidInertia& inertia, const Vector3& spin) {
  return Times(inertia.inverse, Cross(Times(inertia.matrix, spin), spin));
}

mjtNum SpinEnergy(const RigidInertia& inertia, const Vector3& spin) {
  return 0.5 * Dot(spin, Times(inertia.matrix, spin));
}

Vector3 SpinAfter(const RigidInertia& inertia, const Vector3& unstruck, const Vector3& change,
                  mjtNum work) {
  constexpr mjtNum kMostChange = 0.05;
  const mjtNum A = SpinEnergy(inertia, change);
  const mjtNum B = Dot(change, Times(inertia.matrix, unstruck));
  const mjtNum discriminant = B * B + 4 * A * work;
  if (discriminant > 0) {
    const mjtNum root = std::copysign(std::sqrt(discriminant), 2 * A + B);
    const mjtNum kappa = A > 0 ? (root - B) / (2 * A) : 1;
    if (std::abs(kappa - 1) <= kMostChange) return unstruck + kappa * change;
  }
  const Vector3 spin = unstruck + change;
  const mjtNum found = SpinEnergy(inertia, spin);
  const mjtNum energy = std::max<mjtNum>(0, SpinEnergy(inertia, unstruck) + work);
  return found > 0 ? std::sqrt(energy / found) * spin : spin;
}

void ToJoint(const RigidInertia& inertia, const RigidState& state, mjtNum lag, mjtNum* qpos,
             mjtNum* qvel) {
  Store(state.position - ToWorld(state.rotation, inertia.offset), qpos);
  mju_copy4(qpos + 3, state.rotation);
  const Vector3 around = AroundJoint(inertia, state.spin, lag);
  Store(state.velocity - ToWorld(state.rotation, around), qvel);
  Store(state.spin, qvel + 3);
}

RigidState FromJoint(const RigidInertia& inertia, mjtNum lag, const mjtNum* qpos,
                     const mjtNum* qvel) {
  RigidState state;
  mju_copy4(state.rotation, qpos + 3);
  mju_normalize4(state.rotation);
  state.spin = Load(qvel + 3);
  state.position = Load(qpos) + ToWorld(state.rotation, inertia.offset);
  const Vector3 around = AroundJoint(inertia, state.spin, lag);
  state.velocity = Load(qvel) + ToWorld(state.rotation, around);
  return state;
}

Vector3 ToWorld(const mjtNum* rotation, const Vector3& v) {
  mjtNum local[3], world[3];
  Store(v, local);
  mju_rotVecQuat(world, local, rotation);
  return Load(world);
}

void Turn(const Vector3& angle, mjtNum* rotation) {
  mjtNum axis[3];
  Store(angle, axis);
  mju_quatIntegrate(rotation, axis, 1);
}

}  // namespace mujoco_impact::engine
