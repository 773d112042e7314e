// SPDX-License-Identifier: Apache-2.0

#include "engine/deliver/rigid_flights.h"

#include <new>

#include "engine/deliver/rigid_body.h"
#include "engine/scene/tree_kinds.h"

namespace mujoco_impact::engine {

namespace {

mjtNum* Position(const mjModel* m, int tree, mjtNum* qpos) { return qpos + FirstPosition(m, tree); }

bool MayFly(const mjModel* m, int tree) {
  return IsFreeBody(m, tree) && mju_isZero(m->dof_armature + m->tree_dofadr[tree], 6);
}

}  // namespace

struct RigidFlights::Flight {
  RigidInertia inertia;
  bool struck;
  bool carried;                    // by contacts of MuJoCo
  bool ball;                       // has the same inertia about all axes
  mjtNum time;                     // up to which the twins have flown [s]
  RigidAcceleration acceleration;  // of both
  RigidState now, unstruck;
  mjtNum rotation[4];  // of the body where its impulses were found
};

RigidFlights::Flight& RigidFlights::Of(int tree) const { return flights_[index_[tree]]; }

RigidFlights::RigidFlights(const mjModel* m, const mjData* d, const Motion& motion,
                           const Hold* held, bool friction, Scratch& scratch)
    : m_(m) {
  int* index = scratch.Take<int>(m->ntree);
  for (int tree = 0; tree < m->ntree; ++tree) {
    index[tree] = !IsAsleep(d, tree) && MayFly(m, tree) ? number_++ : -1;
  }
  if (number_ == 0) return;
  index_ = index;
  flights_ = scratch.Take<Flight>(number_);
  for (int tree = 0; tree < m->ntree; ++tree) {
    if (index[tree] < 0) continue;
    const bool carried = held[tree] == Hold::kCarried;
    const bool ball = IsBall(m, tree);
    if (held[tree] == Hold::kTied || (ball && !carried && !friction)) {
      index[tree] = -1;
      continue;
    }
    Flight& flight =
        *new (&Of(tree)) Flight{RigidInertia(m, d, tree), false, carried, ball, 0, {}, {}, {}, {}};
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

void RigidFlights::Add(const mjData* d, int tree, mjtNum there, mjtNum t, const mjtNum* velocity,
                       const mjtNum* kick, const mjtNum* moment) {
  Flight& flight = Of(tree);
  const RigidInertia& inertia = flight.inertia;
  if (!flight.struck) {
    const mjtNum* qpos = Position(m_, tree, d->qpos);
    flight.now = flight.unstruck = FromJoint(inertia, 0, qpos, velocity + m_->tree_dofadr[tree]);
    flight.struck = true;
    flight.time = there;
    mju_copy4(flight.rotation, flight.now.rotation);
  }
  if (t != flight.time) {
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
  // a ball looks the same from all sides, and its spin in the world is not to turn
  if (!flight.ball) Turn(Load(late + 3), now.rotation);
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

void RigidFlights::Finish(State& state) {
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
    Fly(flight.inertia, flight.acceleration, -PathLag(m_), now_then);
    Fly(flight.inertia, flight.acceleration, -PathLag(m_), unstruck_then);
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
    record.struck = flight.carried ? FlightRecord::kCarried : FlightRecord::kFree;
    record.work = SpinEnergy(flight.inertia, now.spin) - SpinEnergy(flight.inertia, unstruck.spin);
    Store(unstruck.velocity - PathLag(m_) * flight.acceleration.linear, record.velocity);
  }
}

void CommitRigidFlight(const mjModel* m, mjData* d, int tree, State& state) {
  // a state of another model of the same sizes may say so of any tree
  if (!MayFly(m, tree)) return;
  const int begin = m->tree_dofadr[tree];
  const RigidInertia inertia(m, d, tree);
  mjtNum *correction = state.correction() + begin, *change = state.held_force() + begin;
  mjtNum *qpos = Position(m, tree, d->qpos), *qvel = d->qvel + begin;
  RigidState body = FromJoint(inertia, PathLag(m), qpos, qvel);
  const FlightRecord& record = state.flight(tree);
  // MuJoCo's flight of a body whose centre is not at its joint does not keep its momentum m v:
  // the work that the impulse does for it is not one of the impact
  const Vector3 drift = body.velocity - Load(record.velocity);
  const mjtNum work = record.work - inertia.mass * Dot(Load(change), drift);
  // contacts that carry the body have done work of their own
  body.spin = record.struck == FlightRecord::kCarried
                  ? body.spin + Load(change + 3)
                  : SpinAfter(inertia, body.spin, Load(change + 3), work);
  body.position += Load(correction);
  Turn(Load(correction + 3), body.rotation);
  body.velocity += Load(change);
  ToJoint(inertia, body, PathLag(m), qpos, qvel);
  // the rest of the corrections is MuJoCo's to integrate
  mju_zero(correction, 6);
  mju_zero(change, 6);
}

}  // namespace mujoco_impact::engine
