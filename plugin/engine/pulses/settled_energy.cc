// SPDX-License-Identifier: Apache-2.0

#include "engine/pulses/settled_energy.h"

#include <algorithm>
#include <cmath>

#include "engine/common/tree_sets.h"
#include "engine/deliver/deliver.h"
#include "engine/path/point.h"
#include "engine/pulses/held.h"
#include "engine/pulses/line_of_action.h"

namespace mujoco_impact::engine {

namespace {

// D, a and c of a set of bodies.
struct Balance {
  mjtNum difference, quadratic, slope;
};

// JᵀR of all pulses under way along the lines of the last step and of this one (nv each).
struct Impulses {
  mjtNum *before, *now;
};

int TreeOf(const mjModel* m, const Pulse& pulse, int side) {
  const int last = LastDof(m, BodyOf(m, pulse, side));
  return last < 0 ? -1 : m->dof_treeid[last];
}

int MovingTree(const mjModel* m, const Pulse& pulse) {
  const int first = TreeOf(m, pulse, 0);
  return first >= 0 ? first : TreeOf(m, pulse, 1);
}

void Join(const mjModel* m, const Pulse& pulse, TreeSets& sets) {
  const int first = TreeOf(m, pulse, 0), second = TreeOf(m, pulse, 1);
  if (first >= 0 && second >= 0) sets.Join(first, second);
}

TreeSets JoinedByTies(const mjModel* m, const Mobility& mobility, Scratch& scratch) {
  TreeSets sets(m->ntree, scratch);
  for (int tree = 0; tree < m->ntree; ++tree) sets.Join(tree, mobility.Group(tree));
  return sets;
}

// v·p + ½ pᵀM⁻¹p on the dofs of a tree: T is a sum over kinematic trees.
mjtNum Work(const mjModel* m, const mjData* d, int tree, const mjtNum* impulse,
            const mjtNum* change) {
  const int begin = m->tree_dofadr[tree], end = begin + m->tree_dofnum[tree];
  mjtNum work = 0;
  for (int i = begin; i < end; ++i) work += (d->qvel[i] + 0.5 * change[i]) * impulse[i];
  return work;
}

// Adds what a tree contributes.
void AddTree(const mjModel* m, const mjData* d, int tree, const Impulses& impulses,
             const Impulses& changes, Balance& balance) {
  const int begin = m->tree_dofadr[tree], end = begin + m->tree_dofnum[tree];
  for (int i = begin; i < end; ++i) {
    const mjtNum before = impulses.before[i], now = impulses.now[i];
    const mjtNum mean_change = 0.5 * (changes.before[i] + changes.now[i]);
    balance.difference += (d->qvel[i] + mean_change) * (before - now);
    balance.quadratic += 0.5 * now * changes.now[i];
    balance.slope += (d->qvel[i] + changes.now[i]) * now;
  }
}

mjtNum ScaleOf(const Balance& balance, mjtNum restitution) {
  const auto [difference, a, c] = balance;
  if (a <= 0) return 1;
  const mjtNum D = difference > 0 ? restitution * restitution * difference : difference;
  const mjtNum discriminant = c * c + 4 * a * D;
  const mjtNum sigma =
      discriminant <= 0 ? -c / (2 * a) : 2 * D / (c + std::copysign(std::sqrt(discriminant), c));
  return std::max<mjtNum>(0, 1 + sigma);
}

// Σ JᵀR of the pulses under way, or of the part of it that comes in this step, along the lines now.
void AddScaled(const mjModel* m, const mjData* d, State& state, bool of_step, mjtNum* impulse) {
  const mjtNum clock = state.header().clock, h = m->opt.timestep;
  ForPulsesUnderWay(state, [&](Pulse& pulse) {
    const mjtNum part = of_step ? ShareOfStep(pulse, clock, h).impulse : pulse.remaining();
    AddPulseRow(m, d, pulse, pulse.line_next, part, impulse);
  });
}

// Ends the sets of pulses that have more energy, or would after this step, than they are to leave
// and their impacts still lose, as they may where a new impact came between.
void EndOverfull(const mjModel* m, const mjData* d, const Mobility& mobility, TreeSets& sets,
                 State& state, Scratch& scratch) {
  mjtNum* impulse[2] = {scratch.Zeros(m->nv), scratch.Zeros(m->nv)};
  mjtNum* change[2] = {scratch.Take<mjtNum>(m->nv), scratch.Take<mjtNum>(m->nv)};
  for (const bool of_step : {false, true}) {
    AddScaled(m, d, state, of_step, impulse[of_step]);
    mobility.Solve(change[of_step], impulse[of_step]);
  }
  // work of the step, of all there is to come, what rounds it, and energy that may be lost
  mjtNum* work = scratch.Zeros(m->ntree);
  mjtNum* scale = scratch.Zeros(m->ntree);
  mjtNum* all = scratch.Zeros(m->ntree);
  mjtNum* loss = scratch.Zeros(m->ntree);
  for (int tree = 0; tree < m->ntree; ++tree) {
    work[sets.Root(tree)] += Work(m, d, tree, impulse[1], change[1]);
    all[sets.Root(tree)] += Work(m, d, tree, impulse[0], change[0]);
    const int begin = m->tree_dofadr[tree], dofs = m->tree_dofnum[tree];
    scale[sets.Root(tree)] += mju_dot(impulse[0] + begin, change[0] + begin, dofs);
  }
  ForPulsesUnderWay(state,
                    [&](Pulse& pulse) { loss[sets.Root(MovingTree(m, pulse))] += pulse.loss; });
  ForPulsesUnderWay(state, [&](Pulse& pulse) {
    const int set = sets.Root(MovingTree(m, pulse));
    const mjtNum rounding = 1e-9 * scale[set];
    const bool will_be = work[set] > std::max<mjtNum>(all[set] + loss[set], 0) + rounding;
    const bool is = all[set] < -loss[set] - rounding;
    if (will_be || is) pulse.finishing = 1;
  });
}

}  // namespace

void FollowLines(const mjModel* m, const mjData* d, const Mobility& mobility, State& state,
                 Scratch& scratch) {
  const Impulses impulses{scratch.Zeros(m->nv), scratch.Zeros(m->nv)};
  ForPulsesUnderWay(state, [&](Pulse& pulse) {
    const mjtNum remaining = pulse.scale * pulse.impulse * (1 - pulse.delivered);
    pulse.line_next = LineNow(m, d, pulse);
    AddPulseRow(m, d, pulse, pulse.line, remaining, impulses.before);
    AddPulseRow(m, d, pulse, pulse.line_next, remaining, impulses.now);
  });
  const Impulses changes{scratch.Take<mjtNum>(m->nv), scratch.Take<mjtNum>(m->nv)};
  mobility.Solve(changes.before, impulses.before);
  mobility.Solve(changes.now, impulses.now);

  TreeSets sets = JoinedByTies(m, mobility, scratch);
  ForPulsesUnderWay(state, [&](const Pulse& pulse) { Join(m, pulse, sets); });
  Balance* balances = scratch.Take<Balance>(m->ntree);
  std::fill_n(balances, m->ntree, Balance{});
  for (int tree = 0; tree < m->ntree; ++tree) {
    AddTree(m, d, tree, impulses, changes, balances[sets.Root(tree)]);
  }
  ForPulsesUnderWay(state, [&](Pulse& pulse) {
    const Balance& balance = balances[sets.Root(MovingTree(m, pulse))];
    pulse.scale_next = pulse.scale * ScaleOf(balance, pulse.restitution);
  });
  EndOverfull(m, d, mobility, sets, state, scratch);
}

void EndOverfullByImpacts(const mjModel* m, mjData* d, const Mobility& ties, State& state,
                          const Delivery& delivery, Scratch& scratch) {
  const Mobility mobility = HeldAfter(m, d, ties, state, scratch);
  TreeSets sets = JoinedByTies(m, mobility, scratch);
  mjtNum* all = scratch.Take<mjtNum>(m->nv);
  mjtNum* change[2] = {scratch.Take<mjtNum>(m->nv), scratch.Take<mjtNum>(m->nv)};
  mju_copy(all, delivery.impulse, m->nv);
  const Delivery late = MakeDelivery(m, scratch);
  ForPulsesOfStep(state, [&](const Pulse& pulse) {
    Join(m, pulse, sets);
    AddPulseRow(m, d, pulse, pulse.line_next, pulse.remaining_next(), all);
    AddPulseRow(m, d, pulse, pulse.line_next, pulse.remaining_next(), late.remaining);
  });
  mobility.AddStops(late.remaining, all, scratch);
  mobility.Solve(change[0], delivery.impulse);
  mobility.Solve(change[1], all);
  // work beyond what all pulses will have done, less the energy that may be lost, and its rounding
  mjtNum* over = scratch.Zeros(m->ntree);
  mjtNum* scale = scratch.Zeros(m->ntree);
  for (int tree = 0; tree < m->ntree; ++tree) {
    over[sets.Root(tree)] +=
        Work(m, d, tree, delivery.impulse, change[0]) - Work(m, d, tree, all, change[1]);
    const int begin = m->tree_dofadr[tree], dofs = m->tree_dofnum[tree];
    scale[sets.Root(tree)] += mju_dot(all + begin, change[1] + begin, dofs);
  }
  ForPulsesOfStep(state, [&](const Pulse& pulse) {
    if (pulse.delivered_next < 1) over[sets.Root(MovingTree(m, pulse))] -= pulse.loss;
  });
  const mjtNum clock = state.header().clock, h = m->opt.timestep;
  ForPulsesOfStep(state, [&](Pulse& pulse) {
    const int set = sets.Root(MovingTree(m, pulse));
    if (over[set] <= 1e-9 * scale[set]) return;
    const mjtNum rest = pulse.remaining_next();
    const mjtNum when = std::clamp(pulse.onset - clock, 0.5 * h, h);
    for (const Delivery* sums : {&delivery, &late}) {
      AddPulseRow(m, d, pulse, pulse.line_next, rest, sums->impulse);
      AddPulseRow(m, d, pulse, pulse.line_next, when * rest, sums->moment);
      AddPulseRow(m, d, pulse, pulse.line_next, when * when * rest, sums->second);
    }
    pulse.delivered_next = 1;
  });
  mobility.AddStops(late.impulse, delivery.impulse, scratch);
  mobility.AddStops(late.moment, delivery.moment, scratch);
  mobility.AddStops(late.second, delivery.second, scratch);
}

}  // namespace mujoco_impact::engine
