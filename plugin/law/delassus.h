// SPDX-License-Identifier: Apache-2.0
// The Delassus matrix W = J M⁻¹ Jᵀ of an island, in the form in which it is cheaper to multiply by.
//
// Compressed rows serve contacts that couple with few others: a row of balls has a tridiagonal W.
// Where many contacts are of the same bodies (a face, a body of many geoms, a pile) W is large and
// of low rank, and W x = J (M⁻¹ Jᵀ x) costs contacts × degrees of freedom instead of contacts².

#ifndef MUJOCO_IMPACT_LAW_DELASSUS_H_
#define MUJOCO_IMPACT_LAW_DELASSUS_H_

#include "law/pair.h"

namespace mujoco_impact::law {

// The part of a contact's row that lies on one body. A body here is any set of degrees of freedom
// that M does not couple with others.
struct BodyRow {
  int body;              // −1: none
  const double* row;     // J_k on the degrees of freedom of the body
  const double* answer;  // M⁻¹ J_kᵀ on them
};

// W by bodies. A contact joins two bodies at most, and no body twice.
struct BodyRows {
  int bodies;
  const int* dof_start;      // (bodies + 1) into a vector of the degrees of freedom
  const BodyRow* part;       // (2 size): contact k has the parts 2 k and 2 k + 1
  const int* contact_start;  // (bodies + 1) into `contact`
  const int* contact;        // the contacts of each body
  double* work;              // (3 dof_start[bodies]), whatever is in it
  int* mark;                 // (bodies), the same

  int dofs() const { return dof_start[bodies]; }
  int dofs(int body) const { return dof_start[body + 1] - dof_start[body]; }
};

// Symmetric positive semidefinite, with its diagonal, either in compressed rows or by bodies.
struct DelassusMatrix {
  int size;
  const int* row_start;               // (size + 1)
  const int* column;                  // (row_start[size])
  const double* value;                // (row_start[size]) [1/kg]
  const double* diagonal;             // (size) [1/kg], > 0
  const BodyRows* by_body = nullptr;  // if set, there are no compressed rows
};

// a·b
inline double DotByPairs(const double* a, const double* b, int n) {
  Pair sum{};
  for (int i = 0; i + 1 < n; i += 2) sum += At(a + i) * At(b + i);
  return sum[0] + sum[1] + (n & 1 ? a[n - 1] * b[n - 1] : 0);
}

// J_k M⁻¹ J_lᵀ by bodies, of row k of some rows and row l of some others.
inline double Coupling(const BodyRows& rows, const BodyRows& others, int k, int l) {
  double sum = 0;
  for (int i = 2 * k; i < 2 * k + 2; ++i) {
    const auto& [body, row, unused] = rows.part[i];
    if (body < 0) continue;
    for (int j = 2 * l; j < 2 * l + 2; ++j) {
      if (others.part[j].body == body) {
        sum += DotByPairs(row, others.part[j].answer, rows.dofs(body));
      }
    }
  }
  return sum;
}

// W_kl by bodies.
inline double Coupling(const BodyRows& rows, int k, int l) { return Coupling(rows, rows, k, l); }

// z += M⁻¹ J_kᵀ x
inline void AddAnswer(const BodyRows& rows, int k, double x, double* z) {
  for (int i = 2 * k; i < 2 * k + 2; ++i) {
    const auto& [body, unused, answer] = rows.part[i];
    if (body < 0) continue;
    double* of_body = z + rows.dof_start[body];
    for (int j = 0, n = rows.dofs(body); j < n; ++j) of_body[j] += answer[j] * x;
  }
}

// J_k z
inline double RowTimes(const BodyRows& rows, int k, const double* z) {
  double sum = 0;
  for (int i = 2 * k; i < 2 * k + 2; ++i) {
    const auto& [body, row, unused] = rows.part[i];
    if (body >= 0) sum += DotByPairs(row, z + rows.dof_start[body], rows.dofs(body));
  }
  return sum;
}

// z = M⁻¹ Jᵀ x
void Answer(const DelassusMatrix& W, const double* x, double* z);

// Calls visit(l) for every contact l that shares a body with contact k, itself included.
template <typename Visit>
void ForNeighbours(const DelassusMatrix& W, int k, Visit visit) {
  if (!W.by_body) {
    for (int a = W.row_start[k]; a < W.row_start[k + 1]; ++a) visit(W.column[a]);
    return;
  }
  const BodyRows& rows = *W.by_body;
  const int first = rows.part[2 * k].body;
  for (int i = 2 * k; i < 2 * k + 2; ++i) {
    const int body = rows.part[i].body;
    if (body < 0) continue;
    for (int a = rows.contact_start[body]; a < rows.contact_start[body + 1]; ++a) {
      const int l = rows.contact[a];
      const bool both = rows.part[2 * l].body == first || rows.part[2 * l + 1].body == first;
      if (body == first || first < 0 || !both) visit(l);
    }
  }
}

// Calls visit(l, W_kl) for them.
template <typename Visit>
void ForRow(const DelassusMatrix& W, int k, Visit visit) {
  if (W.by_body) {
    ForNeighbours(W, k, [&](int l) { visit(l, Coupling(*W.by_body, k, l)); });
    return;
  }
  for (int a = W.row_start[k]; a < W.row_start[k + 1]; ++a) visit(W.column[a], W.value[a]);
}

// Multiplications that row k costs in a product W x, about.
inline double RowCost(const DelassusMatrix& W, int k) {
  if (!W.by_body) return W.row_start[k + 1] - W.row_start[k];
  double cost = 8;
  for (int i = 2 * k; i < 2 * k + 2; ++i) {
    const int body = W.by_body->part[i].body;
    if (body >= 0) cost += W.by_body->dofs(body);
  }
  return cost;
}

// The same for all of W.
double Cost(const DelassusMatrix& W);

// y = W x
void Multiply(const DelassusMatrix& W, const double* x, double* y);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_DELASSUS_H_
