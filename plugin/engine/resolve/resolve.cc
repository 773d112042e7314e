// SPDX-License-Identifier: Apache-2.0

#include "engine/resolve/resolve.h"

#include <algorithm>
#include <cmath>

#include "engine/resolve/island_problem.h"
#include "engine/resolve/overlap.h"
#include "engine/scene/texts.h"
#include "law/friction_guard.h"
#include "law/friction_on_disc.h"
#include "law/hertz_contact.h"
#include "law/impact_clock.h"
#include "law/impact_law.h"
#include "law/passivity.h"
#include "law/stopping_impulses.h"
#include "law/waveform.h"

namespace mujoco_impact::engine {

namespace {

// W for the contact, from the first moment of its force about the onset: the waveform then has the
// same centre of impulse. A push that is rounding has its moment off by more than it lasts.
mjtNum DurationFromMoment(mjtNum impulse, mjtNum moment, mjtNum onset, mjtNum restitution) {
  constexpr mjtNum kShortest = 1e-12;  // [s]
  return std::max(kShortest, (moment / impulse - onset) / law::WaveformMoment(1, restitution));
}

// Where the law writes.
law::ImpactSolution SolutionOf(const IslandProblem& problem) {
  law::ImpactSolution solution{problem.impulse, problem.moment, problem.onset, problem.after,
                               problem.peak};
  if (const Tangents* tangents = problem.tangents) {
    solution.friction = tangents->impulse;
    solution.friction_moment = tangents->moment;
    solution.slip = tangents->after;
  }
  return solution;
}

// False if the impact was cut short for want of work.
bool SolveHertz(const Config& config, const IslandSystem& system, const ImpactTime& time,
                Budget& budget, IslandProblem& problem) {
  const law::ImpactProblem impact{system.delassus,
                                  problem.closing_speed,
                                  problem.gap,
                                  problem.stiffness,
                                  problem.restitution,
                                  config.dissipation,
                                  std::min(time.horizon, time.left()),
                                  time.flight,
                                  config.tolerance,
                                  budget.OfLaw(),
                                  budget.OfEnd(),
                                  time.longest,
                                  problem.tangents ? &problem.tangents->friction : nullptr};
  for (mjtNum* solution : {problem.impulse, problem.moment, problem.onset, problem.peak}) {
    mju_zero(solution, problem.size);
  }
  if (problem.tangents) mju_zero(problem.tangents->impulse, 2 * problem.size);
  law::ImpactSolution solution = SolutionOf(problem);
  const law::ImpactReport report =
      law::SolveImpact(impact, config.passive, &solution, problem.work);
  budget.Spend(report.work);
  for (int k = 0; k < problem.size; ++k) {
    if (problem.impulse[k] <= 0) continue;
    problem.duration[k] = DurationFromMoment(problem.impulse[k], problem.moment[k],
                                             problem.onset[k], problem.restitution[k]);
  }
  return report.converged;
}

// P_k = α_k P on every contact that touches (10)-(12), made passive.
void SolveCalibrated(const Config& config, const Ownership& ownership, const IslandSystem& system,
                     int first, mjtNum momentum, IslandProblem& problem, mjtNum* alpha,
                     Scratch& scratch) {
  const int pairs = ownership.size() - 1;
  mjtNum* alphas = scratch.Take<mjtNum>(pairs);
  ReadList(config.alpha, alphas, pairs);
  const mjtNum common = law::CalibratedImpulse(config.calibrated, momentum);
  for (int k = 0; k < problem.size; ++k) {
    const mjContact& contact = *system.row[k].contact;
    const int i = ownership.Index(contact.geom[0]), j = ownership.Index(contact.geom[1]);
    const bool neighbours = i >= 0 && j >= 0 && std::abs(i - j) == 1;
    alpha[k] = neighbours ? alphas[std::min(i, j)] : 1;
    const bool touches = k == first || problem.gap[k] == 0;
    problem.impulse[k] = touches ? alpha[k] * common : 0;
  }
  if (!config.passive) return;
  const mjtNum scale = law::PassiveScale(system.delassus, problem.closing_speed, problem.impulse,
                                         problem.work.numbers);
  if (scale < 1) mju_scl(problem.impulse, problem.impulse, scale, problem.size);
}

bool IsElastic(const IslandProblem& problem) {
  const mjtNum* e = problem.restitution;
  return std::all_of(e, e + problem.size, [](mjtNum one) { return one == 1; });
}

bool AreShorter(const IslandProblem& problem, mjtNum time) {
  for (int k = 0; k < problem.size; ++k) {
    if (problem.impulse[k] > 0 && problem.duration[k] > time) return false;
  }
  return true;
}

// Gives all contacts one pulse of the duration W, or as much shorter as their depth asks for, and
// of the shape of the least elastic: what came earlier at one contact than at another would move
// bodies into each other. Returns whether the impulses come at once.
bool SetCommonPulse(const mjModel* m, const IslandSystem& system, const ImpactTime& time,
                    mjtNum duration, IslandProblem& problem) {
  std::fill_n(problem.onset, problem.size, 0);
  std::fill_n(problem.peak, problem.size, 0);
  std::fill_n(problem.duration, problem.size, duration);
  const mjtNum e = *std::min_element(problem.restitution, problem.restitution + problem.size);
  std::fill_n(problem.restitution, problem.size, e);
  const mjtNum less = std::min(OverlapLess(m, system, problem), TurnLess(system, problem));
  mju_scl(problem.duration, problem.duration, less, problem.size);
  const mjtNum centre = law::WaveformMoment(1, e);
  for (int k = 0; k < problem.size; ++k) {
    problem.moment[k] = problem.impulse[k] * problem.duration[k] * centre;
  }
  return AreShorter(problem, time.left());
}

// Solves the Hertz law with bodies that are as stiff as they must be to stay within their depth, y
// ~ W ~ K^(−2/5): the impulses of bodies that touch do not depend on it, only their times do. What
// closes after a flight is left for later accordingly. Where all that is not enough, contacts share
// one pulse. Returns whether the impulses come at once.
bool SolveWithinDepth(const mjModel* m, const Config& config, const IslandSystem& system,
                      ImpactTime time, mjtNum contact_time, Budget& budget, mjtNum* stiffer,
                      IslandProblem& problem) {
  constexpr int kTrials = 5;
  // of steps: a contact that lasts longer has parted long before another closes a step later
  constexpr mjtNum kLasting = 1.5;
  bool at_once = false;
  if (contact_time > kLasting * time.timestep) time.longest = std::min(time.longest, time.timestep);
  mjtNum all_less = 1;
  const auto stiffen = [&](mjtNum less) {
    all_less *= less;
    *stiffer = std::min(*stiffer, all_less);
    mju_scl(problem.stiffness, problem.stiffness, std::pow(less, -2.5), problem.size);
    time.flight *= less;
  };
  // within the bounds, or rounding would decide
  const mjtNum less_at_once = CloseLess(system, problem);
  if (const mjtNum less = std::min(less_at_once < 1 ? 0.9 * less_at_once : 1, *stiffer); less < 1) {
    stiffen(less);
  }
  for (int i = 0;; ++i) {
    const bool over = SolveHertz(config, system, time, budget, problem);
    mjtNum less = TurnLess(system, problem);
    if (InstantRule(config) && less >= 1) {
      if (!IsElastic(problem)) {
        PressOutDents(system, problem, std::max(EndOf(problem), time.left()));
      }
      at_once =
          AreShorter(problem, time.short_of) && MayComeAtOnce(m, system, problem, time.left());
      if (!at_once) less = OverlapLess(m, system, problem);
    }
    if (less >= 1) return at_once;
    // an impact that does not end is none of stiffness
    if (i == kTrials || !over) break;
    // gaps do not shrink along, so the more later on
    less *= i == 0 ? 0.9 : 0.25;
    stiffen(less);
  }
  return SetCommonPulse(m, system, time, EndOf(problem), problem);
}

// Friction of a contact alone that sticks: within its cone it stops the slip that the bodies have
// when they part, a time t after v was taken, Q = −W_tt⁻¹ (v + a t + W_tn P). A ball that falls
// straight down has no more for its weight.
void StopSlip(const mjModel* m, const mjtNum* acceleration, mjtNum time, const IslandSystem& system,
              IslandProblem& problem) {
  const Tangents& tangents = *problem.tangents;
  const law::TangentBlock own = law::OwnBlock(system.delassus, tangents.friction, 0);
  mjtNum slip[2];
  for (int i = 0; i < 2; ++i) {
    slip[i] = tangents.friction.slip[i] + own.tn[i] * problem.impulse[0] +
              time * SegmentsTimes(m, tangents.row[i].segment, acceleration);
  }
  const law::Pair stop = law::Times(law::Inverse(law::Lifted(own.tt)), law::At(slip));
  const mjtNum size = std::hypot(stop[0], stop[1]);
  const mjtNum most = tangents.friction.mu[0] * problem.impulse[0];
  law::Put(tangents.impulse, (size > most ? -most / size : -1) * stop);
}

// Gravity goes on while bodies touch, and the contact carries them all the while, for the time W
// that it lasts. With the impulse P at its centre t, W = (1 + e)/e t. All impulses are scaled by
//
//   Σ (c_k + a_k t'_k) P_k / Σ c_k P_k,   a_k the rate of c_k by forces other than the impulses,
//                                         t'_k = W_k − t_k later than the contact closes
//
// with which a single contact is left with e times the speed with which it closed. In an elastic
// impact, t' = t, it is the speed at which the impulses do their work, and the energy is kept.
// Times are from when c_k was taken.
void CountForcesMeanwhile(const mjModel* m, const IslandSystem& system, const mjtNum* acceleration,
                          mjtNum seen, IslandProblem& problem) {
  constexpr mjtNum kMost = 0.1;  // beyond, bodies are pressed and not struck
  mjtNum work = 0, meanwhile = 0;
  for (int k = 0; k < problem.size; ++k) {
    if (problem.impulse[k] <= 0) continue;
    // t' / t; what hardly parts stays in touch longer than that, and is carried by MuJoCo
    const mjtNum after = 1 / std::max<mjtNum>(problem.restitution[k], 0.2);
    work += problem.closing_speed[k] * problem.impulse[k];
    const mjtNum until = problem.impulse[k] * (problem.onset[k] - seen) +
                         after * (problem.moment[k] - problem.onset[k] * problem.impulse[k]);
    meanwhile -= RowTimes(m, system.row[k], acceleration) * until;
  }
  if (work <= 0 || std::abs(meanwhile) > kMost * work) return;
  for (mjtNum* numbers : {problem.impulse, problem.moment, problem.peak}) {
    mju_scl(numbers, numbers, 1 + meanwhile / work, problem.size);
  }
  if (!problem.tangents) return;
  mjtNum* friction = problem.tangents->impulse;
  mju_scl(friction, friction, 1 + meanwhile / work, 2 * problem.size);
  constexpr mjtNum kStopped = 1e-6;
  const mjtNum *before = problem.tangents->friction.slip, *slip = problem.tangents->after;
  const bool sticks = std::hypot(slip[0], slip[1]) <= kStopped * std::hypot(before[0], before[1]);
  if (problem.size == 1 && sticks && !mju_isZero(friction, 2)) {
    StopSlip(m, acceleration, problem.onset[0] + problem.duration[0] - seen, system, problem);
  }
}

// The contact that gives an impact its scale: the one that closes first or, if that is by rounding
// alone, the one that closes fastest.
int ReferenceOf(const IslandProblem& problem, int first) {
  const mjtNum* c = problem.closing_speed;
  return c[first] > 0 ? first : static_cast<int>(std::max_element(c, c + problem.size) - c);
}

// ΔT [J] by the impulses as they are, the tangential ones included.
mjtNum ChangeWithFriction(const IslandSystem& system, const IslandProblem& problem) {
  law::ImpactProblem impact{};
  impact.delassus = system.delassus;
  impact.closing_speed = problem.closing_speed;
  impact.friction = &problem.tangents->friction;
  law::ImpactSolution solution = SolutionOf(problem);
  law::SpeedsAfter(impact, solution);
  return law::KineticEnergyChange(impact, solution);
}

// −ΔT over the sum of impulses.
mjtNum LossPerImpulse(const IslandSystem& system, const IslandProblem& problem) {
  const mjtNum change = problem.tangents
                            ? ChangeWithFriction(system, problem)
                            : law::KineticEnergyChange(system.delassus, problem.closing_speed,
                                                       problem.impulse, problem.work.numbers);
  mjtNum sum = 0;
  for (int k = 0; k < problem.size; ++k) sum += problem.impulse[k];
  return sum > 0 ? std::max<mjtNum>(0, -change) / sum : 0;
}

// Whether impulses can stop all contacts from closing. Where a mocap body presses another against
// what cannot give way they cannot, and every bounce between the two would add its speed.
bool CanStop(const mjModel* m, const IslandSystem& system, const IslandProblem& problem,
             Budget& budget, Scratch& scratch) {
  constexpr mjtNum kGives = 1e-6, kStopped = 1e-3, kFloor = 1e-6, kWorkOfRow = 1e4;
  const int n = system.size;
  const auto is_driven = [](const ContactRow& row) { return Norm(row.driven) > 0; };
  if (std::none_of(system.row, system.row + n, is_driven)) return true;
  for (int k = 0; k < n; ++k) {
    // without what ties and joint stops take of it
    mjtNum alone = 0;
    for (const auto& [tree, jacobian, inverse_inertia] : system.row[k].segment) {
      if (tree >= 0) alone += mju_dot(jacobian, inverse_inertia, m->tree_dofnum[tree]);
    }
    if (is_driven(system.row[k]) && system.delassus.diagonal[k] < kGives * alone) return false;
  }
  const mjtNum fastest = *std::max_element(problem.closing_speed, problem.closing_speed + n);
  if (fastest <= 0) return true;
  const auto arrays = static_cast<int>(law::StoppingImpulses::kArrays);
  law::StoppingImpulses stopping(system.delassus, scratch.Take<mjtNum>(arrays * n));
  stopping.Solve(problem.closing_speed, scratch.Zeros(n), kFloor * fastest, kWorkOfRow * n);
  budget.Spend(stopping.work());
  return *std::max_element(stopping.after(), stopping.after() + n) <= kStopped * fastest;
}

}  // namespace

mjtNum IncomingMass(const mjModel* m, const IslandSystem& system, int k, const mjtNum* velocity) {
  mjtNum inverse_mass = system.delassus.diagonal[k], fastest = 0;
  for (const RowSegment& segment : system.row[k].segment) {
    if (segment.tree < 0) continue;
    const int dofs = m->tree_dofnum[segment.tree];
    const mjtNum towards =
        -mju_dot(segment.jacobian, velocity + m->tree_dofadr[segment.tree], dofs);
    if (towards <= fastest) continue;
    fastest = towards;
    inverse_mass = mju_dot(segment.jacobian, segment.inverse_inertia, dofs);
  }
  return 1 / inverse_mass;
}

void ResolveIsland(const mjModel* m, const Config& config, const Materials& materials,
                   const Ownership& ownership, const IslandSystem& system, const ImpactTime& time,
                   const mjtNum* velocity, const mjtNum* acceleration, Tangents* tangents,
                   Budget& budget, mjtNum* stiffer, Impact* impacts, Scratch& scratch) {
  IslandProblem problem = MakeProblem(m, config, materials, system, velocity, tangents, scratch);
  const int first = ReferenceOf(problem, time.first);
  const mjtNum speed = problem.closing_speed[first];
  std::fill_n(impacts, system.size, Impact{});
  if (speed <= 0 || !CanStop(m, system, problem, budget, scratch)) return;

  // the law: impulses
  const mjtNum reduced_mass = 1 / system.delassus.diagonal[first];
  // p = m u of the body that brings the momentum into the contact that closes first
  const mjtNum momentum = IncomingMass(m, system, first, velocity) * speed;
  const mjtNum e = problem.restitution[first];
  mjtNum* alpha = scratch.Zeros(system.size);
  bool at_once = false;
  if (config.law == Law::kHertz) {
    // of the fastest, not of the first: of several that close together any may be that
    const mjtNum* c = problem.closing_speed;
    const auto fastest = std::max_element(c, c + problem.size) - c;
    const mjtNum contact_time = law::ContactTime(problem.stiffness[fastest],
                                                 1 / system.delassus.diagonal[fastest], c[fastest]);
    at_once = SolveWithinDepth(m, config, system, time, contact_time, budget, stiffer, problem);
    if (at_once) CountForcesMeanwhile(m, system, acceleration, time.seen, problem);
    // α_k = P_k / P_ref, P_ref = (1 + e) μ u of the contact that closes first
    mju_scl(alpha, problem.impulse, 1 / ((1 + e) * reduced_mass * speed), system.size);
  } else {
    SolveCalibrated(config, ownership, system, first, momentum, problem, alpha, scratch);
  }

  // the waveform: when they come
  if (!InstantRule(config)) {
    mjtNum W = config.duration;
    if (config.duration_rule == DurationRule::kPaper) {
      W = law::CalibratedDuration(config.calibrated, momentum);
    } else if (config.duration_rule == DurationRule::kHertz) {
      W = (1 + e) / 2 * law::ContactTime(problem.stiffness[first], reduced_mass, speed);
    }
    at_once = SetCommonPulse(m, system, time, W, problem);
  }
  const mjtNum tau = time.start + time.tau;
  const mjtNum loss = LossPerImpulse(system, problem);
  for (int k = 0; k < system.size; ++k) {
    const mjtNum P = problem.impulse[k];
    if (P <= 0) continue;
    impacts[k] = {P,
                  alpha[k],
                  tau + problem.onset[k],
                  problem.duration[k],
                  problem.restitution[k],
                  problem.peak[k],
                  problem.moment[k] + tau * P,
                  loss * P,
                  at_once,
                  problem.closing_speed[k],
                  {}};
  }
}

}  // namespace mujoco_impact::engine
