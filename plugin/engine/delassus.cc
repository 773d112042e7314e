// SPDX-License-Identifier: Apache-2.0

#include "engine/delassus.h"

#include <algorithm>
#include <new>

namespace mujoco_impact::engine {

namespace {

// Products by bodies are so much faster, and nothing is computed beforehand; but rows of bodies
// keep the compressed form and its bits.
constexpr double kWorthwhile = 4;

// Whether W is to be by bodies. What ties couple has no such form.
bool IsByBody(const Mobility& mobility, size_t couplings, size_t dofs) {
  return mobility.ties() == 0 && kWorthwhile * dofs < couplings;
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
  for (int k = 0; k < size; ++k) {
    for (const RowSegment& segment : row[k].segment) {
      if (segment.tree >= 0) ++by.start[mobility.Group(segment.tree) + 2];
    }
  }
  for (int t = 2; t < m->ntree + 2; ++t) by.start[t] += by.start[t - 1];
  for (int k = 0; k < size; ++k) {
    for (const RowSegment& segment : row[k].segment) {
      if (segment.tree >= 0) by.contact[by.start[mobility.Group(segment.tree) + 1]++] = k;
    }
  }
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

// A body of the law is a kinematic tree.
law::DelassusMatrix ByBody(const mjModel* m, const ContactRow* row, int size, const ByTree& by,
                           Scratch& scratch) {
  int* dof_start = scratch.Take<int>(m->ntree + 1);
  law::BodyRow* part = scratch.Take<law::BodyRow>(2 * size);
  mjtNum* diagonal = scratch.Take<mjtNum>(size);
  dof_start[0] = 0;
  for (int tree = 0; tree < m->ntree; ++tree) {
    // those without a contact take no room
    const bool any = by.start[tree + 1] > by.start[tree];
    dof_start[tree + 1] = dof_start[tree] + (any ? m->tree_dofnum[tree] : 0);
  }
  mjtNum* work = scratch.Take<mjtNum>(3 * dof_start[m->ntree]);
  auto* rows = new (scratch.Take<law::BodyRows>(1))
      law::BodyRows{static_cast<int>(m->ntree), dof_start, part, by.start, by.contact, work,
                    scratch.Take<int>(m->ntree)};
  for (int k = 0; k < size; ++k) {
    for (int i = 0; i < 2; ++i) {
      const auto& [tree, jacobian, inverse_inertia] = row[k].segment[i];
      part[2 * k + i] = {tree, jacobian, inverse_inertia};
    }
    diagonal[k] = law::Coupling(*rows, k, k);
  }
  return {size, nullptr, nullptr, nullptr, diagonal, rows};
}

// Of W, counted without building it.
void CountCouplings(const mjModel* m, const ByTree& by, size_t* couplings, size_t* dofs) {
  *couplings = *dofs = 0;
  for (int tree = 0; tree < m->ntree; ++tree) {
    const size_t contacts = by.start[tree + 1] - by.start[tree];
    *couplings += contacts * contacts;
    *dofs += contacts * m->tree_dofnum[tree];
  }
}

}  // namespace

size_t DelassusBytes(const mjModel* m, const Mobility& mobility, int size, size_t couplings,
                     size_t dofs) {
  const size_t lists = (5 * m->ntree + 4 * size + 8) * sizeof(int) + size * sizeof(mjtNum);
  if (IsByBody(mobility, couplings, dofs)) {
    return lists + 2 * size * sizeof(law::BodyRow) + 3 * dofs * sizeof(mjtNum);
  }
  const size_t ties = static_cast<size_t>(mobility.ties()) * (size + 1) * sizeof(mjtNum);
  return lists + ties + couplings * (sizeof(mjtNum) + sizeof(int));
}

law::DelassusMatrix BuildDelassus(const mjModel* m, const Mobility& mobility, const ContactRow* row,
                                  int size, Scratch& scratch) {
  const ByTree by = SortByTree(m, mobility, row, size, scratch);
  size_t couplings, dofs;
  CountCouplings(m, by, &couplings, &dofs);
  return IsByBody(mobility, couplings, dofs) ? ByBody(m, row, size, by, scratch)
                                             : CompressedRows(m, mobility, row, size, by, scratch);
}

}  // namespace mujoco_impact::engine
