// SPDX-License-Identifier: Apache-2.0

#include "law/stopping_impulses.h"

#include <algorithm>
#include <cmath>

namespace mujoco_impact::law {

namespace {

// To and fro twice, between two searches of the subspace.
constexpr int kSweeps = 4;

// What there is work for at least, in products by W.
constexpr double kFewestProducts = 16;

// Conjugate gradients end at this part of the residual.
constexpr double kOfResidual = 1e-8;

// And after so many products: rounding takes more of them than contacts push.
int MostProducts(int size) { return 10 + 3 * std::min(size, 60); }

}  // namespace

StoppingImpulses::StoppingImpulses(const DelassusMatrix& W, double* numbers)
    : W_(W), cost_(Cost(W) + 4 * W.size) {
  double** const arrays[kArrays] = {&p_, &after_, &residual_, &step_, &answer_, &direction_};
  for (int i = 0; i < kArrays; ++i) *arrays[i] = numbers + i * W.size;
}

bool StoppingImpulses::Solve(const double* closing_speed, const double* bound, double floor,
                             double work) {
  c_ = closing_speed;
  b_ = bound;
  std::fill_n(p_, W_.size, 0.0);
  FindAfter();
  end_ = work_ + std::max(work, kFewestProducts * cost_);
  for (int sweeps = 0; work_ < end_; ++sweeps) {
    if (sweeps > 0 && sweeps % kSweeps == 0) MoveInSubspace();
    const double change = Sweep(sweeps % 2 == 1);
    if (change > floor) continue;
    if (sweeps == 0) return false;
    break;
  }
  FindAfter();
  return true;
}

// One over all contacts, to or fro; returns the largest change of a closing speed by the impulse of
// its own contact.
double StoppingImpulses::Sweep(bool fro) {
  double largest = 0;
  for (int i = 0; i < W_.size; ++i) {
    const int k = fro ? W_.size - 1 - i : i;
    const double change = std::max(-p_[k], (After(k) - b_[k]) / W_.diagonal[k]);
    if (change == 0) continue;
    p_[k] += change;
    if (W_.by_body) {
      AddAnswer(*W_.by_body, k, change, W_.by_body->work + W_.by_body->dofs());
    } else {
      ForRow(W_, k, [&](int l, double coupling) { after_[l] -= coupling * change; });
    }
    largest = std::max(largest, std::abs(change) * W_.diagonal[k]);
  }
  // each contact waits for the one before
  constexpr double kPerContact = 25;
  work_ += cost_ + kPerContact * W_.size;
  return largest;
}

// Towards the minimum over the contacts that push, as far as all go on to push.
void StoppingImpulses::MoveInSubspace() {
  FindAfter();
  FindDirection();
  double part = 1;
  for (int k = 0; k < W_.size; ++k) {
    if (p_[k] + direction_[k] < 0) part = std::min(part, -p_[k] / direction_[k]);
  }
  for (int k = 0; k < W_.size; ++k) p_[k] = std::max(0.0, p_[k] + part * direction_[k]);
  FindAfter();
}

// W d = c − b − W p on the contacts that push, by conjugate gradients with the diagonal of W.
void StoppingImpulses::FindDirection() {
  const int n = W_.size;
  double *r = residual_, *s = step_, *Ws = answer_, *d = direction_;
  double square = 0;
  for (int k = 0; k < n; ++k) {
    r[k] = p_[k] > 0 ? after_[k] - b_[k] : 0;
    s[k] = r[k] / W_.diagonal[k];
    d[k] = 0;
    square += r[k] * s[k];
  }
  const double enough = kOfResidual * kOfResidual * square;
  for (int i = 0; i < MostProducts(n) && square > enough && work_ < end_; ++i) {
    Multiply(W_, s, Ws);
    work_ += cost_;
    double curvature = 0;
    for (int k = 0; k < n; ++k) curvature += s[k] * Ws[k];
    if (curvature <= 0) return;
    const double length = square / curvature, before = square;
    square = 0;
    for (int k = 0; k < n; ++k) {
      if (p_[k] <= 0) continue;
      d[k] += length * s[k];
      r[k] -= length * Ws[k];
      square += r[k] * r[k] / W_.diagonal[k];
    }
    for (int k = 0; k < n; ++k) s[k] = r[k] / W_.diagonal[k] + square / before * s[k];
  }
}

// c − W p anew, without what rounding has added up.
void StoppingImpulses::FindAfter() {
  if (W_.by_body) Answer(W_, p_, W_.by_body->work + W_.by_body->dofs());
  Multiply(W_, p_, after_);
  for (int k = 0; k < W_.size; ++k) after_[k] = c_[k] - after_[k];
  work_ += cost_;
}

// c − W p of a contact; by bodies a sweep keeps M⁻¹ Jᵀ p up instead.
double StoppingImpulses::After(int k) const {
  if (!W_.by_body) return after_[k];
  return c_[k] - RowTimes(*W_.by_body, k, W_.by_body->work + W_.by_body->dofs());
}

}  // namespace mujoco_impact::law
