// SPDX-License-Identifier: Apache-2.0

#include "law/coulomb.h"

#include <algorithm>

#include "law/pair.h"

namespace mujoco_impact::law {

void AddTangentAnswers(const DelassusMatrix& W, const CoulombFriction& friction, const double* x,
                       double* z) {
  const BodyRows tangents = TangentRows(W, friction);
  for (int i = 0; i < 2 * W.size; ++i) {
    if (x[i] != 0) AddAnswer(tangents, i, x[i], z);
  }
}

void AddTangential(const DelassusMatrix& W, const CoulombFriction& friction, const double* x,
                   double* normal) {
  if (W.by_body) {
    double* z = W.by_body->work;
    std::fill_n(z, W.by_body->dofs(), 0.0);
    AddTangentAnswers(W, friction, x, z);
    for (int k = 0; k < W.size; ++k) normal[k] += RowTimes(*W.by_body, k, z);
    return;
  }
  for (int k = 0; k < W.size; ++k) {
    Pair sum{};
    for (int a = W.row_start[k]; a < W.row_start[k + 1]; ++a) {
      sum += At(friction.block[a].nt) * At(x + 2 * W.column[a]);
    }
    normal[k] += sum[0] + sum[1];
  }
}

void SlipAfter(const DelassusMatrix& W, const CoulombFriction& friction, const double* p,
               const double* x, double* slip) {
  if (W.by_body) {
    const BodyRows tangents = TangentRows(W, friction);
    double* z = tangents.work;
    Answer(W, p, z);
    AddTangentAnswers(W, friction, x, z);
    for (int i = 0; i < 2 * W.size; ++i) slip[i] = friction.slip[i] + RowTimes(tangents, i, z);
    return;
  }
  for (int k = 0; k < W.size; ++k) {
    Pair sum = At(friction.slip + 2 * k), t1{}, t2{};
    for (int a = W.row_start[k]; a < W.row_start[k + 1]; ++a) {
      const auto& [unused, tn, tt] = friction.block[a];
      const int l = W.column[a];
      sum += At(tn) * p[l];
      t1 += At(tt[0]) * At(x + 2 * l);
      t2 += At(tt[1]) * At(x + 2 * l);
    }
    Put(slip + 2 * k, sum + Pair{t1[0] + t1[1], t2[0] + t2[1]});
  }
}

TangentBlock OwnBlock(const DelassusMatrix& W, const CoulombFriction& friction, int k) {
  if (W.by_body) return BlockOf(*W.by_body, TangentRows(W, friction), k, k);
  const int* begin = W.column + W.row_start[k];
  const int* end = W.column + W.row_start[k + 1];
  return friction.block[std::find(begin, end, k) - W.column];
}

}  // namespace mujoco_impact::law
