// SPDX-License-Identifier: Apache-2.0

#include "engine/island/delassus.h"

#include <algorithm>
#include <new>

namespace mujoco_impact::engine {

namespace {

// Products by bodies are so much faster, and nothing is computed beforehand; but rows of bodies
// keep the compressed form and its bits.
constexpr double kWorthwhile = 4;

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

// J x of the ties for x = M⁻¹ J_kᵀ (ties).
void TieRates(const Mobility& mobility, const ContactRow& row, mjtNum* rates) {
  mju_zero(rates, mobility.ties());
  for (const RowSegment& segment : row.segment) {
    if (segment.tree >= 0) mobility.AddTieRates(segment.tree, segment.inverse_inertia, rates);
  }
}

// W −= (J M⁻¹ J_tᵀ) (A + R)⁻¹ (J_t M⁻¹ Jᵀ): what the ties J_t take up.
void AddTies(const Mobility& mobility, const ContactRow* row, const law::DelassusMatrix& W,
             mjtNum* value, mjtNum* diagonal, Scratch& scratch) {
  const int ties = mobility.ties();
  mjtNum* rates = scratch.Take<mjtNum>(W.size * ties);
  mjtNum* force = scratch.Take<mjtNum>(ties);
  for (int k = 0; k < W.size; ++k) TieRates(mobility, row[k], rates + k * ties);
  for (int k = 0; k < W.size; ++k) {
    mobility.SolveTies(force, rates + k * ties);
    for (int a = W.row_start[k]; a < W.row_start[k + 1]; ++a) {
      value[a] -= mju_dot(force, rates + W.column[a] * ties, ties);
      if (W.column[a] == k) diagonal[k] = value[a];
    }
  }
}

// Contacts of the island by kinematic tree, tied ones together.
struct ByTree {
  int* start;    // (ntree + 1)
  int* contact;  // positions in the island
};

ByTree SortByTree(const mjModel* m, const Mobility& mobility, const ContactRow* row, int size,
                  Scratch& scratch) {
  ByTree by{scratch.Take<int>(m->ntree + 2), scratch.Take<int>(2 * size)};
  std::fill_n(by.start, m->ntree + 2, 0);
  const auto for_groups = [&](auto visit) {
    for (int k = 0; k < size; ++k) {
      int first = -1;
      for (const RowSegment& segment : row[k].segment) {
        const int group = segment.tree < 0 ? -1 : mobility.Group(segment.tree);
        if (group < 0 || group == first) continue;
        first = group;
        visit(k, group);
      }
    }
  };
  for_groups([&](int, int group) { ++by.start[group + 2]; });
  for (int t = 2; t < m->ntree + 2; ++t) by.start[t] += by.start[t - 1];
  for_groups([&](int k, int group) { by.contact[by.start[group + 1]++] = k; });
  return by;
}

// Calls visit(l) once for every contact l that shares a tree with contact k, itself included.
template <typename Visit>
void ForNeighbours(const Mobility& mobility, const ContactRow* row, const ByTree& by, int k,
                   int* seen, Visit visit) {
  for (const RowSegment& segment : row[k].segment) {
    if (segment.tree < 0) continue;
    const int group = mobility.Group(segment.tree);
    for (int a = by.start[group]; a < by.start[group + 1]; ++a) {
      const int l = by.contact[a];
      if (seen[l] == k) continue;
      seen[l] = k;
      visit(l);
    }
  }
}

law::DelassusMatrix CompressedRows(const mjModel* m, const Mobility& mobility,
                                   const ContactRow* row, int size, const ByTree& by,
                                   Scratch& scratch) {
  int* seen = scratch.Take<int>(size);
  int* row_start = scratch.Take<int>(size + 1);
  std::fill_n(seen, size, -1);
  row_start[0] = 0;
  for (int k = 0; k < size; ++k) {
    row_start[k + 1] = row_start[k];
    ForNeighbours(mobility, row, by, k, seen, [&](int) { ++row_start[k + 1]; });
  }
  int* column = scratch.Take<int>(row_start[size]);
  mjtNum* value = scratch.Take<mjtNum>(row_start[size]);
  mjtNum* diagonal = scratch.Take<mjtNum>(size);
  std::fill_n(seen, size, -1);
  for (int k = 0; k < size; ++k) {
    int a = row_start[k];
    ForNeighbours(mobility, row, by, k, seen, [&](int l) {
      column[a] = l;
      value[a] = Couple(m, row[k], row[l]);
      if (l == k) diagonal[k] = value[a];
      ++a;
    });
  }
  const law::DelassusMatrix W{size, row_start, column, value, diagonal};
  if (mobility.ties() > 0) AddTies(mobility, row, W, value, diagonal, scratch);
  return W;
}

// The rows of a contact on the degrees of freedom of a tree, or of all trees that are tied to it:
// side by side from `offset[tree]` on.
law::BodyRow GroupRow(const mjModel* m, const Mobility& mobility, const RowSegment* row, int group,
                      const int* offset, int dofs, Scratch& scratch) {
  mjtNum* jacobian = scratch.Zeros(dofs);
  mjtNum* answer = scratch.Take<mjtNum>(dofs);
  for (int i = 0; i < 2; ++i) {
    const RowSegment& segment = row[i];
    if (segment.tree < 0 || mobility.Group(segment.tree) != group) continue;
    mju_copy(jacobian + offset[segment.tree], segment.jacobian, m->tree_dofnum[segment.tree]);
  }
  Scratch temporary(mobility.data());
  mjtNum* all = temporary.Zeros(static_cast<int>(m->nv));
  AddAnswer(m, mobility, row, 1, all, temporary);
  for (int tree = 0; tree < m->ntree; ++tree) {
    if (mobility.Group(tree) != group) continue;
    mju_copy(answer + offset[tree], all + m->tree_dofadr[tree], m->tree_dofnum[tree]);
  }
  return {group, jacobian, answer};
}

// The two parts of a row.
void FillParts(const mjModel* m, const Mobility& mobility, const RowSegment* row, const int* offset,
               const int* dofs, law::BodyRow* part, Scratch& scratch) {
  int first = -1;
  for (int i = 0; i < 2; ++i) {
    const auto& [tree, jacobian, inverse_inertia] = row[i];
    const int group = tree < 0 ? -1 : mobility.Group(tree);
    part[i] = {-1, nullptr, nullptr};
    if (group < 0 || group == first) continue;
    first = group;
    part[i] = mobility.ties() == 0
                  ? law::BodyRow{tree, jacobian, inverse_inertia}
                  : GroupRow(m, mobility, row, group, offset, dofs[group], scratch);
  }
}

// A body of the law is a kinematic tree, or those that are tied to each other.
law::DelassusMatrix ByBody(const mjModel* m, const Mobility& mobility, const ContactRow* row,
                           int size, const ByTree& by, Scratch& scratch) {
  const int trees = static_cast<int>(m->ntree);
  int* dof_start = scratch.Take<int>(trees + 1);
  int* offset = scratch.Take<int>(trees);
  int* dofs = GroupDofs(m, mobility, offset, scratch);
  dof_start[0] = 0;
  for (int group = 0; group < trees; ++group) {
    // those without a contact take no room
    const bool any = by.start[group + 1] > by.start[group];
    dof_start[group + 1] = dof_start[group] + (any ? dofs[group] : 0);
  }
  law::BodyRow* part = scratch.Take<law::BodyRow>(2 * size);
  mjtNum* diagonal = scratch.Take<mjtNum>(size);
  mjtNum* work = scratch.Take<mjtNum>(3 * dof_start[trees]);
  auto* rows = new (scratch.Take<law::BodyRows>(1))
      law::BodyRows{trees, dof_start, part, by.start, by.contact, work, scratch.Take<int>(trees)};
  for (int k = 0; k < size; ++k) {
    FillParts(m, mobility, row[k].segment, offset, dofs, part + 2 * k, scratch);
    diagonal[k] = law::Coupling(*rows, k, k);
  }
  return {size, nullptr, nullptr, nullptr, diagonal, rows};
}

}  // namespace

bool IsByBody(const DelassusSize& size) { return kWorthwhile * size.dofs < size.couplings; }

law::BodyRow* RowParts(const mjModel* m, const Mobility& mobility, const RowSegment* const* rows,
                       int number, Scratch& scratch) {
  int* offset = scratch.Take<int>(m->ntree);
  const int* dofs = GroupDofs(m, mobility, offset, scratch);
  auto* part = scratch.Take<law::BodyRow>(2 * number);
  for (int i = 0; i < number; ++i) {
    FillParts(m, mobility, rows[i], offset, dofs, part + 2 * i, scratch);
  }
  return part;
}

int* GroupDofs(const mjModel* m, const Mobility& mobility, int* offset, Scratch& scratch) {
  int* dofs = scratch.Take<int>(m->ntree);
  std::fill_n(dofs, m->ntree, 0);
  for (int tree = 0; tree < m->ntree; ++tree) {
    int& of_group = dofs[mobility.Group(tree)];
    if (offset) offset[tree] = of_group;
    of_group += m->tree_dofnum[tree];
  }
  return dofs;
}

size_t DelassusBytes(const mjModel* m, const Mobility& mobility, int contacts,
                     const DelassusSize& size) {
  const size_t lists = (7 * m->ntree + 4 * contacts + 8) * sizeof(int) + contacts * sizeof(mjtNum);
  if (IsByBody(size)) {
    return lists + 2 * contacts * sizeof(law::BodyRow) +
           (5 * size.dofs + 4 * m->nv) * sizeof(mjtNum);
  }
  const size_t ties = static_cast<size_t>(mobility.ties()) * (contacts + 1) * sizeof(mjtNum);
  return lists + ties + size.couplings * (sizeof(mjtNum) + sizeof(int));
}

law::DelassusMatrix BuildDelassus(const mjModel* m, const Mobility& mobility, const ContactRow* row,
                                  int size, Scratch& scratch) {
  const ByTree by = SortByTree(m, mobility, row, size, scratch);
  const int* dofs = GroupDofs(m, mobility, nullptr, scratch);
  DelassusSize counted{0, 0};
  for (int group = 0; group < m->ntree; ++group) {
    const size_t contacts = by.start[group + 1] - by.start[group];
    counted.couplings += contacts * contacts;
    counted.dofs += contacts * dofs[group];
  }
  return IsByBody(counted) ? ByBody(m, mobility, row, size, by, scratch)
                           : CompressedRows(m, mobility, row, size, by, scratch);
}

}  // namespace mujoco_impact::engine
