// SPDX-License-Identifier: Apache-2.0

#include "law/lanes.h"

#include <algorithm>
#include <cstddef>

namespace mujoco_impact::law {

Lanes::Lanes(const ImpactProblem& problem, const ImpactSolution& solution, const ImpactScale& scale,
             int arrays, const Workspace& workspace)
    : problem_(problem),
      solution_(solution),
      free_(workspace.numbers),
      y_of_contact_(free_ + (kArrays + arrays + (problem.friction ? kFrictionArrays : 0)) *
                                (problem.delassus.size + kMargin)),
      c_of_contact_(y_of_contact_ + problem.delassus.size),
      window_(problem, solution, scale, {c_of_contact_ + problem.delassus.size, workspace.indices}),
      lane_(workspace.indices + Window::kIndexArrays * problem.delassus.size),
      ratio_of_contact_(c_of_contact_ + (1 + Window::kArrays) * problem.delassus.size) {
  double** const own[kArrays] = {&y,        &c,      &impulse, &moment, &stiffness,
                                 &matters_, &lower_, &middle_, &upper_};
  for (double** array : own) *array = Take();
  for (int k = 0; k < problem.delassus.size; ++k) {
    y_of_contact_[k] = -problem.gap[k];
    c_of_contact_[k] = problem.closing_speed[k];
    solution.impulse[k] = solution.moment[k] = solution.onset[k] = 0;
    lane_[k] = -1;
  }
  if (problem.friction) {
    for (double** array : {&ratio, &slip, &friction_impulse, &friction_moment}) *array = Take(2);
    for (double* array : {ratio_of_contact_, solution.friction, solution.friction_moment}) {
      std::fill_n(array, 2 * problem.delassus.size, 0.0);
    }
  }
  window_.Move(0, y_of_contact_, c_of_contact_);
  Load();
}

int Lanes::Numbers(int size, int arrays, bool friction) {
  const int of_friction = friction ? kFrictionArrays * (size + kMargin) + 2 * size : 0;
  return (kArrays + arrays) * (size + kMargin) + (kContactArrays + Window::kArrays) * size +
         of_friction;
}

int Lanes::Indices(int size) { return (Window::kIndexArrays + 1) * size; }

double* Lanes::Take(int width) {
  const int length = width * (problem_.delassus.size + kMargin);
  std::fill_n(free_, length, 0.0);
  double* array = free_ + width;
  free_ += length;
  return array;
}

// Contacts come in at once, but leave in batches: to load the lanes costs as much as some steps.
bool Lanes::MustMove(double t) const {
  constexpr int kFewest = 4;
  if (window_.whole()) return false;
  if (window_.IsArrivalDue(t)) return true;
  int idle = 0;
  for (int i = 0; i < size(); ++i) {
    const bool matters = window_.Matters(y[i], c[i]), mattered = matters_[i] != 0;
    if (matters && !mattered) return true;
    if (mattered && !matters) ++idle;
  }
  return idle > kFewest && 4 * idle > size();
}

bool Lanes::Move(double t) {
  if (!MustMove(t)) return false;
  Store();
  window_.Move(t, y_of_contact_, c_of_contact_);
  Load();
  return true;
}

void Lanes::Store() {
  for (int i = 0; i < size(); ++i) {
    const int k = contact(i);
    lane_[k] = -1;
    y_of_contact_[k] = y[i];
    c_of_contact_[k] = c[i];
    solution_.impulse[k] = impulse[i];
    solution_.moment[k] = moment[i];
  }
  if (problem_.friction) StoreFriction();
}

void Lanes::StoreFriction() const {
  for (int i = 0; i < size(); ++i) {
    const int k = contact(i);
    Put(ratio_of_contact_ + 2 * k, At(ratio + 2 * i));
    Put(solution_.friction + 2 * k, At(friction_impulse + 2 * i));
    Put(solution_.friction_moment + 2 * k, At(friction_moment + 2 * i));
  }
}

void Lanes::LoadFriction() {
  full_ = IsFull();
  SlipAfter(problem_.delassus, *problem_.friction, solution_.impulse, solution_.friction,
            solution_.slip);
  for (int i = 0; i < size(); ++i) {
    const int k = contact(i);
    SetRatio(i, At(ratio_of_contact_ + 2 * k));
    Put(slip + 2 * i, At(solution_.slip + 2 * k));
    Put(friction_impulse + 2 * i, At(solution_.friction + 2 * k));
    Put(friction_moment + 2 * i, At(solution_.friction_moment + 2 * k));
  }
  for (int i = size(); i < padded() + 1; ++i) {
    for (double* array : {ratio, slip, friction_impulse, friction_moment})
      Put(array + 2 * i, Pair{});
  }
}

void Lanes::Load() {
  for (int i = 0; i < size(); ++i) {
    const int k = contact(i);
    lane_[k] = i;
    y[i] = y_of_contact_[k];
    c[i] = c_of_contact_[k];
    impulse[i] = solution_.impulse[k];
    moment[i] = solution_.moment[k];
    stiffness[i] = problem_.stiffness[k];
    matters_[i] = window_.Matters(y[i], c[i]);
  }
  for (int i = size(); i < padded() + 1; ++i) {
    y[i] = c[i] = impulse[i] = moment[i] = stiffness[i] = 0;
  }
  LoadMatrix();
  constexpr double kTridiagonal = 1.5;  // a lane
  product_cost_ = tridiagonal_ ? kTridiagonal * size() : 0;
  for (int i = 0; !tridiagonal_ && i < size(); ++i) {
    product_cost_ += RowCost(problem_.delassus, contact(i));
  }
  if (problem_.friction) LoadFriction();
}

bool Lanes::IsFull() const {
  const DelassusMatrix& W = problem_.delassus;
  const int n = size();
  if (W.by_body || n < W.size || W.row_start[n] != n * n) return false;
  for (int a = 0; a < n * n; ++a) {
    if (W.column[a] != a % n) return false;
  }
  return true;
}

// Column i of the product by W is row i, transposed: friction's share of it is with the tangents of
// the contact of lane i.
void Lanes::SetRatio(int i, Pair r) {
  Put(ratio + 2 * i, r);
  const DelassusMatrix& W = problem_.delassus;
  // by bodies the product looks at the ratios itself
  if (W.by_body) return;
  const CoulombFriction& friction = *problem_.friction;
  const int k = contact(i);
  for (int a = W.row_start[k]; a < W.row_start[k + 1]; ++a) {
    const Pair of_friction = At(friction.block[a].tn) * r;
    friction.work[a] = W.value[a] + (of_friction[0] + of_friction[1]);
    const int j = lane_[W.column[a]];
    if (!tridiagonal_ || j < 0) continue;
    (j < i ? upper_ : j > i ? lower_ : middle_)[j] = friction.work[a];
  }
}

// By columns, since most contacts of a large island do not press.
void Lanes::MultiplyColumns(const double* x, double* product) const {
  const DelassusMatrix& W = problem_.delassus;
  const double* value = problem_.friction->work;
  std::fill_n(product, padded(), 0.0);
  if (full_) {
    for (int i = 0, n = size(); i < n; ++i) {
      if (x[i] == 0) continue;
      const double* row = value + static_cast<std::ptrdiff_t>(i) * n;
      for (int j = 0; j + 1 < n; j += 2) Put(product + j, At(product + j) + x[i] * At(row + j));
      if (n & 1) product[n - 1] += x[i] * row[n - 1];
    }
    return;
  }
  const int *column = W.column, *lane = lane_;
  for (int i = 0; i < size(); ++i) {
    const double force = x[i];
    if (force == 0) continue;
    const int k = contact(i), begin = W.row_start[k], end = W.row_start[k + 1];
    if (all()) {
      for (int a = begin; a < end; ++a) product[column[a]] += value[a] * force;
      continue;
    }
    // what is in front of an array takes what is outside the window
    for (int a = begin; a < end; ++a) product[lane[column[a]]] += value[a] * force;
  }
}

void Lanes::LoadMatrix() {
  const DelassusMatrix& W = problem_.delassus;
  tridiagonal_ = !W.by_body;
  for (int i = 0; tridiagonal_ && i < size(); ++i) {
    lower_[i] = middle_[i] = upper_[i] = 0;
    const int k = contact(i);
    for (int a = W.row_start[k]; a < W.row_start[k + 1]; ++a) {
      const int j = lane_[W.column[a]];
      if (j < 0) continue;  // no force there
      if (j == i - 1) lower_[i] = W.value[a];
      if (j == i) middle_[i] = W.value[a];
      if (j == i + 1) upper_[i] = W.value[a];
      tridiagonal_ = tridiagonal_ && j >= i - 1 && j <= i + 1;
    }
  }
  for (int i = size(); i < padded(); ++i) lower_[i] = middle_[i] = upper_[i] = 0;
}

void Lanes::MultiplyRows(const double* x, double* product) const {
  const DelassusMatrix& W = problem_.delassus;
  if (W.by_body) return MultiplyByBody(*W.by_body, x, product);
  if (problem_.friction) return MultiplyColumns(x, product);
  for (int i = 0; i < size(); ++i) {
    const int k = contact(i);
    double sum = 0;
    // the zero in front stands for the contacts outside
    for (int a = W.row_start[k]; a < W.row_start[k + 1]; ++a) {
      sum += W.value[a] * x[lane_[W.column[a]]];
    }
    product[i] = sum;
  }
  if (size() < padded()) product[size()] = 0;
}

void Lanes::MultiplyByBody(const BodyRows& rows, const double* x, double* product) const {
  std::fill_n(rows.work, rows.dofs(), 0.0);
  for (int i = 0; i < size(); ++i) {
    if (x[i] != 0) AddAnswer(rows, contact(i), x[i], rows.work);
  }
  if (problem_.friction) {
    const BodyRows tangents = TangentRows(problem_.delassus, *problem_.friction);
    for (int i = 0; i < 2 * size(); ++i) {
      const double force = ratio[i] * x[i / 2];
      if (force != 0) AddAnswer(tangents, 2 * contact(i / 2) + i % 2, force, rows.work);
    }
  }
  for (int i = 0; i < size(); ++i) product[i] = RowTimes(rows, contact(i), rows.work);
  if (size() < padded()) product[size()] = 0;
}

void Lanes::Finish() {
  for (int i = 0; i < size(); ++i) {
    solution_.impulse[contact(i)] = impulse[i];
    solution_.moment[contact(i)] = moment[i];
  }
  if (problem_.friction) StoreFriction();
}

}  // namespace mujoco_impact::law
