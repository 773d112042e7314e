// SPDX-License-Identifier: Apache-2.0

#include "engine/resolve/impacts.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "engine/handover/silent_rows.h"
#include "engine/island/tangents.h"
#include "engine/path/inertia_there.h"
#include "engine/resolve/reach.h"
#include "engine/resolve/resolver.h"
#include "engine/resolve/velocity_forces.h"

namespace mujoco_impact::engine {

namespace {

// Of a step: contacts that close after a shorter flight than this belong to the same impact. The
// lever arms are then off by the square of the angle turned meanwhile: 1e-2 of that of a step.
constexpr mjtNum kSameImpact = 0.1;

// Of a step: pulses under way that end before it are taken as impulses that have come.
constexpr mjtNum kShortPulses = 0.5;

}  // namespace

Resolver::Resolver(const mjModel* m, mjData* d, int instance, const Mobility& mobility,
                   const mjtNum* kick, State& state, Delivery& delivery, Scratch& scratch)
    : m_(m),
      d_(d),
      ownership_(m, instance),
      config_(ReadConfig(m, instance, ownership_.size(), nullptr)),
      materials_(m, instance, config_, scratch),
      mobility_(mobility),
      state_(state),
      delivery_(delivery),
      scratch_(scratch),
      bent_(ActiveEnd(state) > kShortPulses * m->opt.timestep),
      impacts_(bent_ ? MakeDelivery(m, scratch) : delivery),
      kicks_(MakeKicks(m, scratch)),
      contacts_(GatherContacts(m, d, ownership_, state, kick, scratch)),
      budget_(m, materials_.IsElastic(), HasFriction(materials_, contacts_), contacts_),
      struck_(m, d, mobility, scratch),
      start_(LookAhead(m, d, mobility, delivery, state.mocap(), bent_, scratch)),
      flights_(m, d, start_.motion, state.header().active > 0, HasFriction(materials_, contacts_),
               scratch),
      stops_(m, d, start_.motion, scratch),
      steady_(WithoutVelocityForces(m, d, flights_,
                                    flights_.SteadyAcceleration(start_.motion, scratch), scratch)),
      bodies_(m, d, mobility, start_, flights_, scratch) {}

Islands Resolver::FindRound(const Outlook& outlook, Scratch& scratch) {
  const mjtNum reach = ReachOfRound(m_, d_, materials_, outlook, flight_, contacts_);
  FindNear(m_, d_, outlook, reach, contacts_);
  return FindIslands(m_, mobility_, stops_, contacts_.contact, contacts_.due, contacts_.near,
                     contacts_.count, scratch);
}

bool Resolver::IsOnPath(const int* position, int count) const {
  return std::all_of(position, position + count,
                     [this](int i) { return engine::IsOnPath(m_, *contacts_.contact[i]); });
}

// Moves the bodies to where the first contact of an island closes, and finds out there where they
// touch. False if that changes when it closes.
bool Resolver::Approach(Outlook& outlook, const ImpactTime& time, const int* position, int count) {
  constexpr mjtNum kThere = 1e-9;  // of a step
  for (int k = 0; k < contacts_.count; ++k) {
    contacts_.relevant[k] = contacts_.relevant[k] && contacts_.due[k];
  }
  for (int a = 0; a < count; ++a) contacts_.relevant[position[a]] = true;
  AnchorAll();
  budget_.SpendRound(m_, contacts_);
  budget_.Spend(flights_.TakeWork());
  if (HasArms(position, count)) flights_.FollowArms();
  outlook = bodies_.MoveTo(time.start + time.tau, impacts_, kicks_, struck_.owed());
  struck_.BeginRound(outlook.motion);
  budget_.SpendPairs(FindPointsAgain(m_, d_, position, count, contacts_));
  AnchorAll();
  return std::abs(time.tau) <= kThere * m_->opt.timestep;
}

void Resolver::ResolveRound(Outlook& outlook) {
  constexpr int kTrials = 4;
  struck_.BeginRound(outlook.motion);
  for (int trial = 1;; ++trial) {
    Scratch scratch(d_);
    const Islands islands = FindRound(outlook, scratch);
    // in order of time, so that an island that the impacts before may reach can wait for its turn
    ImpactTime* times = scratch.Take<ImpactTime>(islands.number);
    int* order = scratch.Take<int>(islands.number);
    for (int i = 0; i < islands.number; ++i) {
      order[i] = i;
      times[i] = FirstClosing(outlook, islands.position + islands.start[i],
                              islands.start[i + 1] - islands.start[i]);
    }
    std::sort(order, order + islands.number,
              [times](int i, int j) { return times[i].tau < times[j].tau; });
    if (islands.number > 0 && !last_ && !there_) {
      const int* first = islands.position + islands.start[order[0]];
      const int count = islands.start[order[0] + 1] - islands.start[order[0]];
      if (!IsOnPath(first, count)) {
        there_ = Approach(outlook, times[order[0]], first, count) || trial == kTrials;
        if (FindDue(m_, d_, outlook, config_.touch, struck_.busy(), contacts_)) continue;
        there_ = false;
        round_end_ = left_ = outlook.start;
        return;
      }
    }
    if (there_) {
      const int* first = islands.position + islands.start[order[0]];
      const int count = islands.start[order[0] + 1] - islands.start[order[0]];
      GoToCentre(outlook, times[order[0]], first, count);
      times[order[0]] = FirstClosing(outlook, first, count);
    }
    ResolveIslands(outlook, islands, times, order);
    there_ = false;
    return;
  }
}

void Resolver::ResolveIslands(const Outlook& outlook, const Islands& islands,
                              const ImpactTime* times, const int* order) {
  round_end_ = left_ = m_->opt.timestep;
  path_velocity_ = outlook.motion.velocity;
  for (int i = 0; i < islands.number; ++i) {
    const int island = order[i];
    const int* position = islands.position + islands.start[island];
    const int count = islands.start[island + 1] - islands.start[island];
    const bool may_wait = i > 0 && !last_ && round_end_ < m_->opt.timestep;
    if (may_wait && struck_.MayReach(contacts_, position, count, times[island].tau)) break;
    // one that is not on the path has a round of its own
    if (i > 0 && !last_ && (there_ || !IsOnPath(position, count))) {
      left_ = std::min(left_, outlook.start + times[island].tau);
      break;
    }
    if (there_) {
      Scratch scratch(d_);
      const InertiaThere inertia(m_, d_, scratch);
      const bool any = std::exchange(kicks_.any, false);
      ResolveFirstOf(outlook, times[island], position, count);
      if (kicks_.any) {
        AddVelocityForces(m_, d_, flights_, outlook.start + times[island].tau,
                          outlook.motion.velocity, struck_.kicked().velocity, kicks_, scratch);
      }
      kicks_.any = kicks_.any || any;
    } else {
      ResolveFirstOf(outlook, times[island], position, count);
    }
  }
}

// Whether any contact may close before the end of the step with the velocity the impacts left:
// one that was due but has to wait for its turn, or one whose bodies were struck.
bool Resolver::MoreMayClose(const Outlook& outlook) {
  const mjtNum time_left = m_->opt.timestep - outlook.start;
  bool any = false;
  for (int k = 0; k < contacts_.count; ++k) {
    const bool moved = struck_.Moved(*contacts_.contact[k]);
    contacts_.relevant[k] = contacts_.due[k] || moved;
    if (any || !contacts_.relevant[k]) continue;
    const ContactAnchor& anchor = Anchor(m_, d_, contacts_, k);
    const mjtNum rate = ContactPath(m_, d_, anchor, struck_.kicked()).GapRate(0);
    if (rate >= 0) continue;
    // until then on the path before, whose velocity may have been another
    const ContactPath before(m_, d_, anchor, outlook.motion);
    const mjtNum gap = std::min(before.Gap(0), before.Gap(round_end_ - outlook.start));
    any = gap + time_left * rate < -config_.touch;
  }
  return any;
}

void Resolver::AnchorAll() {
  for (int k = 0; k < contacts_.count; ++k) Anchor(m_, d_, contacts_, k);
}

void Resolver::Run() {
  budget_.SpendPairs(contacts_.asked);
  RunRounds();
  // MuJoCo's limits would answer the impulses in the same step
  stops_.ForStruck([this](bool tendon, int id) { SilenceLimit(d_, tendon, id); });
  bodies_.FlyToEnd();
  bodies_.PutBack();
  budget_.Spend(flights_.TakeWork());
  AddKicks(m_, d_, kicks_, impacts_, scratch_);
  state_.header().work = budget_.part();
  if (bent_) AddTo(m_, impacts_, delivery_);
}

void Resolver::RunRounds() {
  const mjtNum h = m_->opt.timestep;
  Outlook outlook = start_;
  // pulses of the last step that soon end are looked back on; longer ones bend the path
  const mjtNum pulses_end = ActiveEnd(state_);
  if (pulses_end > 0 && !bent_) {
    AnchorAll();
    struck_.TakeForPulses(state_, pulses_end);
    outlook = bodies_.MoveTo(pulses_end, impacts_, kicks_, nullptr);
  }
  for (;;) {
    if (!FindDue(m_, d_, outlook, config_.touch, struck_.busy(), contacts_)) return;
    budget_.SpendRound(m_, contacts_);
    last_ = budget_.IsLow();
    flight_ = last_ ? std::numeric_limits<mjtNum>::infinity() : kSameImpact * h;
    ResolveRound(outlook);
    // a pulse that outlasts the step does not keep others from closing meanwhile
    if (round_end_ >= h && left_ > outlook.start) round_end_ = left_;
    if (last_ || round_end_ >= h || !MoreMayClose(outlook)) return;
    AnchorAll();
    outlook = bodies_.MoveTo(round_end_, impacts_, kicks_, struck_.owed());
  }
}

Flights ResolveImpacts(const mjModel* m, mjData* d, int instance, const Mobility& mobility,
                       const mjtNum* kick, State& state, Delivery& delivery, Scratch& scratch) {
  Resolver resolver(m, d, instance, mobility, kick, state, delivery, scratch);
  resolver.Run();
  return resolver.flights();
}

}  // namespace mujoco_impact::engine
