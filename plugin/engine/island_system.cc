// SPDX-License-Identifier: Apache-2.0

#include "engine/island_system.h"

#include <algorithm>
#include <new>

#include "engine/islands.h"

namespace mujoco_impact::engine {

namespace {

RowSegment MakeSegment(const mjModel* m, int tree, Scratch& scratch) {
  if (tree < 0) return {-1, nullptr, nullptr};
  const int dofs = m->tree_dofnum[tree];
  return {tree, scratch.Zeros(dofs), scratch.Take<mjtNum>(dofs)};
}

void FillRow(const mjModel* m, const mjData* d, const Motion& motion, mjtNum tau, ContactRow& row,
             Scratch& scratch) {
  row.normal = row.path.Normal(tau);
  row.gap = row.path.Gap(tau);
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

// J_k M⁻¹ J_lᵀ
mjtNum Couple(const mjModel* m, const ContactRow& k, const ContactRow& l) {
  mjtNum sum = 0;
  for (const RowSegment& a : k.segment) {
    for (const RowSegment& b : l.segment) {
      if (a.tree < 0 || a.tree != b.tree) continue;
      sum += mju_dot(a.jacobian, b.inverse_inertia, m->tree_dofnum[a.tree]);
    }
  }
  return sum;
}

// Contacts of the island by kinematic tree.
struct ByTree {
  int* start;    // (ntree + 1)
  int* contact;  // positions in the island
};

ByTree SortByTree(const mjModel* m, const IslandSystem& system, Scratch& scratch) {
  ByTree by{scratch.Take<int>(m->ntree + 2), scratch.Take<int>(2 * system.size)};
  std::fill_n(by.start, m->ntree + 2, 0);
  for (int k = 0; k < system.size; ++k) {
    for (const RowSegment& segment : system.row[k].segment) {
      if (segment.tree >= 0) ++by.start[segment.tree + 2];
    }
  }
  for (int t = 2; t < m->ntree + 2; ++t) by.start[t] += by.start[t - 1];
  for (int k = 0; k < system.size; ++k) {
    for (const RowSegment& segment : system.row[k].segment) {
      if (segment.tree >= 0) by.contact[by.start[segment.tree + 1]++] = k;
    }
  }
  return by;
}

// Calls visit(l) once for every contact l that shares a tree with contact k, itself included.
template <typename Visit>
void ForNeighbours(const IslandSystem& system, const ByTree& by, int k, int* seen, Visit visit) {
  for (const RowSegment& segment : system.row[k].segment) {
    if (segment.tree < 0) continue;
    for (int a = by.start[segment.tree]; a < by.start[segment.tree + 1]; ++a) {
      const int l = by.contact[a];
      if (seen[l] == k) continue;
      seen[l] = k;
      visit(l);
    }
  }
}

law::DelassusMatrix BuildDelassus(const mjModel* m, const IslandSystem& system, Scratch& scratch) {
  const int n = system.size;
  const ByTree by = SortByTree(m, system, scratch);
  int* seen = scratch.Take<int>(n);
  int* row_start = scratch.Take<int>(n + 1);
  std::fill_n(seen, n, -1);
  row_start[0] = 0;
  for (int k = 0; k < n; ++k) {
    row_start[k + 1] = row_start[k];
    ForNeighbours(system, by, k, seen, [&](int) { ++row_start[k + 1]; });
  }
  int* column = scratch.Take<int>(row_start[n]);
  mjtNum* value = scratch.Take<mjtNum>(row_start[n]);
  mjtNum* diagonal = scratch.Take<mjtNum>(n);
  std::fill_n(seen, n, -1);
  for (int k = 0; k < n; ++k) {
    int a = row_start[k];
    ForNeighbours(system, by, k, seen, [&](int l) {
      column[a] = l;
      value[a] = Couple(m, system.row[k], system.row[l]);
      if (l == k) diagonal[k] = value[a];
      ++a;
    });
  }
  return {n, row_start, column, value, diagonal};
}

}  // namespace

size_t IslandBytes(const mjModel* m, const mjData* d, const Gathered& contacts, const int* position,
                   int count, Scratch& scratch) {
  // a contact couples with every contact of its trees
  int* on_tree = scratch.Take<int>(m->ntree);
  std::fill_n(on_tree, m->ntree, 0);
  size_t dofs = 0, couples = 0;
  for (int i = 0; i < count; ++i) {
    for (const int tree : TreesOf(m, d->contact[contacts.contact[position[i]]]).tree) {
      if (tree < 0) continue;
      dofs += m->tree_dofnum[tree];
      couples += 2 * on_tree[tree]++ + 1;
    }
  }
  // of the Delassus matrix, the laws and the resolution
  constexpr size_t kPerContact = 768;
  return count * (sizeof(ContactRow) + kPerContact) + couples * (sizeof(mjtNum) + sizeof(int)) +
         (2 * dofs + m->nv) * sizeof(mjtNum) + 4 * m->ntree * sizeof(int);
}

IslandSystem BuildIsland(const mjModel* m, const mjData* d, Gathered& contacts, const int* position,
                         int count, const Motion& motion, mjtNum tau, Scratch& scratch) {
  IslandSystem system{count, scratch.Take<ContactRow>(count), {}};
  for (int k = 0; k < count; ++k) {
    const int i = position[k];
    ContactRow* row =
        new (&system.row[k]) ContactRow{&d->contact[contacts.contact[i]],
                                        ContactPath(m, d, Anchor(m, d, contacts, i), motion),
                                        {},
                                        0,
                                        {}};
    FillRow(m, d, motion, tau, *row, scratch);
  }
  system.delassus = BuildDelassus(m, system, scratch);
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

void AddRowTransposed(const mjModel* m, const ContactRow& row, mjtNum s, mjtNum* x) {
  for (const RowSegment& segment : row.segment) {
    if (segment.tree < 0) continue;
    mju_addToScl(x + m->tree_dofadr[segment.tree], segment.jacobian, s,
                 m->tree_dofnum[segment.tree]);
  }
}

}  // namespace mujoco_impact::engine
