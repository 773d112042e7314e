// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <limits>

#include "engine/handover/silent_rows.h"
#include "engine/island/tangents.h"
#include "engine/path/inertia_there.h"
#include "engine/record/slots.h"
#include "engine/resolve/friction.h"
#include "engine/resolve/reach.h"
#include "engine/resolve/resolver.h"
#include "engine/scene/tree_kinds.h"
#include "law/stopping_impulses.h"

namespace mujoco_impact::engine {

// Delivers the part of a new pulse that belongs to this step: all of it, by its moment, if the
// impact comes at once.
Share Resolver::AddImpact(const ContactRow& row, const ImpactTime& time, const Impact& impact) {
  const Pulse pulse = MakePulse(m_, d_, row, time.tau, impact, state_);
  const Share whole{impact.impulse, impact.moment, 1};
  const Share share =
      impact.at_once ? whole : ShareOfStep(pulse, state_.header().clock, m_->opt.timestep);
  AddPending(m_, ownership_, state_, pulse, share.delivered_next);
  for (const RowSegment& segment : row.segment) AddShare(segment, time, share);
  struck_.Add(row, share.impulse, impact.impulse - share.impulse);
  return share;
}

// To each tree in its own way: bodies that fly are changed there, what was found at another inertia
// is a change of velocity, all else an impulse.
void Resolver::AddShare(const RowSegment& segment, const ImpactTime& time, const Share& share) {
  if (segment.tree < 0) return;
  Scratch scratch(d_);
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
  if (!scratch.Fits(Mobility::StopBytes(m_, mobility_, stops_))) return false;
  const Mobility mobility(mobility_, stops_, scratch);
  const bool friction = HasFriction(materials_, contacts_, position, count);
  size_t bytes = IslandBytes(m_, mobility, contacts_, position, count, friction, scratch);
  if (config_.friction == Friction::kPaper) bytes += FrictionBytes(m_, bytes);
  return scratch.Fits(bytes);
}

// Takes from the velocity at a time what the bodies fall until then that MuJoCo's contacts carry:
// by forces on the contacts of an island,
//
//   f ≥ 0  ⊥  J (a + M̃⁻¹Jᵀ f) ≥ 0    a: free acceleration
//
// A body that lies on a table must not be met, nor bounce, as if it fell. The forces are a little
// larger: what they are not exact to must not close a contact, which would be an impact.
void Resolver::HoldUp(const Mobility& mobility, const IslandSystem& system, const int* position,
                      mjtNum time, mjtNum* velocity) {
  // what pulses under way do to the bodies is no fall
  if (start_.bend) return;
  constexpr mjtNum kExact = 1e-4;
  constexpr mjtNum kOpen = std::numeric_limits<mjtNum>::infinity();
  const int n = system.size;
  Scratch scratch(d_);
  mjtNum *fall = scratch.Zeros(n), *bound = scratch.Take<mjtNum>(n);
  mjtNum* acceleration = scratch.Take<mjtNum>(m_->nv);
  mju_copy(acceleration, start_.motion.acceleration, m_->nv);
  mobility.Halt(acceleration);
  mjtNum fastest = 0;
  for (int k = 0; k < n; ++k) {
    const mjContact& contact = *system.row[k].contact;
    const bool carried =
        IsCarried(contact) && !IsSilent(d_, contact) && !contacts_.due[position[k]];
    bound[k] = carried ? 0 : kOpen;
    if (!carried) continue;
    fall[k] = -time * RowTimes(m_, system.row[k], acceleration);
    fastest = std::max(fastest, fall[k]);
  }
  if (fastest == 0 || budget_.IsLow()) return;
  law::StoppingImpulses support(system.delassus,
                                scratch.Take<mjtNum>(law::StoppingImpulses::kArrays * n));
  for (int k = 0; k < n; ++k) fall[k] += 2 * kExact * fastest;
  support.Solve(fall, bound, kExact * fastest, budget_.OfEnd());
  budget_.Spend(support.work());
  for (int k = 0; k < n; ++k) {
    if (support.impulse()[k] == 0) continue;
    Scratch of_row(d_);
    AddAnswer(m_, mobility, system.row[k].segment, support.impulse()[k], velocity, of_row);
  }
}

// The impacts of an island with the stops that hold now. Of bodies that have been moved there for
// it, the geometry is that of where they are; else that of when the first contact closes.
IslandSolution Resolver::TryIsland(const Outlook& outlook, ImpactTime time, const int* position,
                                   int count, Scratch& scratch) {
  const mjtNum seen = there_ ? 0 : time.tau;
  time.seen = seen - time.tau;
  const Mobility mobility(mobility_, stops_, scratch);
  IslandSolution island{mobility,
                        BuildIsland(m_, d_, mobility, contacts_, position, count, outlook.motion,
                                    seen, time.tau, scratch),
                        scratch.Take<Impact>(count)};
  IslandSystem& system = island.system;
  const bool friction = HasFriction(materials_, contacts_, position, count);
  for (int k = 0; k < count; ++k) budget_.SpendRow(m_, system.row[k], friction ? 3 : 1);
  // a tumbling body turns away from a pulse that lasts, whose line stays as it was
  constexpr mjtNum kShortSteps = 4;
  if (AnyFlies(system)) time.short_of = kShortSteps * m_->opt.timestep;
  mjtNum* velocity = SettledVelocity(m_, outlook, seen, scratch);
  // what stands at a stop that holds stands still
  mobility.Halt(velocity);
  HoldUp(mobility, system, position, PathLag(m_) + outlook.start + seen, velocity);
  mjtNum* acceleration = scratch.Take<mjtNum>(m_->nv);
  mju_addScl(acceleration, steady_, start_.motion.jerk, outlook.start + seen, m_->nv);
  mobility.Halt(acceleration);
  Tangents* tangents = nullptr;
  if (friction) {
    tangents = BuildTangents(m_, d_, mobility, materials_, system, outlook.motion, seen, velocity,
                             scratch);
  }
  ResolveIsland(m_, config_, materials_, ownership_, system, time, velocity, acceleration, tangents,
                budget_, &stiffer_, island.impacts, scratch);
  if (tangents) TurnRows(m_, *tangents, system, island.impacts);
  if (config_.friction == Friction::kPaper) {
    AddFriction(m_, d_, config_, outlook.motion, seen, velocity, system, island.impacts, scratch);
  }
  return island;
}

// Solves an island, and again until the stops that hold are those that its impulses push, and calls
// use(island); where that does not come to an end, none holds. False if it needs more memory than
// there is.
template <typename Use>
bool Resolver::SolveIsland(const Outlook& outlook, const ImpactTime& time, const int* position,
                           int count, Use use) {
  constexpr int kTrials = 8;
  const mjtNum stiffer = stiffer_;
  stops_.Look(outlook.motion, there_ ? 0 : time.tau);
  for (int trial = 1;; ++trial) {
    if (!FitsIsland(position, count)) return false;
    Scratch scratch(d_);
    stiffer_ = stiffer;
    const IslandSolution island = TryIsland(outlook, time, position, count, scratch);
    if (trial <= kTrials && !budget_.IsSpent() && ChangesStops(outlook, time, island)) {
      if (trial == kTrials) stops_.Release();
      continue;
    }
    use(island);
    return true;
  }
}

// False if no contact pushes.
bool Resolver::ResolveIslandOf(const Outlook& outlook, ImpactTime time, const int* position,
                               int count) {
  int64_t pushes = 0;
  const bool fits = SolveIsland(outlook, time, position, count, [&](const IslandSolution& island) {
    pushes = std::count_if(island.impacts, island.impacts + count,
                           [](const Impact& impact) { return impact.impulse > 0; });
    if (pushes == 0) return;
    if (!HasRoom(state_, static_cast<int>(pushes))) ComeAtOnce(time, count, island.impacts);
    AddImpacts(island, time, position);
  });
  if (fits) return pushes > 0;
  mju_warning(
      "mujoco_impact.waveform: an impact of %d contacts needs more memory than mjData has left "
      "and is skipped; raise <size memory=\"...\"/> in the model",
      count);
  return true;
}

// How long after its first contact closes the impulses of an island come on the average [s]; 0 if
// they last on.
mjtNum Resolver::CentreOf(const Outlook& outlook, const ImpactTime& time, const int* position,
                          int count) {
  mjtNum impulse = 0, moment = 0;
  bool lasts = false;
  Scratch scratch(d_);
  const InertiaThere inertia(m_, d_, scratch);
  SolveIsland(outlook, time, position, count, [&](const IslandSolution& island) {
    for (int k = 0; k < count; ++k) {
      const Impact& impact = island.impacts[k];
      lasts = lasts || (impact.impulse > 0 && !impact.at_once);
      impulse += impact.impulse;
      moment += impact.moment;
    }
  });
  return impulse > 0 && !lasts ? moment / impulse - time.start - time.tau : 0;
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

void Resolver::AddImpacts(const IslandSolution& island, const ImpactTime& time,
                          const int* position) {
  const IslandSystem& system = island.system;
  Scratch scratch(d_);
  Share* shares = scratch.Take<Share>(system.size);
  mjtNum end = time.start + time.tau;
  for (int k = 0; k < system.size; ++k) {
    const Impact& impact = island.impacts[k];
    shares[k] = {};
    if (impact.impulse > 0) {
      shares[k] = AddImpact(system.row[k], time, impact);
      end = std::max(end, impact.onset + impact.duration);
    } else if (contacts_.due[position[k]]) {
      left_ = std::min(left_, time.start + contacts_.tau[position[k]]);
    }
  }
  round_end_ = std::min(round_end_, end);
  for (int k = 0; k < system.size; ++k) {
    if (island.impacts[k].impulse > 0) struck_.TakeUntil(system.row[k], end);
  }
  AddStops(island, time, shares, end);
}

// Resolves the island from the first contact on whose closing is an impact. What closes within the
// flight of one that pushes nothing was part of the same problem.
void Resolver::ResolveFirstOf(const Outlook& outlook, ImpactTime time, const int* position,
                              int count) {
  while (time.first >= 0) {
    if (ResolveIslandOf(outlook, time, position, count)) return;
    for (int k = 0; k < count; ++k) {
      const int i = position[k];
      if (!contacts_.due[i] || contacts_.tau[i] > time.tau + time.flight) continue;
      contacts_.due[i] = false;
    }
    if (budget_.IsSpent()) return;
    time = FirstClosing(outlook, position, count);
  }
}

}  // namespace mujoco_impact::engine
