// SPDX-License-Identifier: Apache-2.0

#include "law/friction_step.h"

#include <algorithm>
#include <cmath>

namespace mujoco_impact::law {

namespace {

// Sweeps over the contacts in a step.
constexpr int kSweeps = 2;

// Tolerance of the friction, in that of the normal forces: errors of ratios do not add up.
constexpr double kFrictionTolerance = 10;

// Part of that below which a change of slip is none.
constexpr double kNoChange = 1e-2;

// A contact whose friction moves nothing, in parts of W_nn.
constexpr double kImmobile = 1e-9;

double Length(Pair x) { return std::hypot(x[0], x[1]); }

}  // namespace

FrictionStep::FrictionStep(const ImpactProblem& problem, const ImpactScale& scale, Lanes& lanes)
    : dP(lanes.Take()),
      dM(lanes.Take()),
      problem_(problem),
      friction_(*problem.friction),
      scale_(scale),
      lanes_(lanes),
      tangents_(problem.delassus.by_body ? TangentRows(problem.delassus, friction_) : BodyRows{}),
      mu_(lanes.Take()),
      stiffness_(lanes.Take(3)),
      coupling_(lanes.Take()),
      p_(lanes.Take(2)),
      slip_(lanes.Take(2)) {
  Load();
}

void FrictionStep::Load() {
  const DelassusMatrix& W = problem_.delassus;
  for (int i = 0; i < lanes_.size(); ++i) {
    const int k = lanes_.contact(i);
    double tt[2][2];
    OwnTangents(W, friction_, k, tt);
    const bool moves = tt[0][0] + tt[1][1] > kImmobile * W.diagonal[k];
    mu_[i] = moves ? friction_.mu[k] : 0;
    const auto [a, b, c] = Lifted(tt);
    stiffness_[3 * i] = a;
    stiffness_[3 * i + 1] = b;
    stiffness_[3 * i + 2] = c;
    coupling_[i] = std::max(a, c);
  }
}

double FrictionStep::Try(const double* F, const double* F_new, double* c_new) {
  Begin();
  const double enough = kNoChange * kFrictionTolerance * problem_.tolerance * scale_.speed;
  for (int i = 0; i < kSweeps; ++i) {
    if (Sweep(c_new) <= enough) break;
  }
  if (problem_.delassus.by_body) Finish(c_new);
  return Error(F, F_new);
}

// Friction at the ratios of before, and the slip that it leaves.
void FrictionStep::Begin() {
  const int n = lanes_.size();
  if (const BodyRows* rows = problem_.delassus.by_body) {
    std::fill_n(rows->work, 2 * rows->dofs(), 0.0);
  }
  std::copy_n(lanes_.slip, 2 * n, slip_);
  for (int i = 0; i < n; ++i) {
    const Pair p = dP[i] * At(lanes_.ratio + 2 * i);
    Put(p_ + 2 * i, p);
    if (dP[i] > 0) Spread(i, p);
  }
}

// slip += W_tn dP + W_tt p for the impulses of lane i.
void FrictionStep::Spread(int i, Pair p) {
  const DelassusMatrix& W = problem_.delassus;
  const int k = lanes_.contact(i);
  if (W.by_body) {
    AddAnswer(*W.by_body, k, dP[i], W.by_body->work);
    for (int a = 0; a < 2; ++a) AddAnswer(tangents_, 2 * k + a, p[a], W.by_body->work);
    return;
  }
  for (int a = W.row_start[k]; a < W.row_start[k + 1]; ++a) {
    const int j = lanes_.lane(W.column[a]);
    if (j < 0) continue;
    const TangentBlock& block = friction_.block[a];
    double* slip = slip_ + 2 * j;
    Put(slip, At(slip) + dP[i] * At(block.nt) + p[0] * At(block.tt[0]) + p[1] * At(block.tt[1]));
  }
}

// Gauss-Seidel; returns the largest change of a slip by the friction of its own contact.
double FrictionStep::Sweep(double* c_new) {
  const double enough = kNoChange * kFrictionTolerance * problem_.tolerance * scale_.speed;
  double largest = 0;
  for (int i = 0; i < lanes_.size(); ++i) {
    const double R = mu_[i] * dP[i];
    if (R <= 0) continue;
    const Tangents A{stiffness_[3 * i], stiffness_[3 * i + 1], stiffness_[3 * i + 2]};
    const Pair p = At(p_ + 2 * i);
    const Pair b = SlipOf(i) - Pair{A.a * p[0] + A.b * p[1], A.b * p[0] + A.c * p[1]};
    const Pair change = FrictionOfStep(A, At(lanes_.slip + 2 * i), b, R) - p;
    const double size = Length(change) * std::max(A.a, A.c);
    if (size <= 1e-3 * enough) continue;
    Change(i, change, c_new);
    largest = std::max(largest, size);
  }
  return largest;
}

void FrictionStep::Change(int i, Pair by, double* c_new) {
  const DelassusMatrix& W = problem_.delassus;
  Put(p_ + 2 * i, At(p_ + 2 * i) + by);
  const int k = lanes_.contact(i);
  if (W.by_body) {
    const BodyRows& rows = *W.by_body;
    for (double* z : {rows.work, rows.work + rows.dofs()}) {
      for (int a = 0; a < 2; ++a) AddAnswer(tangents_, 2 * k + a, by[a], z);
    }
    return;
  }
  for (int a = W.row_start[k]; a < W.row_start[k + 1]; ++a) {
    const int j = lanes_.lane(W.column[a]);
    if (j < 0) continue;
    const TangentBlock& block = friction_.block[a];
    double* slip = slip_ + 2 * j;
    Put(slip, At(slip) + by[0] * At(block.tt[0]) + by[1] * At(block.tt[1]));
    c_new[j] -= block.tn[0] * by[0] + block.tn[1] * by[1];
  }
}

// The slip of a lane at the end of the step; by bodies it is kept as M⁻¹ Jᵀ of all impulses.
Pair FrictionStep::SlipOf(int i) const {
  const BodyRows* rows = problem_.delassus.by_body;
  if (!rows) return At(slip_ + 2 * i);
  const int k = lanes_.contact(i);
  return At(lanes_.slip + 2 * i) +
         Pair{RowTimes(tangents_, 2 * k, rows->work), RowTimes(tangents_, 2 * k + 1, rows->work)};
}

// By bodies: what the sweeps have made of slips and closing speeds.
void FrictionStep::Finish(double* c_new) {
  const BodyRows& rows = *problem_.delassus.by_body;
  for (int i = 0; i < lanes_.size(); ++i) {
    Put(slip_ + 2 * i, SlipOf(i));
    c_new[i] -= RowTimes(rows, lanes_.contact(i), rows.work + rows.dofs());
  }
}

// What the changes of ratios over the step do to velocities: of second order, or of first if the
// force changes as well.
double FrictionStep::Error(const double* F, const double* F_new) const {
  constexpr double kFactor = 0.15;
  double largest = 0;
  for (int i = 0; i < lanes_.size(); ++i) {
    // a contact that begins to press has had no ratio before
    if (mu_[i] <= 0 || dP[i] <= 0 || F[i] <= 0) continue;
    const Pair ratio = 1 / dP[i] * At(p_ + 2 * i);
    const double change = Length(ratio - At(lanes_.ratio + 2 * i));
    const double of_force = std::abs(F_new[i] - F[i]) / (F_new[i] + F[i]);
    largest = std::max(largest, change * (change / mu_[i] + of_force) * dP[i] * coupling_[i]);
  }
  return kFactor * largest / (kFrictionTolerance * problem_.tolerance * scale_.speed);
}

double FrictionStep::Growth(double error) {
  return std::clamp(0.85 * std::pow(error + 1e-10, -0.4), 0.1, 5.0);
}

bool FrictionStep::Accept() {
  bool changed = false;
  for (int i = 0; i < lanes_.size(); ++i) {
    const Pair p = At(p_ + 2 * i), before = At(lanes_.ratio + 2 * i);
    const Pair ratio = dP[i] > 0 ? 1 / dP[i] * p : Pair{};
    Put(lanes_.ratio + 2 * i, ratio);
    changed = changed || ratio[0] != before[0] || ratio[1] != before[1];
    double *impulse = lanes_.friction_impulse + 2 * i, *moment = lanes_.friction_moment + 2 * i;
    Put(impulse, At(impulse) + p);
    Put(moment, At(moment) + dM[i] * ratio);
  }
  std::swap(lanes_.slip, slip_);
  if (changed) lanes_.ApplyRatios();
  return changed;
}

}  // namespace mujoco_impact::law
