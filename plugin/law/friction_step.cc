// SPDX-License-Identifier: Apache-2.0

#include "law/friction_step.h"

#include <algorithm>
#include <cmath>
#include <new>

namespace mujoco_impact::law {

namespace {

// Sweeps over the contacts in a step, at most. Two points of one body that stop together need most.
constexpr int kSweeps = 12;

// Tolerance of friction in that of the normal forces: its errors do not add up.
constexpr double kFrictionTolerance = 10;

// Parts of that from which a change of slip goes round to the other contacts, and calls for another
// sweep.
constexpr double kChange = 1e-2, kAnotherSweep = 5e-1;

// Ratios of less than this part of μ are within the cone.
constexpr double kWithin = 1 - 1e-9;

double Dot(Pair x, Pair y) {
  const Pair product = x * y;
  return product[0] + product[1];
}

void Add(double* to, Pair x) { Put(to, At(to) + x); }

}  // namespace

FrictionStep::FrictionStep(const ImpactProblem& problem, const ImpactScale& scale, Lanes& lanes)
    : dP(lanes.Take()),
      lead(lanes.Take()),
      problem_(problem),
      friction_(*problem.friction),
      lanes_(lanes),
      tangents_(problem.delassus.by_body ? TangentRows(problem.delassus, friction_) : BodyRows{}),
      enough_(kChange * kFrictionTolerance * problem.tolerance * scale.speed),
      tolerance_(kFrictionTolerance * problem.tolerance * scale.speed),
      slip_(lanes.Take(2)),
      rate_(lanes.Take(2)),
      grip_(new (lanes.Take(kGrip)) Grip[problem.delassus.size]) {
  Load();
}

void FrictionStep::Load() {
  const DelassusMatrix& W = problem_.delassus;
  for (int i = 0; i < lanes_.size(); ++i) {
    const int k = lanes_.contact(i);
    const TangentBlock own = OwnBlock(W, friction_, k);
    Grip& grip = grip_[i];
    grip.mu = CanSlip(own, W.diagonal[k]) ? friction_.mu[k] : 0;
    grip.A = Lifted(own.tt);
    grip.inverse = Inverse(grip.A);
    grip.weight = std::max(grip.A.a, grip.A.c);
  }
}

double FrictionStep::Try(const double* F, const double* F_new) {
  Begin(F);
  for (int i = 0; i < kSweeps && Sweep() > kAnotherSweep * tolerance_; ++i) continue;
  double largest = 0;
  stop_ = 0;
  for (int i = 0; i < lanes_.size(); ++i) {
    if (grip_[i].mu <= 0 || dP[i] <= 0) continue;
    const double error = Error(i, F, F_new);
    if (error <= largest) continue;
    largest = error;
    stop_ = grip_[i].theta;
  }
  return largest / tolerance_;
}

// Calls visit(lane, block) for the lanes that contact k couples with, in compressed rows.
template <typename Visit>
void FrictionStep::ForLanes(int k, Visit visit) {
  const DelassusMatrix& W = problem_.delassus;
  const int* column = W.column;
  const TangentBlock* block = friction_.block;
  const Lanes& lanes = lanes_;
  const int begin = W.row_start[k], end = W.row_start[k + 1];
  if (lanes.all()) {
    for (int a = begin; a < end; ++a) visit(column[a], block[a]);
    return;
  }
  for (int a = begin; a < end; ++a) {
    const int j = lanes.lane(column[a]);
    if (j >= 0) visit(j, block[a]);
  }
}

// The step at the ratios of before.
void FrictionStep::Begin(const double* F) {
  const int n = lanes_.size();
  if (const BodyRows* rows = problem_.delassus.by_body) {
    std::fill_n(rows->work, rows->dofs(), 0.0);
  }
  std::copy_n(lanes_.slip, 2 * n, slip_);
  for (int i = 0; i < n; ++i) {
    if (dP[i] <= 0) continue;
    Grip& grip = grip_[i];
    const Pair ratio = At(lanes_.ratio + 2 * i), p = dP[i] * ratio;
    grip.stuck = F[i] > 0 && Dot(ratio, ratio) < kWithin * grip.mu * grip.mu;
    grip.theta = 0;
    for (double* one : {grip.p, grip.lead, grip.ratio}) Put(one, p);
    Spread(i);
  }
  if (const BodyRows* rows = problem_.delassus.by_body) {
    std::copy_n(rows->work, rows->dofs(), rows->work + rows->dofs());
  }
  for (int i = 0; i < n; ++i) {
    if (grip_[i].mu <= 0 || dP[i] <= 0) continue;
    if (problem_.delassus.by_body) FindSlip(i);
    Put(grip_[i].first_rate, At(slip_ + 2 * i) - At(lanes_.slip + 2 * i));
    Put(rate_ + 2 * i, At(grip_[i].first_rate));
  }
}

// slip += W_tn ΔP + W_tt p for the impulses of lane i; by bodies M⁻¹ Jᵀ of them is summed up.
void FrictionStep::Spread(int i) {
  const DelassusMatrix& W = problem_.delassus;
  const int k = lanes_.contact(i);
  const double* p = grip_[i].p;
  if (W.by_body) {
    AddAnswer(*W.by_body, k, dP[i], W.by_body->work);
    for (int a = 0; a < 2; ++a) AddAnswer(tangents_, 2 * k + a, p[a], W.by_body->work);
    return;
  }
  const double impulse = dP[i], p0 = p[0], p1 = p[1];
  ForLanes(k, [&, slip = slip_](int j, const TangentBlock& block) {
    Add(slip + 2 * j, impulse * At(block.nt) + p0 * At(block.tt[0]) + p1 * At(block.tt[1]));
  });
}

// By bodies: the slip at the end of the step, and what goes on at its end.
void FrictionStep::FindSlip(int i) {
  const BodyRows* rows = problem_.delassus.by_body;
  const int k = lanes_.contact(i);
  const double *of_slip = rows->work, *of_rate = rows->work + rows->dofs();
  for (int a = 0; a < 2; ++a) {
    slip_[2 * i + a] = lanes_.slip[2 * i + a] + RowTimes(tangents_, 2 * k + a, of_slip);
    rate_[2 * i + a] = RowTimes(tangents_, 2 * k + a, of_rate);
  }
}

// Gauss-Seidel; returns the largest change of a slip by the friction of its own contact.
double FrictionStep::Sweep() {
  const bool by_body = problem_.delassus.by_body;
  double largest = 0;
  for (int i = 0; i < lanes_.size(); ++i) {
    Grip& grip = grip_[i];
    const double R = grip.mu * dP[i];
    if (R <= 0) continue;
    if (by_body) FindSlip(i);
    const Tangents& A = grip.A;
    const ContactStep step{A,
                           grip.inverse,
                           R,
                           At(lanes_.slip + 2 * i),
                           At(slip_ + 2 * i) - Times(A, At(grip.p)),
                           dP[i] * At(lanes_.ratio + 2 * i),
                           grip.stuck,
                           grip.first_rate,
                           rate_ + 2 * i,
                           grip.ratio};
    const StepFriction friction = FrictionOfStep(step);
    grip.theta = friction.theta;
    const Pair change = Max(Abs(friction.p - At(grip.p)), Abs(friction.ratio - At(grip.ratio)));
    const double size = grip.weight * Larger(change);
    if (size <= enough_) continue;
    Change(i, friction);
    largest = std::max(largest, size);
  }
  return largest;
}

void FrictionStep::Change(int i, const StepFriction& friction) {
  const DelassusMatrix& W = problem_.delassus;
  Grip& grip = grip_[i];
  const Pair by = friction.p - At(grip.p), ratio_by = friction.ratio - At(grip.ratio);
  Put(grip.p, friction.p);
  Put(grip.lead, friction.lead);
  Put(grip.ratio, friction.ratio);
  const int k = lanes_.contact(i);
  if (const BodyRows* rows = W.by_body) {
    for (int a = 0; a < 2; ++a) {
      AddAnswer(tangents_, 2 * k + a, by[a], rows->work);
      AddAnswer(tangents_, 2 * k + a, ratio_by[a], rows->work + rows->dofs());
    }
    return;
  }
  if (by[0] == ratio_by[0] && by[1] == ratio_by[1]) {
    ForLanes(k, [&, slip = slip_, rate = rate_](int j, const TangentBlock& block) {
      const Pair more = by[0] * At(block.tt[0]) + by[1] * At(block.tt[1]);
      Add(slip + 2 * j, more);
      Add(rate + 2 * j, more);
    });
    return;
  }
  ForLanes(k, [&, slip = slip_, rate = rate_](int j, const TangentBlock& block) {
    const Pair t1 = At(block.tt[0]), t2 = At(block.tt[1]);
    Add(slip + 2 * j, by[0] * t1 + by[1] * t2);
    Add(rate + 2 * j, ratio_by[0] * t1 + ratio_by[1] * t2);
  });
}

// What the friction does that the ratios of before would not have done.
void FrictionStep::Finish(const double* rate, double* y_new, double* c_new) {
  const DelassusMatrix& W = problem_.delassus;
  const BodyRows* rows = W.by_body;
  for (int i = 0; rows && i < lanes_.size(); ++i) FindSlip(i);
  double *of_c = rows ? rows->work : nullptr, *of_y = rows ? rows->work + rows->dofs() : nullptr;
  if (rows) std::fill_n(rows->work, 2 * rows->dofs(), 0.0);
  for (int i = 0; i < lanes_.size(); ++i) {
    if (grip_[i].mu * dP[i] <= 0) continue;
    const Pair before = dP[i] * At(lanes_.ratio + 2 * i), by = At(grip_[i].p) - before;
    const Pair lead_by = lead[i] / dP[i] * (At(grip_[i].lead) - before);
    if (by[0] == 0 && by[1] == 0 && lead_by[0] == 0 && lead_by[1] == 0) continue;
    const int k = lanes_.contact(i);
    for (int a = 0; rows && a < 2; ++a) {
      AddAnswer(tangents_, 2 * k + a, by[a], of_c);
      AddAnswer(tangents_, 2 * k + a, lead_by[a], of_y);
    }
    for (int a = rows ? 0 : W.row_start[k]; !rows && a < W.row_start[k + 1]; ++a) {
      const int j = lanes_.lane(W.column[a]);
      if (j < 0) continue;
      const Pair tn = At(friction_.block[a].tn);
      c_new[j] -= Dot(tn, by);
      y_new[j] -= rate[j] * Dot(tn, lead_by);
    }
  }
  for (int i = 0; rows && i < lanes_.size(); ++i) {
    c_new[i] -= RowTimes(*rows, lanes_.contact(i), of_c);
    y_new[i] -= rate[i] * RowTimes(*rows, lanes_.contact(i), of_y);
  }
}

// What the step may have wrong of velocities, on account of the friction of a lane.
double FrictionStep::Error(int i, const double* F, const double* F_new) const {
  // parts of what they could do at most: a slip that turns; a contact that stops or begins to slide
  // halfway
  constexpr double kTurns = 0.15, kStops = 0.07;
  const Grip& grip = grip_[i];
  const Pair ratio = At(grip.ratio), before = dP[i] * At(lanes_.ratio + 2 * i);
  const Pair end = ratio - before, mean = At(grip.p) - before;
  const double square = std::max(Dot(end, end), Dot(mean, mean));
  // a contact that begins to press has had no ratio before
  if (square == 0 || F[i] <= 0) return 0;
  const double change = std::sqrt(square), R = grip.mu * dP[i];
  if (grip.theta > 0 && grip.theta < 1) {
    const double halfway = 4 * grip.theta * (1 - grip.theta);
    return kStops * halfway * grip.weight * change;
  }
  if (grip.stuck || Dot(ratio, ratio) < kWithin * R * R) return 0;
  const double of_force = std::abs(F_new[i] - F[i]) / (F_new[i] + F[i]);
  return kTurns * (change / R + of_force) * grip.weight * change;
}

double FrictionStep::Growth(double error) const {
  constexpr double kMost = 5, kSmall = 0.01;
  if (error < kSmall) return kMost;
  const double growth = std::clamp(0.85 * std::pow(error, -0.4), 0.1, kMost);
  return error > 1 ? std::max(growth, stop_) : growth;
}

bool FrictionStep::StopAtOnce() {
  // of the step; of the normal mobility of the contact
  constexpr double kAtOnce = 0.1, kMuch = 0.05;
  const DelassusMatrix& W = problem_.delassus;
  bool any = false;
  for (int i = 0; i < lanes_.size(); ++i) {
    const Grip& grip = grip_[i];
    if (dP[i] <= 0 || grip.theta <= 0 || grip.theta > kAtOnce) continue;
    const int k = lanes_.contact(i);
    const Pair ratio = 1 / dP[i] * At(grip.ratio), change = ratio - At(lanes_.ratio + 2 * i);
    const TangentBlock own = OwnBlock(W, friction_, k);
    if (std::abs(Dot(At(own.nt), change)) < kMuch * W.diagonal[k]) continue;
    lanes_.SetRatio(i, ratio);
    any = true;
  }
  return any;
}

bool FrictionStep::Accept(double t) {
  bool changed = false;
  for (int i = 0; i < lanes_.size(); ++i) {
    const Grip& grip = grip_[i];
    Put(lanes_.slip + 2 * i, At(slip_ + 2 * i));
    const Pair before = At(lanes_.ratio + 2 * i);
    Pair ratio{};
    if (dP[i] > 0) {
      const Pair p = At(grip.p);
      Add(lanes_.friction_impulse + 2 * i, p);
      Add(lanes_.friction_moment + 2 * i, t * p - lead[i] / dP[i] * At(grip.lead));
      ratio = 1 / dP[i] * At(grip.ratio);
      changed = changed || p[0] != dP[i] * before[0] || p[1] != dP[i] * before[1];
    }
    if (ratio[0] == before[0] && ratio[1] == before[1]) continue;
    lanes_.SetRatio(i, ratio);
    changed = true;
  }
  return changed;
}

}  // namespace mujoco_impact::law
