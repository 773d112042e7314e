// SPDX-License-Identifier: Apache-2.0

#include "engine/overlap.h"

#include <algorithm>
#include <cmath>

#include "engine/contact_stiffness.h"
#include "law/hertz_contact.h"
#include "law/waveform.h"

namespace mujoco_impact::engine {

namespace {

// Of M: what else presses meanwhile, and the turning of normals, need room, too.
constexpr mjtNum kOfDepth = 0.5;

// Of 1/(1/R₁ + 1/R₂): beyond, a contact is no longer one at a point.
constexpr mjtNum kOfRadius = 0.5;

// How much deeper than at the onset bodies may come. The nearer to M they are, the less.
mjtNum RoomOf(const ContactRow& row) {
  constexpr mjtNum kOfRest = 0.25, kLeast = 1e-3;
  const mjtNum depth = -row.contact->includemargin, overlap = std::max<mjtNum>(0, -row.gap);
  return std::max({kOfDepth * depth - overlap, kOfRest * (depth - overlap), kLeast * depth});
}

// ∫∫ F_k of the waveform by time t.
mjtNum TwiceIntegrated(const IslandProblem& problem, int k, mjtNum t, mjtNum restitution) {
  if (problem.impulse[k] <= 0) return 0;
  const mjtNum W = problem.duration[k], x = (t - problem.onset[k]) / W;
  return problem.impulse[k] * W *
         (x * law::WaveformCumulative(x, restitution) - law::WaveformMoment(x, restitution));
}

// λ at time t, `integral` ∫∫ F_k by then.
mjtNum LessAt(const IslandSystem& system, const IslandProblem& problem, mjtNum t,
              const mjtNum* integral) {
  mjtNum* displacement = problem.work.numbers + problem.size;
  law::Multiply(system.delassus, integral, displacement);
  mjtNum less = 1;
  for (int k = 0; k < problem.size; ++k) {
    if (problem.impulse[k] <= 0) continue;
    // y = c t − g − W ∫∫ F
    const mjtNum overlap = problem.closing_speed[k] * t - problem.gap[k] - displacement[k];
    const mjtNum room = RoomOf(system.row[k]);
    if (overlap > room) less = std::min(less, room / overlap);
  }
  return less;
}

// λ at time t, all impulses delivered with their moments.
mjtNum LessOfMoments(const IslandSystem& system, const IslandProblem& problem, mjtNum t) {
  mjtNum* integral = problem.work.numbers;
  for (int k = 0; k < problem.size; ++k) {
    integral[k] = problem.impulse[k] * t - problem.moment[k];
  }
  return LessAt(system, problem, t, integral);
}

}  // namespace

mjtNum EndOf(const IslandProblem& problem) {
  mjtNum end = 0;
  for (int k = 0; k < problem.size; ++k) {
    if (problem.impulse[k] > 0) end = std::max(end, problem.onset[k] + problem.duration[k]);
  }
  return end;
}

mjtNum CloseLess(const mjModel* m, const Config& config, const IslandSystem& system,
                 const IslandProblem& problem) {
  mjtNum less = 1;
  for (int k = 0; k < problem.size; ++k) {
    const mjtNum c = problem.closing_speed[k];
    if (c <= 0) continue;
    const mjtNum deepest = kOfRadius / ContactCurvature(m, *system.row[k].contact);
    const mjtNum y =
        law::MaximumCompression(problem.stiffness[k], 1 / system.delassus.diagonal[k], c);
    // (1 − e²) of it is left when the contact has expanded
    const mjtNum dent = (1 - config.restitution * config.restitution) * y;
    less = std::min({less, deepest / y, RoomOf(system.row[k]) / std::max(dent, mjMINVAL)});
  }
  return less;
}

mjtNum CompressLess(const mjModel* m, const IslandSystem& system, const IslandProblem& problem) {
  mjtNum less = 1;
  for (int k = 0; k < problem.size; ++k) {
    const mjtNum P = problem.impulse[k], W = problem.duration[k];
    if (P <= 0) continue;
    const mjtNum deepest = kOfRadius / ContactCurvature(m, *system.row[k].contact);
    // a push that is rounding has a peak without meaning, but stops no more than P W_kk
    const mjtNum bound = P * system.delassus.diagonal[k] * W;
    if (bound <= deepest) continue;
    const mjtNum y3_2 = law::WaveformHeight(P, W) / problem.stiffness[k];
    less = std::min(less, deepest / std::min(bound, std::cbrt(y3_2 * y3_2)));
  }
  return less;
}

mjtNum OverlapLess(const Config& config, const IslandSystem& system, const IslandProblem& problem) {
  constexpr int kSamples = 8;
  const mjtNum end = EndOf(problem);
  mjtNum* integral = problem.work.numbers;
  mjtNum less = 1;
  for (int i = 1; i <= kSamples; ++i) {
    const mjtNum t = i * end / kSamples;
    for (int k = 0; k < problem.size; ++k) {
      integral[k] = TwiceIntegrated(problem, k, t, config.waveform_restitution);
    }
    less = std::min(less, LessAt(system, problem, t, integral));
  }
  return less;
}

mjtNum TurnLess(const IslandSystem& system, const IslandProblem& problem) {
  constexpr mjtNum kMostTurn = 0.3;  // [rad]
  mjtNum less = 1;
  for (int k = 0; k < problem.size; ++k) {
    if (problem.impulse[k] <= 0) continue;
    const mjtNum turn = system.row[k].turn_rate * problem.duration[k];
    if (turn * less > kMostTurn) less = kMostTurn / turn;
  }
  return less;
}

mjtNum DentLess(const IslandSystem& system, const IslandProblem& problem) {
  return LessOfMoments(system, problem, EndOf(problem));
}

bool MayComeAtOnce(const IslandSystem& system, const IslandProblem& problem, mjtNum time) {
  return LessOfMoments(system, problem, time) >= 1;
}

}  // namespace mujoco_impact::engine
