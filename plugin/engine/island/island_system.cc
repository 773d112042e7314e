// SPDX-License-Identifier: Apache-2.0

#include "engine/island/island_system.h"

#include <algorithm>
#include <new>

#include "engine/island/delassus.h"
#include "engine/island/islands.h"
#include "engine/island/tangents.h"
#include "engine/scene/contact_stiffness.h"
#include "engine/scene/tree_kinds.h"
#include "law/impact_law.h"

namespace mujoco_impact::engine {

namespace {

RowSegment MakeSegment(const mjModel* m, int tree, Scratch& scratch) {
  if (tree < 0) return {-1, nullptr, nullptr};
  const int dofs = m->tree_dofnum[tree];
  return {tree, scratch.Zeros(dofs), scratch.Take<mjtNum>(dofs)};
}

Vector3 DrivenVelocity(const mjModel* m, const mjData* d, const MocapRecord* mocap,
                       const ContactRow& row, mjtNum tau) {
  Vector3 velocity[2];
  for (int i = 0; i < 2; ++i) {
    const Vector3 surface =
        SurfacePoint(m, row.contact->geom[i], i, row.path.SideAt(i, tau), row.normal);
    velocity[i] = MocapVelocity(m, d, mocap, row.path.side(i).body, surface);
  }
  return velocity[0] - velocity[1];
}

void FillRow(const mjModel* m, const mjData* d, const Motion& motion, mjtNum tau, mjtNum begin,
             ContactRow& row, Scratch& scratch) {
  row.normal = row.path.Normal(tau);
  row.gap = row.path.Gap(begin);
  row.curvature = ContactCurvature(m, d, *row.contact);
  row.turn_rate = row.path.TurnRate(tau);
  if (motion.mocap) row.driven = DrivenVelocity(m, d, motion.mocap, row, tau);
  const ContactTrees trees = TreesOf(m, *row.contact);
  const bool merged = trees.tree[0] == trees.tree[1];
  row.segment[0] = MakeSegment(m, trees.tree[0], scratch);
  row.segment[1] = MakeSegment(m, merged ? -1 : trees.tree[1], scratch);
  // d gap = n·(dx₂ − dx₁)
  for (int i = 0; i < 2; ++i) {
    if (trees.tree[i] < 0) continue;
    const RowSegment& segment = row.segment[merged ? 0 : i];
    AddRowAt(m, d, row.path.side(i), motion, tau, row.path.SideAt(i, tau), row.normal,
             i == 0 ? -1 : 1, segment.jacobian);
  }
  SolveSegments(m, d, row.segment);
}

}  // namespace

size_t IslandBytes(const mjModel* m, const Mobility& mobility, const Gathered& contacts,
                   const int* position, int count, bool friction, Scratch& scratch) {
  // a contact couples with every contact of its trees
  int* on_group = scratch.Take<int>(m->ntree);
  std::fill_n(on_group, m->ntree, 0);
  const int* group_dofs = GroupDofs(m, mobility, nullptr, scratch);
  size_t dofs = 0;
  DelassusSize size{0, 0};
  for (int i = 0; i < count; ++i) {
    int last = -1;
    for (const int tree : TreesOf(m, *contacts.contact[position[i]]).tree) {
      if (tree < 0) continue;
      dofs += m->tree_dofnum[tree];
      const int group = mobility.Group(tree);
      if (group == last) continue;
      last = group;
      size.couplings += 2 * on_group[group]++ + 1;
      size.dofs += group_dofs[group];
    }
  }
  // the workspace of the law, and the list of α
  const size_t laws = law::ImpactNumbers(count, friction) * sizeof(double) +
                      law::ImpactIndices(count) * sizeof(int) + m->ngeom * sizeof(mjtNum);
  // an IslandProblem, whether its contacts can be stopped, and the lists of the Delassus matrix;
  // what arrays are aligned by
  constexpr size_t kPerContact = 23 * sizeof(mjtNum), kAlignment = 512;
  const size_t tangents = friction ? TangentBytes(m, mobility, count, dofs, size) : 0;
  return kAlignment + laws + tangents + DelassusBytes(m, mobility, count, size) +
         count * (sizeof(ContactRow) + sizeof(Impact) + kPerContact) +
         (2 * dofs + 8 * m->nv) * sizeof(mjtNum);
}

IslandSystem BuildIsland(const mjModel* m, const mjData* d, const Mobility& mobility,
                         Gathered& contacts, const int* position, int count, const Motion& motion,
                         mjtNum tau, mjtNum begin, Scratch& scratch) {
  IslandSystem system{count, scratch.Take<ContactRow>(count), {}};
  for (int k = 0; k < count; ++k) {
    const int i = position[k];
    ContactRow* row =
        new (&system.row[k]) ContactRow{contacts.contact[i],
                                        ContactPath(m, d, Anchor(m, d, contacts, i), motion),
                                        {},
                                        0,
                                        0,
                                        0,
                                        {},
                                        {}};
    FillRow(m, d, motion, tau, begin, *row, scratch);
  }
  system.delassus = BuildDelassus(m, mobility, system.row, count, scratch);
  return system;
}

mjtNum SegmentsTimes(const mjModel* m, const RowSegment segment[2], const mjtNum* x) {
  mjtNum sum = 0;
  for (int i = 0; i < 2; ++i) {
    const auto& [tree, jacobian, inverse_inertia] = segment[i];
    if (tree >= 0) sum += mju_dot(jacobian, x + m->tree_dofadr[tree], m->tree_dofnum[tree]);
  }
  return sum;
}

void SolveSegments(const mjModel* m, const mjData* d, const RowSegment segment[2]) {
  for (int i = 0; i < 2; ++i) {
    const auto& [tree, jacobian, inverse_inertia] = segment[i];
    if (tree < 0) continue;
    mju_copy(inverse_inertia, jacobian, m->tree_dofnum[tree]);
    SolveTreeInertia(m, d, tree, inverse_inertia);
  }
}

mjtNum RowTimes(const mjModel* m, const ContactRow& row, const mjtNum* x) {
  return SegmentsTimes(m, row.segment, x);
}

void AddUntied(const mjModel* m, const RowSegment row[2], mjtNum s, mjtNum* x) {
  for (int i = 0; i < 2; ++i) {
    const auto& [tree, jacobian, inverse_inertia] = row[i];
    if (tree >= 0) mju_addToScl(x + m->tree_dofadr[tree], inverse_inertia, s, m->tree_dofnum[tree]);
  }
}

void AddAnswer(const mjModel* m, const Mobility& mobility, const RowSegment row[2], mjtNum s,
               mjtNum* x, Scratch& scratch) {
  mjtNum* answer = mobility.ties() > 0 ? scratch.Zeros(m->nv) : x;
  AddUntied(m, row, s, answer);
  if (mobility.ties() == 0) return;
  mobility.Tie(answer);
  mju_addTo(x, answer, m->nv);
}

}  // namespace mujoco_impact::engine
