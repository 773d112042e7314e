// SPDX-License-Identifier: Apache-2.0

#include "engine/resolve/overlap.h"

#include <algorithm>
#include <cmath>

#include "engine/scene/contact_stiffness.h"
#include "law/coulomb.h"
#include "law/hertz_contact.h"
#include "law/waveform.h"

namespace mujoco_impact::engine {

namespace {

// Of 1/(1/R₁ + 1/R₂): beyond, a contact is no longer one at a point.
constexpr mjtNum kOfRadius = 0.5;

// Of the same: overlaps that do not matter to where bodies are.
constexpr mjtNum kTouching = 0.08;

// How much deeper than at the onset bodies may come that may be as deep as that. The deeper they
// are, the less: what else presses meanwhile, and the turning of normals, need room, too.
mjtNum RoomWithin(const ContactRow& row, mjtNum depth) {
  constexpr mjtNum kHalf = 0.5, kOfRest = 0.25, kLeast = 1e-3;
  const mjtNum overlap = std::max<mjtNum>(0, -row.gap);
  return std::max({kHalf * depth - overlap, kOfRest * (depth - overlap), kLeast * depth});
}

mjtNum DepthOf(const ContactRow& row) { return -row.contact->includemargin; }

// 1/(1/R₁ + 1/R₂), and for corners and edges, which are sharper than their bodies are large, half
// of the size of the smaller geom.
mjtNum RadiusOf(const mjModel* m, const ContactRow& row) {
  mjtNum size = mjMAXVAL;
  for (const int geom : row.contact->geom) {
    if (m->geom_rbound[geom] > 0) size = std::min(size, m->geom_rbound[geom]);
  }
  return size < mjMAXVAL ? std::max(1 / row.curvature, 0.5 * size) : 1 / row.curvature;
}

// While an impact lasts.
mjtNum RoomOf(const mjModel* m, const ContactRow& row) {
  return RoomWithin(row, std::max(DepthOf(row), kTouching * RadiusOf(m, row)));
}

// ∫∫ F_k of the waveform by time t.
mjtNum TwiceIntegrated(const IslandProblem& problem, int k, mjtNum t, mjtNum restitution) {
  if (problem.impulse[k] <= 0) return 0;
  const mjtNum W = problem.duration[k], x = (t - problem.onset[k]) / W;
  return problem.impulse[k] * W *
         (x * law::WaveformCumulative(x, restitution) - law::WaveformMoment(x, restitution));
}

// What friction adds to the normal displacements or speeds W x of normal impulses x: each contact
// has its tangential one in the same ratio.
void AddFrictionOf(const IslandSystem& system, const IslandProblem& problem, const mjtNum* x,
                   mjtNum* normal) {
  if (!problem.tangents) return;
  mjtNum* along = problem.work.numbers + 2 * problem.size;
  for (int i = 0; i < 2 * problem.size; ++i) {
    const mjtNum P = problem.impulse[i / 2];
    along[i] = P > 0 ? problem.tangents->impulse[i] / P * x[i / 2] : 0;
  }
  law::AddTangential(system.delassus, problem.tangents->friction, along, normal);
}

// λ at time t, `integral` ∫∫ F_k by then.
mjtNum LessAt(const mjModel* m, const IslandSystem& system, const IslandProblem& problem, mjtNum t,
              const mjtNum* integral) {
  mjtNum* displacement = problem.work.numbers + problem.size;
  law::Multiply(system.delassus, integral, displacement);
  AddFrictionOf(system, problem, integral, displacement);
  mjtNum less = 1;
  for (int k = 0; k < problem.size; ++k) {
    if (problem.impulse[k] <= 0) continue;
    // y = c t − g − W ∫∫ F
    const mjtNum overlap = problem.closing_speed[k] * t - problem.gap[k] - displacement[k];
    const mjtNum room = RoomOf(m, system.row[k]);
    if (overlap > room) less = std::min(less, room / overlap);
  }
  return less;
}

// λ at time t, all impulses delivered with their moments.
mjtNum LessOfMoments(const mjModel* m, const IslandSystem& system, const IslandProblem& problem,
                     mjtNum t) {
  mjtNum* integral = problem.work.numbers;
  for (int k = 0; k < problem.size; ++k) {
    integral[k] = problem.impulse[k] * t - problem.moment[k];
  }
  return LessAt(m, system, problem, t, integral);
}

}  // namespace

mjtNum EndOf(const IslandProblem& problem) {
  mjtNum end = 0;
  for (int k = 0; k < problem.size; ++k) {
    if (problem.impulse[k] > 0) end = std::max(end, problem.onset[k] + problem.duration[k]);
  }
  return end;
}

mjtNum CloseLess(const IslandSystem& system, const IslandProblem& problem) {
  mjtNum less = 1;
  for (int k = 0; k < problem.size; ++k) {
    const mjtNum c = problem.closing_speed[k];
    if (c <= 0) continue;
    const mjtNum deepest = kOfRadius / system.row[k].curvature;
    const mjtNum y =
        law::MaximumCompression(problem.stiffness[k], 1 / system.delassus.diagonal[k], c);
    less = std::min(less, deepest / y);
  }
  return less;
}

mjtNum OverlapLess(const mjModel* m, const Config& config, const IslandSystem& system,
                   const IslandProblem& problem) {
  constexpr int kSamples = 8;
  const mjtNum end = EndOf(problem);
  mjtNum* integral = problem.work.numbers;
  mjtNum less = 1;
  for (int i = 1; i <= kSamples; ++i) {
    const mjtNum t = i * end / kSamples;
    for (int k = 0; k < problem.size; ++k) {
      integral[k] = TwiceIntegrated(problem, k, t, config.waveform_restitution);
    }
    less = std::min(less, LessAt(m, system, problem, t, integral));
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

void PressOutDents(const IslandSystem& system, IslandProblem& problem, mjtNum t) {
  constexpr int kSweeps = 100;
  constexpr mjtNum kOfRoom = 1e-3;
  const law::DelassusMatrix& W = system.delassus;
  mjtNum* free = problem.work.numbers;  // overlap if the impulses came at once
  mjtNum* taken = free + problem.size;
  law::Multiply(W, problem.impulse, free);
  AddFrictionOf(system, problem, problem.impulse, free);
  std::fill_n(taken, problem.size, 0);
  AddFrictionOf(system, problem, problem.moment, taken);
  for (int k = 0; k < problem.size; ++k) {
    free[k] = problem.closing_speed[k] * t - problem.gap[k] - t * free[k] + taken[k];
    taken[k] = 0;
  }
  // y = c t − g − W (P t − M), by projected Gauss-Seidel sweeps; by bodies, W M = J z
  mjtNum* z = W.by_body ? W.by_body->work : nullptr;
  if (z) law::Answer(W, problem.moment, z);
  const auto moved = [&](int k) {
    if (z) return law::RowTimes(*W.by_body, k, z);
    mjtNum sum = 0;
    law::ForRow(W, k, [&](int l, double value) { sum += value * problem.moment[l]; });
    return sum;
  };
  bool settled = false;
  for (int sweep = 0; sweep < kSweeps && !settled; ++sweep) {
    settled = true;
    for (int k = 0; k < problem.size; ++k) {
      if (problem.impulse[k] <= 0) continue;
      const mjtNum room = RoomWithin(system.row[k], DepthOf(system.row[k]));
      const mjtNum excess = free[k] + moved(k) - room;
      mjtNum change = std::max(excess / W.diagonal[k], -taken[k]);
      if (problem.tangents) {
        // what friction makes of a push is not known to be of the same sign: none comes before its
        // contact closes
        const mjtNum most = problem.moment[k] - problem.onset[k] * problem.impulse[k];
        change = std::min(change, std::max<mjtNum>(0, most));
      }
      problem.moment[k] -= change;
      if (z) law::AddAnswer(*W.by_body, k, -change, z);
      taken[k] += change;
      if (std::abs(change) * W.diagonal[k] > kOfRoom * room) settled = false;
    }
  }
}

bool MayComeAtOnce(const mjModel* m, const IslandSystem& system, const IslandProblem& problem,
                   mjtNum time) {
  return LessOfMoments(m, system, problem, time) >= 1;
}

}  // namespace mujoco_impact::engine
