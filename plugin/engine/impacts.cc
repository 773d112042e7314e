// SPDX-License-Identifier: Apache-2.0

#include "engine/impacts.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "engine/budget.h"
#include "engine/config.h"
#include "engine/flights.h"
#include "engine/friction.h"
#include "engine/gather.h"
#include "engine/inertia_there.h"
#include "engine/island_system.h"
#include "engine/islands.h"
#include "engine/outlook.h"
#include "engine/ownership.h"
#include "engine/reach.h"
#include "engine/resolve.h"
#include "engine/slots.h"
#include "engine/struck.h"
#include "engine/tangents.h"
#include "engine/velocity_forces.h"

namespace mujoco_impact::engine {

namespace {

// Of a step: contacts that close after a shorter flight than this belong to the same impact. The
// lever arms are then off by the square of the angle turned meanwhile: 1e-2 of that of a step.
constexpr mjtNum kSameImpact = 0.1;

// Of a step: pulses under way that end before it are taken as impulses that have come.
constexpr mjtNum kShortPulses = 0.5;

class Resolver {
 public:
  Resolver(const mjModel* m, mjData* d, int instance, const Mobility& mobility, const mjtNum* kick,
           State& state, Delivery& delivery, Scratch& scratch)
      : m_(m),
        d_(d),
        ownership_(m, instance),
        config_(ReadConfig(m, instance, ownership_.size(), nullptr)),
        mobility_(mobility),
        state_(state),
        delivery_(delivery),
        scratch_(scratch),
        bent_(ActiveEnd(state) > kShortPulses * m->opt.timestep),
        impacts_(bent_ ? MakeDelivery(m, scratch) : delivery),
        kicks_(MakeKicks(m, scratch)),
        contacts_(GatherContacts(m, d, ownership_, state, kick, scratch)),
        budget_(m, config_, contacts_),
        struck_(m, d, mobility, scratch),
        start_(LookAhead(m, d, mobility, delivery, state.mocap(), bent_, scratch)),
        flights_(m, d, start_.motion, state.header().active > 0, HasFriction(config_, contacts_),
                 scratch),
        steady_(WithoutVelocityForces(
            m, d, flights_, flights_.SteadyAcceleration(start_.motion, scratch), scratch)),
        bodies_(m, d, mobility, start_, flights_, scratch) {}

  void Run();

  const Flights& flights() const { return flights_; }

 private:
  void RunRounds();
  void ResolveRound(Outlook& outlook);
  void ResolveIslands(const Outlook& outlook, const Islands& islands, const ImpactTime* times,
                      const int* order);
  Islands FindRound(const Outlook& outlook, Scratch& scratch);
  bool IsOnPath(const int* position, int count) const;
  bool Approach(Outlook& outlook, const ImpactTime& time, const int* position, int count);
  bool AnyFlies(const IslandSystem& system) const;
  bool FitsIsland(const int* position, int count);
  const mjtNum* FallOf(const IslandSystem& system, const int* position, mjtNum time,
                       Scratch& scratch) const;
  IslandSystem SolveIsland(const Outlook& outlook, ImpactTime time, const int* position, int count,
                           Impact* impacts, Scratch& scratch);
  mjtNum CentreOf(const Outlook& outlook, const ImpactTime& time, const int* position, int count);
  bool HasArms(const int* position, int count) const;
  void GoToCentre(Outlook& outlook, const ImpactTime& time, const int* position, int count);
  bool ResolveIslandOf(const Outlook& outlook, ImpactTime time, const int* position, int count);
  void ResolveFirstOf(const Outlook& outlook, ImpactTime time, const int* position, int count);
  ImpactTime FirstClosing(const Outlook& outlook, const int* position, int count) const;
  static void ComeAtOnce(const ImpactTime& time, int count, Impact* impacts);
  void AddImpacts(const IslandSystem& system, const ImpactTime& time, const Impact* impacts,
                  const int* position);
  void AddImpact(const ContactRow& row, const ImpactTime& time, const Impact& impact);
  void AddShare(const ContactRow& row, const ImpactTime& time, const Share& share);
  void AnchorAll();
  bool ResolvePartOf(const Outlook& outlook, ImpactTime time, const int* position, int count);
  bool MoreMayClose(const Outlook& outlook);

  const mjModel* m_;
  mjData* d_;
  const Ownership ownership_;
  const Config config_;
  const Mobility& mobility_;
  State& state_;
  Delivery& delivery_;
  Scratch& scratch_;
  const bool bent_;         // pulses under way last on and bend the path
  const Delivery impacts_;  // what comes at times within the step
  Kicks kicks_;
  Gathered contacts_;
  Budget budget_;
  Struck struck_;
  const Outlook start_;
  Flights flights_;
  const mjtNum* steady_;  // what gravity and other forces do to the velocities (nv)
  BodiesInStep bodies_;
  const mjtNum* path_velocity_ = nullptr;  // of the outlook of the round (nv)
  bool there_ = false;  // the bodies are where the impact at hand begins, and so is their inertia
  bool last_ = false;   // no further round is possible
  mjtNum stiffer_ = 1;  // λ of the bodies in this step
  mjtNum flight_ = 0;
  mjtNum round_end_ = 0;  // when the first impact of the round is over
  mjtNum left_ = 0;       // when the first contact closes that took no part in it
};

// Delivers the part of a new pulse that belongs to this step: all of it, by its moment, if the
// impact comes at once.
void Resolver::AddImpact(const ContactRow& row, const ImpactTime& time, const Impact& impact) {
  const Pulse pulse = MakePulse(m_, d_, row, time.tau, impact, config_, state_);
  const Share whole{impact.impulse, impact.moment, 1};
  const Share share =
      impact.at_once ? whole : ShareOfStep(pulse, state_.header().clock, m_->opt.timestep);
  AddPending(m_, ownership_, state_, pulse, share.delivered_next);
  AddShare(row, time, share);
  struck_.Add(row, share.impulse, impact.impulse - share.impulse);
}

// To each tree in its own way: bodies that fly are changed there, what was found at another inertia
// is a change of velocity, all else an impulse.
void Resolver::AddShare(const ContactRow& row, const ImpactTime& time, const Share& share) {
  Scratch scratch(d_);
  for (const RowSegment& segment : row.segment) {
    if (segment.tree < 0) continue;
    const int begin = m_->tree_dofadr[segment.tree], dofs = m_->tree_dofnum[segment.tree];
    const mjtNum second = SecondMoment(share, m_->opt.timestep);
    if (flights_.Has(segment.tree)) {
      mjtNum* kick = scratch.Take<mjtNum>(2 * dofs);
      mju_scl(kick, segment.inverse_inertia, share.impulse, dofs);
      mju_scl(kick + dofs, segment.inverse_inertia, share.moment, dofs);
      const mjtNum seen = time.start + (there_ ? 0 : time.tau);
      flights_.Add(d_, segment.tree, time.start, seen, path_velocity_, kick, kick + dofs);
    } else if (there_) {
      kicks_.any = true;
      mju_addToScl(kicks_.velocity + begin, segment.inverse_inertia, share.impulse, dofs);
      mju_addToScl(kicks_.moment + begin, segment.inverse_inertia, share.moment, dofs);
      mju_addToScl(kicks_.second + begin, segment.inverse_inertia, second, dofs);
    } else {
      mju_addToScl(impacts_.impulse + begin, segment.jacobian, share.impulse, dofs);
      mju_addToScl(impacts_.moment + begin, segment.jacobian, share.moment, dofs);
      mju_addToScl(impacts_.second + begin, segment.jacobian, second, dofs);
    }
  }
}

ImpactTime Resolver::FirstClosing(const Outlook& outlook, const int* position, int count) const {
  const mjtNum h = m_->opt.timestep;
  ImpactTime time{
      outlook.start, 0, h, flight_, h, std::numeric_limits<mjtNum>::infinity(), -1, h, 0};
  for (int k = 0; k < count; ++k) {
    const int i = position[k];
    if (!contacts_.due[i]) continue;
    if (time.first >= 0 && contacts_.tau[i] >= time.tau) continue;
    time.tau = contacts_.tau[i];
    time.first = k;
  }
  return time;
}

bool Resolver::AnyFlies(const IslandSystem& system) const {
  return std::any_of(system.row, system.row + system.size, [this](const ContactRow& row) {
    return std::any_of(row.segment, row.segment + 2, [this](const RowSegment& segment) {
      return segment.tree >= 0 && flights_.Has(segment.tree);
    });
  });
}

bool Resolver::FitsIsland(const int* position, int count) {
  Scratch scratch(d_);
  const bool friction = HasFriction(config_, contacts_, position, count);
  size_t bytes = IslandBytes(m_, mobility_, contacts_, position, count, friction, scratch);
  if (config_.friction == Friction::kPaper) bytes += FrictionBytes(m_, bytes);
  return scratch.Fits(bytes);
}

// Of the contacts that MuJoCo carries, by how much the free motion of the bodies up to a time lets
// them close (size): what carries them does not let them fall, and a body that is struck while it
// lies on a table must not bounce off it.
const mjtNum* Resolver::FallOf(const IslandSystem& system, const int* position, mjtNum time,
                               Scratch& scratch) const {
  mjtNum* fall = scratch.Zeros(system.size);
  const mjtNum lead = PathLag(m_);
  for (int k = 0; k < system.size; ++k) {
    if (contacts_.due[position[k]] || !IsCarried(*system.row[k].contact)) continue;
    const mjtNum pressing = -RowTimes(m_, system.row[k], start_.motion.acceleration);
    fall[k] = std::max<mjtNum>(0, pressing * (lead + time));
  }
  return fall;
}

// The contacts of an island and their impacts. Of bodies that have been moved there for it, the
// geometry is that of where they are; else that of when the first contact closes.
IslandSystem Resolver::SolveIsland(const Outlook& outlook, ImpactTime time, const int* position,
                                   int count, Impact* impacts, Scratch& scratch) {
  const mjtNum seen = there_ ? 0 : time.tau;
  time.seen = seen - time.tau;
  IslandSystem system = BuildIsland(m_, d_, mobility_, contacts_, position, count, outlook.motion,
                                    seen, time.tau, scratch);
  const bool friction = HasFriction(config_, contacts_, position, count);
  for (int k = 0; k < count; ++k) budget_.SpendRow(m_, system.row[k], friction ? 3 : 1);
  // a tumbling body turns away from a pulse that lasts, whose line stays as it was
  constexpr mjtNum kShortSteps = 4;
  if (AnyFlies(system)) time.short_of = kShortSteps * m_->opt.timestep;
  const mjtNum* velocity = SettledVelocity(m_, outlook, seen, scratch);
  mjtNum* acceleration = scratch.Take<mjtNum>(m_->nv);
  mju_addScl(acceleration, steady_, start_.motion.jerk, outlook.start + seen, m_->nv);
  Tangents* tangents = nullptr;
  if (friction) {
    tangents = BuildTangents(m_, d_, mobility_, system, outlook.motion, seen, velocity, scratch);
  }
  const mjtNum* fall = FallOf(system, position, outlook.start + seen, scratch);
  ResolveIsland(m_, config_, ownership_, system, time, velocity, fall, acceleration, tangents,
                budget_, &stiffer_, impacts, scratch);
  if (tangents) TurnRows(m_, *tangents, system, impacts);
  if (config_.friction == Friction::kPaper) {
    AddFriction(m_, d_, config_, outlook.motion, seen, velocity, system, impacts, scratch);
  }
  return system;
}

// False if no contact pushes.
bool Resolver::ResolveIslandOf(const Outlook& outlook, ImpactTime time, const int* position,
                               int count) {
  if (!FitsIsland(position, count)) {
    mju_warning(
        "mujoco_impact.waveform: an impact of %d contacts needs more memory than mjData has left "
        "and is skipped; raise <size memory=\"...\"/> in the model",
        count);
    return true;
  }
  Scratch scratch(d_);
  Impact* impacts = scratch.Take<Impact>(count);
  const IslandSystem system = SolveIsland(outlook, time, position, count, impacts, scratch);
  const auto pushes = std::count_if(impacts, impacts + count,
                                    [](const Impact& impact) { return impact.impulse > 0; });
  if (pushes == 0) return false;
  if (!HasRoom(state_, static_cast<int>(pushes))) ComeAtOnce(time, count, impacts);
  AddImpacts(system, time, impacts, position);
  return true;
}

// How long after its first contact closes the impulses of an island come on the average [s]; 0 if
// they last on.
mjtNum Resolver::CentreOf(const Outlook& outlook, const ImpactTime& time, const int* position,
                          int count) {
  if (!FitsIsland(position, count)) return 0;
  Scratch scratch(d_);
  const InertiaThere inertia(m_, d_, scratch);
  Impact* impacts = scratch.Take<Impact>(count);
  SolveIsland(outlook, time, position, count, impacts, scratch);
  mjtNum impulse = 0, moment = 0;
  for (int k = 0; k < count; ++k) {
    if (impacts[k].impulse > 0 && !impacts[k].at_once) return 0;
    impulse += impacts[k].impulse;
    moment += impacts[k].moment;
  }
  return impulse > 0 ? moment / impulse - time.start - time.tau : 0;
}

bool Resolver::HasArms(const int* position, int count) const {
  return std::any_of(position, position + count, [this](int i) {
    const ContactTrees trees = TreesOf(m_, *contacts_.contact[i]);
    return std::any_of(trees.tree, trees.tree + 2, [this](int tree) {
      return tree >= 0 && flights_.Has(tree) && !flights_.IsRigid(tree);
    });
  });
}

// The inertia of arms turns with them while they are pushed, and an impulse that comes all at once
// keeps their energy only where it comes: so they are moved on from where a contact closes to the
// middle of its impact.
void Resolver::GoToCentre(Outlook& outlook, const ImpactTime& time, const int* position,
                          int count) {
  if (!HasArms(position, count)) return;
  const mjtNum start = outlook.start;
  const mjtNum centre = start + time.tau + CentreOf(outlook, time, position, count);
  outlook = bodies_.MoveTo(centre, impacts_, kicks_, struck_.owed());
  struck_.BeginRound(outlook.motion);
  for (int k = 0; k < contacts_.count; ++k) contacts_.tau[k] -= centre - start;
}

// Without free slots all of the island comes now, and no momentum is lost; all or none, for a light
// body between two others is pushed by the difference.
void Resolver::ComeAtOnce(const ImpactTime& time, int count, Impact* impacts) {
  for (int k = 0; k < count; ++k) {
    if (impacts[k].at_once) continue;
    impacts[k].at_once = true;
    impacts[k].moment = impacts[k].impulse * (time.start + time.tau);
  }
}

void Resolver::AddImpacts(const IslandSystem& system, const ImpactTime& time, const Impact* impacts,
                          const int* position) {
  mjtNum end = time.start + time.tau;
  for (int k = 0; k < system.size; ++k) {
    const int i = position[k];
    if (impacts[k].impulse > 0) {
      AddImpact(system.row[k], time, impacts[k]);
      end = std::max(end, impacts[k].onset + impacts[k].duration);
    } else if (contacts_.due[i]) {
      left_ = std::min(left_, time.start + contacts_.tau[i]);
    }
  }
  round_end_ = std::min(round_end_, end);
  for (int k = 0; k < system.size; ++k) {
    if (impacts[k].impulse > 0) struck_.TakeUntil(system.row[k], end);
  }
}

// Resolves as much of the island as the impact that begins in it can reach.
bool Resolver::ResolvePartOf(const Outlook& outlook, ImpactTime time, const int* position,
                             int count) {
  if (last_ || !IsCrowded(m_, d_, contacts_, position, count)) {
    return ResolveIslandOf(outlook, time, position, count);
  }
  Scratch scratch(d_);
  const Islands part =
      ReachedPart(m_, d_, mobility_, outlook, position, count, contacts_, time, scratch);
  const int* end = part.position + part.start[1];
  for (int k = 0; k < count; ++k) {
    const int i = position[k];
    if (!contacts_.due[i] || std::binary_search(part.position, end, i)) continue;
    left_ = std::min(left_, time.start + contacts_.tau[i]);
  }
  time.first = FirstClosing(outlook, part.position, part.start[1]).first;
  return ResolveIslandOf(outlook, time, part.position, part.start[1]);
}

// Resolves the island from the first contact on whose closing is an impact. What closes within the
// flight of one that pushes nothing was part of the same problem.
void Resolver::ResolveFirstOf(const Outlook& outlook, ImpactTime time, const int* position,
                              int count) {
  while (time.first >= 0) {
    if (ResolvePartOf(outlook, time, position, count)) {
      std::fill_n(contacts_.idle, contacts_.count, false);
      return;
    }
    for (int k = 0; k < count; ++k) {
      const int i = position[k];
      if (!contacts_.due[i] || contacts_.tau[i] > time.tau + time.flight) continue;
      contacts_.idle[i] = true;
      contacts_.due[i] = false;
    }
    if (budget_.IsSpent()) return;
    time = FirstClosing(outlook, position, count);
  }
}

Islands Resolver::FindRound(const Outlook& outlook, Scratch& scratch) {
  const mjtNum reach = ReachOfRound(m_, d_, config_, outlook, flight_, contacts_);
  FindNear(m_, d_, outlook, reach, contacts_);
  return FindIslands(m_, mobility_, contacts_.contact, contacts_.due, contacts_.near,
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
    contacts_.relevant[k] = (contacts_.due[k] || moved) && !contacts_.idle[k];
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

}  // namespace

Flights ResolveImpacts(const mjModel* m, mjData* d, int instance, const Mobility& mobility,
                       const mjtNum* kick, State& state, Delivery& delivery, Scratch& scratch) {
  Resolver resolver(m, d, instance, mobility, kick, state, delivery, scratch);
  resolver.Run();
  return resolver.flights();
}

}  // namespace mujoco_impact::engine
