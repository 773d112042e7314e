// SPDX-License-Identifier: Apache-2.0

#include "engine/resolve/struck.h"

#include <algorithm>

#include "engine/scene/tree_kinds.h"

namespace mujoco_impact::engine {

namespace {

// Marks of kinematic trees within a round.
constexpr int kUntouched = 0, kAtHand = 1, kStruck = 2;

}  // namespace

Struck::Struck(const mjModel* m, mjData* d, const Mobility& mobility, Scratch& scratch)
    : m_(m),
      d_(d),
      mobility_(mobility),
      busy_(scratch.Take<mjtNum>(m->ntree)),
      mark_(scratch.Take<int>(m->ntree)),
      kicked_{scratch.Take<mjtNum>(m->nv), nullptr, nullptr},
      owed_(scratch.Zeros(static_cast<int>(m->nv))) {
  std::fill_n(busy_, m->ntree, -m->opt.timestep);  // before any closing, late ones included
}

void Struck::BeginRound(const Motion& path) {
  std::fill_n(mark_, m_->ntree, kUntouched);
  mju_copy(kicked_.velocity, path.velocity, m_->nv);
  kicked_.acceleration = path.acceleration;
  kicked_.jerk = path.jerk;
  kicked_.mocap = path.mocap;
}

// Visits the trees that an impulse of the contact moves.
template <typename Visit>
void Struck::ForMoved(const ContactRow& row, Visit visit) const {
  for (const RowSegment& segment : row.segment) {
    if (segment.tree < 0) continue;
    visit(segment.tree);
    if (mobility_.ties() == 0) continue;
    for (int tree = 0; tree < m_->ntree; ++tree) {
      if (mobility_.AreTied(tree, segment.tree)) visit(tree);
    }
  }
}

void Struck::Add(const ContactRow& row, mjtNum delivered, mjtNum rest) {
  Scratch scratch(d_);
  AddAnswer(m_, mobility_, row.segment, delivered, kicked_.velocity, scratch);
  ForMoved(row, [this](int tree) { mark_[tree] = kStruck; });
  if (rest <= 0) return;
  AddAnswer(m_, mobility_, row.segment, rest, owed_, scratch);
  owes_ = true;
}

void Struck::AddStop(const Mobility& ties, int i, mjtNum delivered, mjtNum rest, mjtNum end) {
  Scratch scratch(d_);
  mjtNum* kick = scratch.Take<mjtNum>(m_->nv);
  mju_copy(kick, ties.answer(i), m_->nv);
  mobility_.Tie(kick);
  mju_addToScl(kicked_.velocity, kick, delivered, m_->nv);
  mju_addToScl(owed_, kick, rest, m_->nv);
  ties.ForTrees(i, [this, end](int tree, int) {
    mark_[tree] = kStruck;
    busy_[tree] = end;
  });
}

void Struck::TakeUntil(const ContactRow& row, mjtNum end) {
  ForMoved(row, [this, end](int tree) { busy_[tree] = end; });
}

void Struck::TakeForPulses(const State& state, mjtNum end) {
  ForPulsesUnderWay(state, [&](const Pulse& pulse) {
    for (int side = 0; side < 2; ++side) {
      const int tree = m_->body_treeid[BodyOf(m_, pulse, side)];
      if (tree >= 0) busy_[tree] = end;
    }
  });
}

bool Struck::Moved(const mjContact& contact) const {
  for (const int tree : TreesOf(m_, contact).tree) {
    if (tree >= 0 && busy_[tree] > -m_->opt.timestep) return true;
  }
  return false;
}

void Struck::Mark(const Gathered& contacts, const int* position, int count, int mark) {
  for (int k = 0; k < count; ++k) {
    for (const int tree : TreesOf(m_, *contacts.contact[position[k]]).tree) {
      if (tree >= 0) mark_[tree] = mark;
    }
  }
}

bool Struck::MayReach(Gathered& contacts, const int* position, int count, mjtNum tau) {
  // the estimate knows neither when the body was struck nor gravity
  constexpr mjtNum kSafety = 0.8;
  Mark(contacts, position, count, kAtHand);
  bool reached = false;
  for (int k = 0; k < contacts.count && !reached; ++k) {
    const auto [first, second] = TreesOf(m_, *contacts.contact[k]).tree;
    if (first < 0 || second < 0 || mark_[first] + mark_[second] != kAtHand + kStruck) continue;
    const ContactPath path(m_, d_, Anchor(m_, d_, contacts, k), kicked_);
    reached = kSafety * path.Gap(0) < -path.GapRate(0) * tau;
  }
  Mark(contacts, position, count, kUntouched);
  return reached;
}

}  // namespace mujoco_impact::engine
