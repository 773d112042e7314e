// SPDX-License-Identifier: Apache-2.0

#include "law/delassus.h"

#include <algorithm>

namespace mujoco_impact::law {

void Answer(const DelassusMatrix& W, const double* x, double* z) {
  std::fill_n(z, W.by_body->dofs(), 0.0);
  for (int k = 0; k < W.size; ++k) {
    if (x[k] != 0) AddAnswer(*W.by_body, k, x[k], z);
  }
}

double Cost(const DelassusMatrix& W) {
  if (!W.by_body) return W.row_start[W.size];
  double cost = 0;
  for (int k = 0; k < W.size; ++k) cost += RowCost(W, k);
  return cost;
}

void Multiply(const DelassusMatrix& W, const double* x, double* y) {
  if (W.by_body) {
    Answer(W, x, W.by_body->work);
    for (int k = 0; k < W.size; ++k) y[k] = RowTimes(*W.by_body, k, W.by_body->work);
    return;
  }
  for (int k = 0; k < W.size; ++k) {
    double sum = 0;
    for (int a = W.row_start[k]; a < W.row_start[k + 1]; ++a) sum += W.value[a] * x[W.column[a]];
    y[k] = sum;
  }
}

}  // namespace mujoco_impact::law
