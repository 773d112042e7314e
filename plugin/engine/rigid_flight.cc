// SPDX-License-Identifier: Apache-2.0

#include "engine/rigid_flight.h"

#include <algorithm>
#include <cmath>
#include <new>

#include "engine/silence.h"

namespace mujoco_impact::engine {

namespace {

Vector3 Times(const mjtNum* matrix, const Vector3& v) { return Rotate(matrix, v); }

Vector3 ToWorld(const mjtNum* rotation, const Vector3& v) {
  mjtNum local[3], world[3];
  Store(v, local);
  mju_rotVecQuat(world, local, rotation);
  return Load(world);
}

// rotation ← rotation ⊗ exp([angle]×)
void Turn(const Vector3& angle, mjtNum* rotation) {
  mjtNum axis[3];
  Store(angle, axis);
  mju_quatIntegrate(rotation, axis, 1);
}

mjtNum SpinEnergy(const RigidInertia& inertia, const Vector3& spin) {
  return 0.5 * Dot(spin, Times(inertia.matrix, spin));
}

// −J⁻¹(ω × J ω)
Vector3 GyroscopicRate(const RigidInertia& inertia, const Vector3& spin) {
  return Times(inertia.inverse, Cross(Times(inertia.matrix, spin), spin));
}

// What the other forces of the step do to a body [m/s², rad/s²].
struct Acceleration {
  Vector3 linear, angular;
};

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

// The classical Runge-Kutta method, in substeps that turn by at most 1/20 rad: their error is then
// below 1e-8 of the spin.
void Fly(const RigidInertia& inertia, const Acceleration& acceleration, mjtNum time,
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

// Velocity of the centre of mass against that of the joint, in the body: ω × r. A velocity that
// lags behind the pose by a time s is that of the joint then: ω × r − s ω × (ω × r).
Vector3 AroundJoint(const RigidInertia& inertia, const Vector3& spin, mjtNum lag) {
  const Vector3 around = Cross(spin, inertia.offset);
  return around - lag * Cross(spin, around);
}

// Position and velocity of the joint from those of the centre of mass.
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

mjtNum* Position(const mjModel* m, int tree, mjtNum* qpos) {
  return qpos + m->jnt_qposadr[m->dof_jntid[m->tree_dofadr[tree]]];
}

// How far the velocity of MuJoCo's bodies is behind that of their path (motion.h) [s].
mjtNum Lag(const mjModel* m) { return (0.5 - ImpulseLag(m)) * m->opt.timestep; }

// a and α from the accelerations of the joint at the spin for which MuJoCo found them.
Acceleration OtherForces(const RigidInertia& inertia, const mjtNum* rotation,
                         const mjtNum* acceleration, const Vector3& spin) {
  const Vector3 rate = Load(acceleration + 3), r = inertia.offset;
  const Vector3 of_offset = Cross(rate, r) + Cross(spin, Cross(spin, r));
  return {Load(acceleration) + ToWorld(rotation, of_offset), rate - GyroscopicRate(inertia, spin)};
}

// The spin that an impact leaves, whose energy is by `work` larger: ω° + κ Δω, κ the root next to 1
// of
//
//   ½ Δω·J Δω κ² + Δω·J ω° κ = work
//
// which leaves alone what the impact does, such as the spin about an axis of symmetry. Where Δω
// hardly changes the energy, all of the spin is scaled.
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

// Whether a free body has the same inertia about all axes through its joint.
bool IsBall(const mjModel* m, int tree) {
  constexpr mjtNum kSame = 1e-9;
  if (m->tree_bodynum[tree] != 1) return false;
  const int body = m->dof_bodyid[m->tree_dofadr[tree]];
  const mjtNum* inertia = m->body_inertia + 3 * body;
  // as wide as the inertia tells: the body may have no geom
  const mjtNum size = std::sqrt(inertia[0] / m->body_mass[body]);
  return std::abs(inertia[0] - inertia[1]) <= kSame * inertia[0] &&
         std::abs(inertia[0] - inertia[2]) <= kSame * inertia[0] &&
         Norm(Load(m->body_ipos + 3 * body)) <= kSame * size;
}

bool MayFly(const mjModel* m, int tree) {
  return IsFreeBody(m, tree) && mju_isZero(m->dof_armature + m->tree_dofadr[tree], 6);
}

// What MuJoCo's solver does to a tree.
enum class Hold { kNone, kCarried, kTied };

Hold HoldOfRow(const mjData* d, int i) {
  const int type = d->efc_type[i];
  const bool contact = type == mjCNSTR_CONTACT_FRICTIONLESS || type == mjCNSTR_CONTACT_PYRAMIDAL ||
                       type == mjCNSTR_CONTACT_ELLIPTIC;
  if (!contact) return Hold::kTied;
  return IsSilent(d, d->contact[d->efc_id[i]]) ? Hold::kNone : Hold::kCarried;
}

// By contacts alone, or by other constraints as well.
void FindHeld(const mjModel* m, const mjData* d, Hold* held) {
  std::fill_n(held, m->ntree, Hold::kNone);
  const int nv = static_cast<int>(m->nv);
  const bool sparse = mj_isSparse(m);
  for (int i = 0; i < d->nefc; ++i) {
    const Hold hold = HoldOfRow(d, i);
    if (hold == Hold::kNone) continue;
    const int begin = sparse ? d->efc_J_rowadr[i] : i * nv;
    const int count = sparse ? d->efc_J_rownnz[i] : nv;
    for (int a = begin; a < begin + count; ++a) {
      if (d->efc_J[a] == 0) continue;
      Hold& tree = held[m->dof_treeid[sparse ? d->efc_J_colind[a] : a - begin]];
      tree = std::max(tree, hold);
    }
  }
}

}  // namespace

// FlightRecord::struck
constexpr double kFree = 1, kCarried = 2;

struct RigidFlights::Flight {
  RigidInertia inertia;
  bool struck;
  bool carried;               // by contacts of MuJoCo
  mjtNum time;                // up to which the twins have flown [s]
  Acceleration acceleration;  // of both
  RigidState now, unstruck;
  mjtNum rotation[4];  // of the body where its impulses were found
};

RigidFlights::Flight& RigidFlights::Of(int tree) const { return flights_[index_[tree]]; }

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

bool IsFreeBody(const mjModel* m, int tree) {
  const int begin = m->tree_dofadr[tree];
  return m->tree_dofnum[tree] == 6 && m->jnt_type[m->dof_jntid[begin]] == mjJNT_FREE;
}

bool KeepsInertia(const mjModel* m, int tree) {
  if (tree < 0 || m->tree_dofnum[tree] == 1) return true;
  const int first = m->tree_dofadr[tree];
  if (IsFreeBody(m, tree)) return IsBall(m, tree);
  for (int dof = first; dof < first + m->tree_dofnum[tree]; ++dof) {
    if (m->jnt_type[m->dof_jntid[dof]] != mjJNT_SLIDE) return false;
  }
  return true;
}

RigidFlights::RigidFlights(const mjModel* m, const mjData* d, const Motion& motion, bool pulses,
                           Scratch& scratch)
    : m_(m) {
  if (pulses) return;
  int* index = scratch.Take<int>(m->ntree);
  for (int tree = 0; tree < m->ntree; ++tree) {
    index[tree] = !IsAsleep(d, tree) && MayFly(m, tree) ? number_++ : -1;
  }
  if (number_ == 0) return;
  index_ = index;
  Hold* held = scratch.Take<Hold>(m->ntree);
  FindHeld(m, d, held);
  flights_ = scratch.Take<Flight>(number_);
  for (int tree = 0; tree < m->ntree; ++tree) {
    if (index[tree] < 0) continue;
    const bool carried = held[tree] == Hold::kCarried;
    if (held[tree] == Hold::kTied || (IsBall(m, tree) && !carried)) {
      index[tree] = -1;
      continue;
    }
    Flight& flight =
        *new (&Of(tree)) Flight{RigidInertia(m, d, tree), false, carried, 0, {}, {}, {}, {}};
    const int begin = m->tree_dofadr[tree];
    const mjtNum* rotation = d->xquat + 4 * m->dof_bodyid[begin];
    mju_copy4(flight.rotation, rotation);
    flight.acceleration = OtherForces(flight.inertia, rotation, motion.acceleration + begin,
                                      Load(d->qvel + begin + 3));
  }
}

const mjtNum* RigidFlights::SteadyAcceleration(const Motion& motion, Scratch& scratch) const {
  if (!index_) return motion.acceleration;
  mjtNum* steady = scratch.Take<mjtNum>(m_->nv);
  mju_copy(steady, motion.acceleration, m_->nv);
  for (int tree = 0; tree < m_->ntree; ++tree) {
    if (!Has(tree)) continue;
    const Flight& flight = Of(tree);
    const int begin = m_->tree_dofadr[tree];
    const Vector3 of_offset = Cross(flight.acceleration.angular, flight.inertia.offset);
    Store(flight.acceleration.linear - ToWorld(flight.rotation, of_offset), steady + begin);
    Store(flight.acceleration.angular, steady + begin + 3);
  }
  return steady;
}

void RigidFlights::Add(const mjData* d, int tree, mjtNum t, const mjtNum* velocity,
                       const mjtNum* kick, const mjtNum* moment) {
  Flight& flight = Of(tree);
  const RigidInertia& inertia = flight.inertia;
  if (!flight.struck) {
    const mjtNum* qpos = Position(m_, tree, d->qpos);
    flight.now = flight.unstruck = FromJoint(inertia, 0, qpos, velocity + m_->tree_dofadr[tree]);
    flight.struck = true;
    flight.time = t;
    mju_copy4(flight.rotation, flight.now.rotation);
  } else if (t != flight.time) {
    Fly(inertia, flight.acceleration, t - flight.time, flight.now);
    Fly(inertia, flight.acceleration, t - flight.time, flight.unstruck);
    flight.time = t;
    mju_copy4(flight.rotation, flight.now.rotation);
  }
  RigidState& now = flight.now;
  const auto of_centre = [&](const mjtNum* change) {
    return Load(change) + ToWorld(flight.rotation, Cross(Load(change + 3), inertia.offset));
  };
  now.velocity += of_centre(kick);
  now.spin += Load(kick + 3);
  // the impulse came t_P = moment / impulse instead of t: Δx = (t − t_P) ΔV
  mjtNum late[6];
  for (int i = 0; i < 6; ++i) late[i] = t * kick[i] - moment[i];
  now.position += of_centre(late);
  Turn(Load(late + 3), now.rotation);
}

void RigidFlights::Place(mjtNum t, mjtNum* qpos, mjtNum* qvel, mjtNum* velocity,
                         mjtNum* acceleration) {
  if (!index_) return;
  for (int tree = 0; tree < m_->ntree; ++tree) {
    if (!Has(tree) || !Of(tree).struck) continue;
    const Flight& flight = Of(tree);
    const RigidInertia& inertia = flight.inertia;
    const int begin = m_->tree_dofadr[tree];
    RigidState state = flight.now;
    Fly(inertia, flight.acceleration, t - flight.time, state);
    ToJoint(inertia, state, 0, Position(m_, tree, qpos), qvel + begin);
    mju_copy(velocity + begin, qvel + begin, 6);
    const Vector3 r = inertia.offset;
    const Vector3 rate = GyroscopicRate(inertia, state.spin) + flight.acceleration.angular;
    const Vector3 of_offset = Cross(rate, r) + Cross(state.spin, Cross(state.spin, r));
    Store(flight.acceleration.linear - ToWorld(state.rotation, of_offset), acceleration + begin);
    Store(rate, acceleration + begin + 3);
  }
}

void RigidFlights::Finish(const mjModel* m, State& state) {
  for (int tree = 0; tree < m->ntree; ++tree) state.flight(tree) = {};
  if (!index_) return;
  const mjtNum h = m_->opt.timestep;
  for (int tree = 0; tree < m_->ntree; ++tree) {
    if (!Has(tree) || !Of(tree).struck) continue;
    Flight& flight = Of(tree);
    RigidState &now = flight.now, &unstruck = flight.unstruck;
    Fly(flight.inertia, flight.acceleration, h - flight.time, now);
    Fly(flight.inertia, flight.acceleration, h - flight.time, unstruck);
    // the spin of MuJoCo's bodies is behind their path
    RigidState now_then = now, unstruck_then = unstruck;
    Fly(flight.inertia, flight.acceleration, -Lag(m_), now_then);
    Fly(flight.inertia, flight.acceleration, -Lag(m_), unstruck_then);
    const int begin = m_->tree_dofadr[tree];
    mjtNum inverse[4], difference[4], angle[3];
    mju_negQuat(inverse, unstruck.rotation);
    mju_mulQuat(difference, inverse, now.rotation);
    mju_quat2Vel(angle, difference, 1);
    Store(now.position - unstruck.position, state.correction() + begin);
    mju_copy3(state.correction() + begin + 3, angle);
    Store(now.velocity - unstruck.velocity, state.held_force() + begin);
    Store(now_then.spin - unstruck_then.spin, state.held_force() + begin + 3);
    FlightRecord& record = state.flight(tree);
    record.struck = flight.carried ? kCarried : kFree;
    record.work = SpinEnergy(flight.inertia, now.spin) - SpinEnergy(flight.inertia, unstruck.spin);
    Store(unstruck.velocity - Lag(m_) * flight.acceleration.linear, record.velocity);
  }
}

void CommitFlights(const mjModel* m, mjData* d, State& state) {
  for (int tree = 0; tree < m->ntree; ++tree) {
    // a state of another model of the same sizes may say so of any tree
    if (state.flight(tree).struck == 0 || !MayFly(m, tree)) continue;
    const int begin = m->tree_dofadr[tree];
    const RigidInertia inertia(m, d, tree);
    mjtNum *correction = state.correction() + begin, *change = state.held_force() + begin;
    mjtNum *qpos = Position(m, tree, d->qpos), *qvel = d->qvel + begin;
    RigidState body = FromJoint(inertia, Lag(m), qpos, qvel);
    const FlightRecord& record = state.flight(tree);
    // MuJoCo's flight of a body whose centre is not at its joint does not keep its momentum m v:
    // the work that the impulse does for it is not one of the impact
    const Vector3 drift = body.velocity - Load(record.velocity);
    const mjtNum work = record.work - inertia.mass * Dot(Load(change), drift);
    // contacts that carry the body have done work of their own
    body.spin = record.struck == kCarried ? body.spin + Load(change + 3)
                                          : SpinAfter(inertia, body.spin, Load(change + 3), work);
    body.position += Load(correction);
    Turn(Load(correction + 3), body.rotation);
    body.velocity += Load(change);
    ToJoint(inertia, body, Lag(m), qpos, qvel);
    // the rest of the corrections is MuJoCo's to integrate
    mju_zero(correction, 6);
    mju_zero(change, 6);
    state.flight(tree) = {};
  }
}

}  // namespace mujoco_impact::engine
