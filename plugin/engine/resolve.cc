// SPDX-License-Identifier: Apache-2.0

#include "engine/resolve.h"

#include <algorithm>
#include <cmath>

#include "engine/contact_stiffness.h"
#include "law/hertz_contact.h"
#include "law/impact_law.h"
#include "law/passivity.h"
#include "law/waveform.h"

namespace mujoco_impact::engine {

namespace {

// What an island looks like to the laws.
struct Problem {
  int size;
  mjtNum *closing_speed, *gap, *stiffness;
  mjtNum *impulse, *moment, *onset, *after;  // the solution
  law::Workspace work;
};

Problem MakeProblem(const mjModel* m, const Config& config, const IslandSystem& system,
                    const mjtNum* velocity, Scratch& scratch) {
  const int n = system.size;
  Problem problem{
      n,
      scratch.Take<mjtNum>(n),
      scratch.Take<mjtNum>(n),
      scratch.Take<mjtNum>(n),
      scratch.Zeros(n),
      scratch.Zeros(n),
      scratch.Zeros(n),
      scratch.Take<mjtNum>(n),
      {scratch.Take<mjtNum>(law::ImpactNumbers(n)), scratch.Take<int>(law::ImpactIndices(n))}};
  for (int k = 0; k < n; ++k) {
    const ContactRow& row = system.row[k];
    problem.closing_speed[k] = -RowTimes(m, row, velocity);
    problem.gap[k] = row.gap <= config.touch ? 0 : row.gap;
    problem.stiffness[k] = ContactStiffness(m, config, *row.contact);
  }
  return problem;
}

// W for the contact, from the first moment of its force about the onset: the waveform then has the
// same centre of impulse. A push that is rounding has its moment off by more than it lasts.
mjtNum DurationFromMoment(mjtNum impulse, mjtNum moment, mjtNum onset, mjtNum restitution) {
  constexpr mjtNum kShortest = 1e-12;  // [s]
  return std::max(kShortest, (moment / impulse - onset) / law::WaveformMoment(1, restitution));
}

// How deep the bodies of a contact may overlap and stay with us: deeper, MuJoCo's contact would act
// besides [m].
mjtNum Depth(const mjContact& contact) { return -contact.includemargin; }

// λ ≤ 1 by which a common duration must be shorter for no contact to overlap deeper than its depth.
mjtNum ShortenToDepth(const Config& config, const IslandSystem& system, const Problem& problem,
                      mjtNum duration) {
  mjtNum shortening = 1;
  for (int k = 0; k < problem.size; ++k) {
    if (problem.impulse[k] <= 0) continue;
    const mjtNum depth = Depth(*system.row[k].contact);
    const mjtNum overlap = law::WaveformOverlap(problem.closing_speed[k], duration,
                                                config.waveform_restitution);
    if (overlap * shortening > depth) shortening = depth / overlap;
  }
  return shortening;
}

void SolveHertz(const Config& config, const IslandSystem& system, const ImpactTime& time,
                Problem& problem) {
  const law::ImpactProblem impact{system.delassus,
                                  problem.closing_speed,
                                  problem.gap,
                                  problem.stiffness,
                                  config.restitution,
                                  config.dissipation,
                                  time.timestep - time.start - time.tau,
                                  time.flight,
                                  config.tolerance};
  law::ImpactSolution solution{problem.impulse, problem.moment, problem.onset, problem.after};
  law::SolveImpact(impact, config.passive, &solution, problem.work);
}

mjtNum DurationOf(const Config& config, const Problem& problem, int k) {
  return DurationFromMoment(problem.impulse[k], problem.moment[k], problem.onset[k],
                            config.waveform_restitution);
}

// How deep a contact may press to be called one at a point. What does not expand again, (1 − e²) y,
// is a dent that stays, no deeper than the depth.
mjtNum DeepestCompression(const mjModel* m, const Config& config, const mjContact& contact) {
  constexpr mjtNum kOfRadius = 0.5;
  const mjtNum deepest = kOfRadius / ContactCurvature(m, contact), e = config.restitution;
  if (config.dissipation != law::Dissipation::kBistiffness || e >= 1) return deepest;
  return std::min(deepest, Depth(contact) / (1 - e * e));
}

// λ ≤ 1 by which compressions must be smaller, by the peak forces of the solution, H = K y^(3/2). A
// push that is rounding has a peak without meaning; but it stops no more than P W_kk.
mjtNum CompressLess(const mjModel* m, const Config& config, const IslandSystem& system,
                    const Problem& problem) {
  mjtNum lessening = 1;
  for (int k = 0; k < problem.size; ++k) {
    const mjtNum P = problem.impulse[k];
    if (P <= 0) continue;
    const mjtNum W = DurationOf(config, problem, k);
    const mjtNum deepest = DeepestCompression(m, config, *system.row[k].contact);
    const mjtNum bound = law::WaveformOverlap(P * system.delassus.diagonal[k], W, 1);
    if (bound <= deepest) continue;
    const mjtNum y3_2 = law::WaveformHeight(P, W) / problem.stiffness[k];
    const mjtNum compression = std::min(bound, std::cbrt(y3_2 * y3_2));
    lessening = std::min(lessening, deepest / compression);
  }
  return lessening;
}

// S_k(t) = ∫∫ F_k of the waveform of contact k by time t from the closing.
mjtNum TwiceIntegrated(const Config& config, const Problem& problem, int k, mjtNum t) {
  const mjtNum P = problem.impulse[k];
  if (P <= 0) return 0;
  const mjtNum W = DurationOf(config, problem, k), e = config.waveform_restitution;
  const mjtNum x = (t - problem.onset[k]) / W;
  return P * W * (x * law::WaveformCumulative(x, e) - law::WaveformMoment(x, e));
}

// λ ≤ 1 by which the pulses of more than a step must be shorter for no contact to overlap deeper than
// its depth meanwhile, y(t) = c t − g − W S(t): two waveforms that press a light body from both
// sides are not those of the contacts, whose forces would follow it.
mjtNum ShortenWaveforms(const Config& config, const IslandSystem& system, Problem& problem,
                        mjtNum timestep) {
  mjtNum longest = 0, end = 0;
  for (int k = 0; k < problem.size; ++k) {
    if (problem.impulse[k] <= 0) continue;
    const mjtNum W = DurationOf(config, problem, k);
    longest = std::max(longest, W);
    end = std::max(end, problem.onset[k] + W);
  }
  if (longest <= timestep) return 1;
  constexpr int kSamples = 8;
  mjtNum shortening = 1;
  mjtNum *S = problem.work.numbers, *WS = S + problem.size;
  for (int i = 1; i <= kSamples; ++i) {
    const mjtNum t = i * end / kSamples;
    for (int k = 0; k < problem.size; ++k) S[k] = TwiceIntegrated(config, problem, k, t);
    law::Multiply(system.delassus, S, WS);
    for (int k = 0; k < problem.size; ++k) {
      if (problem.impulse[k] <= 0) continue;
      const mjtNum overlap = problem.closing_speed[k] * t - problem.gap[k] - WS[k];
      const mjtNum depth = Depth(*system.row[k].contact);
      if (overlap > depth) shortening = std::min(shortening, depth / overlap);
    }
  }
  return shortening;
}

// Bodies that would press deeper are made as stiff as they must be, y ~ W ~ K^(−2/5): the impulses
// of bodies that touch do not depend on it, only their times do.
void StiffenToDepth(const mjModel* m, const Config& config, const IslandSystem& system,
                    const ImpactTime& time, Problem& problem) {
  constexpr int kTrials = 5;
  for (int i = 0; i < kTrials; ++i) {
    mjtNum lessening = CompressLess(m, config, system, problem);
    if (InstantRule(config) && lessening >= 1) {
      lessening = ShortenWaveforms(config, system, problem, time.timestep);
    }
    if (lessening >= 1) return;
    mju_scl(problem.stiffness, problem.stiffness, std::pow(lessening, -2.5), problem.size);
    for (mjtNum* solution : {problem.impulse, problem.moment, problem.onset}) {
      mju_zero(solution, problem.size);
    }
    SolveHertz(config, system, time, problem);
  }
}

// P_k = α_k P on every contact that touches (10)-(12), made passive.
void SolveCalibrated(const Config& config, const Ownership& ownership, const IslandSystem& system,
                     int first, mjtNum momentum, Problem& problem, mjtNum* alpha,
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

void ResolveIsland(const mjModel* m, const Config& config, const Ownership& ownership,
                   const IslandSystem& system, const ImpactTime& time, const mjtNum* velocity,
                   Impact* impacts, Scratch& scratch) {
  Problem problem = MakeProblem(m, config, system, velocity, scratch);
  const int first = time.first;
  const mjtNum speed = problem.closing_speed[first];
  std::fill_n(impacts, system.size, Impact{});
  if (speed <= 0) return;

  // the law: impulses
  const mjtNum reduced_mass = 1 / system.delassus.diagonal[first];
  // p = m u of the body that brings the momentum into the contact that closes first
  const mjtNum momentum = IncomingMass(m, system, first, velocity) * speed;
  const mjtNum e = config.waveform_restitution;
  const bool hertz = config.law == Law::kHertz;
  mjtNum* alpha = scratch.Zeros(system.size);
  if (hertz) {
    SolveHertz(config, system, time, problem);
    StiffenToDepth(m, config, system, time, problem);
    // α_k = P_k / P_ref, P_ref = (1 + e) μ u of the contact that closes first
    mju_scl(alpha, problem.impulse, 1 / ((1 + e) * reduced_mass * speed), system.size);
  } else {
    SolveCalibrated(config, ownership, system, first, momentum, problem, alpha, scratch);
  }

  // the waveform: when they come
  const bool timed = InstantRule(config);
  const mjtNum tau = time.start + time.tau;
  mjtNum common = config.duration;
  if (config.duration_rule == DurationRule::kPaper) {
    common = law::CalibratedDuration(config.calibrated, momentum);
  } else if (config.duration_rule == DurationRule::kHertz) {
    common = (1 + e) / 2 * law::ContactTime(problem.stiffness[first], reduced_mass, speed);
  }
  if (!timed) common *= ShortenToDepth(config, system, problem, common);
  const mjtNum centre = law::WaveformMoment(1, e);
  for (int k = 0; k < system.size; ++k) {
    const mjtNum P = problem.impulse[k];
    if (P <= 0) continue;
    const mjtNum onset = timed ? problem.onset[k] : 0;
    const mjtNum W = timed ? DurationOf(config, problem, k) : common;
    const mjtNum moment = timed ? problem.moment[k] : P * W * centre;
    const bool at_once = timed ? W <= time.timestep : tau + W <= time.timestep;
    impacts[k] = {P, alpha[k], tau + onset, W, moment + tau * P, at_once, {}};
  }
}

}  // namespace mujoco_impact::engine
