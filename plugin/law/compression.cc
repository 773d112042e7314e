// SPDX-License-Identifier: Apache-2.0

#include "law/compression.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "law/friction_step.h"
#include "law/impact_clock.h"
#include "law/lanes.h"
#include "law/pair.h"
#include "law/single_friction.h"
#include "law/single_impact.h"

namespace mujoco_impact::law {

namespace {

// Below this restitution the expansion is so fast that it is over at once (e² < 1e-6 of the work).
constexpr double kNoExpansion = 1e-3;

// Of the compression allowed by the tolerance: by how much missing a turn may put it off.
constexpr double kTurnError = 0.3;

// Coefficients of RKN4(3)4FM: nodes 0, 1/4, 7/10, 1; the last stage is the first of the next step.
constexpr double kNode2 = 1.0 / 4, kNode3 = 7.0 / 10;
constexpr double kStage2 = 1.0 / 32;
constexpr double kStage3[] = {7.0 / 1000, 119.0 / 500};
constexpr double kPosition[] = {1.0 / 14, 8.0 / 27, 25.0 / 189};
constexpr double kVelocity[] = {1.0 / 14, 32.0 / 81, 250.0 / 567, 5.0 / 54};
constexpr double kPositionError[] = {1.0 / 14 + 7.0 / 150, 8.0 / 27 - 67.0 / 150,
                                     25.0 / 189 - 3.0 / 20, 1.0 / 20};
constexpr double kVelocityError[] = {1.0 / 14 - 13.0 / 21, 32.0 / 81 + 20.0 / 27,
                                     250.0 / 567 - 275.0 / 189, 5.0 / 54 + 1.0 / 3};

// With friction a step is no shorter than this part of the contact time, whatever its error: the
// impulse of such a step is none.
constexpr double kShortest = 1e-3;

class Integrator {
 public:
  Integrator(const ImpactProblem& problem, ImpactSolution* solution, const Workspace& workspace);
  ImpactReport Run();

  static constexpr int kArrays = 12;
  static constexpr int kProducts = 3;  // by W, a step

 private:
  void EvaluateStage(const double* y, int stage);
  double TryStep(double h);
  [[gnu::noinline]] double TryFriction(double h);
  bool OvershootsTurn(int i, double h) const;
  double FractionToTurn(double h, double* restitution_of_first) const;
  void Accept(double h);
  void NoteOnsets();
  void NotePeaks();
  void UpdatePhases();
  void SetRates();
  void MoveWindow();
  double restitution(int i) const { return problem_.restitution[lanes_.contact(i)]; }
  [[gnu::noinline]] SingleFriction Alone(int i) const;
  int ClosingAlone() const;
  void CollideAlone(int i);
  [[gnu::noinline]] void RubAlone(int i, const SingleFriction& single);

  const ImpactProblem& problem_;
  ImpactSolution& solution_;
  const ImpactScale scale_;
  const bool lossless_;
  Lanes lanes_;
  double t_ = 0, work_ = 0;

  // by lane
  double* rate_;  // dy/dt over c: 1, or 1/e² while expanding
  double *y_new_, *c_new_, *y_stage_;
  double *force_[4], *pull_[4];  // F and W F at the four stages

  std::optional<FrictionStep> friction_;
};

Integrator::Integrator(const ImpactProblem& problem, ImpactSolution* solution,
                       const Workspace& workspace)
    : problem_(problem),
      solution_(*solution),
      scale_(MeasureScale(problem)),
      lossless_(IsLossless(problem)),
      lanes_(problem, *solution, scale_, kArrays + (problem.friction ? FrictionStep::kArrays : 0),
             workspace) {
  double** const arrays[kArrays] = {&rate_,     &y_new_,    &c_new_,    &y_stage_,
                                    &force_[0], &force_[1], &force_[2], &force_[3],
                                    &pull_[0],  &pull_[1],  &pull_[2],  &pull_[3]};
  for (double** array : arrays) *array = lanes_.Take();
  std::fill_n(rate_, problem.delassus.size + 1, 1.0);
  if (problem.friction) friction_.emplace(problem, scale_, lanes_);
  EvaluateStage(lanes_.y, 0);
}

// F_k = K_k y_k³ᐟ² of the lanes at i.
inline Pair Force(const double* stiffness, Pair y, int i) {
  const Pair pressed = Max(y, Pair{});
  return At(stiffness + i) * pressed * Sqrt(pressed);
}

// Forces and the deceleration W F that they cause.
void Integrator::EvaluateStage(const double* y, int stage) {
  for (int i = 0, end = lanes_.padded(); i < end; i += 2) {
    Put(force_[stage] + i, Force(lanes_.stiffness, At(y + i), i));
  }
  lanes_.Multiply(force_[stage], pull_[stage]);
}

// Advances y, c by h into y_new, c_new and returns the error in units of the tolerance.
double Integrator::TryStep(double h) {
  const double *y = lanes_.y, *c = lanes_.c, *K = lanes_.stiffness, *rate = rate_;
  const double *g1 = pull_[0], *g2 = pull_[1], *g3 = pull_[2], *g4 = pull_[3];
  double *F2 = force_[1], *F3 = force_[2], *F4 = force_[3];
  const double hh = h * h;
  const int size = lanes_.padded();
  for (int i = 0; i < size; i += 2) {
    const Pair g = hh * kStage2 * At(g1 + i);
    Put(F2 + i, Force(K, At(y + i) + At(rate + i) * (kNode2 * h * At(c + i) - g), i));
  }
  lanes_.Multiply(F2, pull_[1]);
  for (int i = 0; i < size; i += 2) {
    const Pair g = hh * (kStage3[0] * At(g1 + i) + kStage3[1] * At(g2 + i));
    Put(F3 + i, Force(K, At(y + i) + At(rate + i) * (kNode3 * h * At(c + i) - g), i));
  }
  lanes_.Multiply(F3, pull_[2]);
  for (int i = 0; i < size; i += 2) {
    const Pair g =
        hh * (kPosition[0] * At(g1 + i) + kPosition[1] * At(g2 + i) + kPosition[2] * At(g3 + i));
    const Pair y_new = At(y + i) + At(rate + i) * (h * At(c + i) - g);
    Put(y_new_ + i, y_new);
    Put(F4 + i, Force(K, y_new, i));
  }
  lanes_.Multiply(F4, pull_[3]);
  Pair y_error{}, c_error{};
  for (int i = 0; i < size; i += 2) {
    const Pair a = At(g1 + i), b = At(g2 + i), d = At(g3 + i), e = At(g4 + i);
    Put(c_new_ + i, At(c + i) - h * (kVelocity[0] * a + kVelocity[1] * b + kVelocity[2] * d +
                                     kVelocity[3] * e));
    const Pair dy = kPositionError[0] * a + kPositionError[1] * b + kPositionError[2] * d +
                    kPositionError[3] * e;
    const Pair dc = kVelocityError[0] * a + kVelocityError[1] * b + kVelocityError[2] * d +
                    kVelocityError[3] * e;
    y_error = Max(y_error, At(rate + i) * Abs(dy));
    c_error = Max(c_error, Abs(dc));
  }
  return std::max(hh * Larger(y_error) / scale_.compression, h * Larger(c_error) / scale_.speed) /
         problem_.tolerance;
}

// Solves the friction of the step tried and returns its error.
double Integrator::TryFriction(double h) {
  const double *F1 = force_[0], *F2 = force_[1], *F3 = force_[2], *F4 = force_[3];
  for (int i = 0; i < lanes_.size(); ++i) {
    friction_->dP[i] = h * (kVelocity[0] * F1[i] + kVelocity[1] * F2[i] + kVelocity[2] * F3[i] +
                            kVelocity[3] * F4[i]);
    friction_->lead[i] =
        h * h * (kPosition[0] * F1[i] + kPosition[1] * F2[i] + kPosition[2] * F3[i]);
  }
  return friction_->Try(F1, F4);
}

// Whether a step of length h has followed the contact of lane i too far beyond its turn: for δt, in
// which y went at the rate before, c to c_new, and y is off by ½ |c_new| δt (1/e² − 1).
bool Integrator::OvershootsTurn(int i, double h) const {
  const double c = lanes_.c[i], c_new = c_new_[i];
  if (y_new_[i] <= 0 || c * c_new >= 0) return false;
  const double c_floor = kSpeedFloor * problem_.tolerance * scale_.speed;
  if (std::abs(c_new) <= c_floor) return false;
  const double e = restitution(i);
  // a compression that is dropped at the turn has pressed too long
  if (e < kNoExpansion) return true;
  const double overshoot = h * c_new / (c_new - c);
  const double error = 0.5 * std::abs(c_new) * overshoot * (1 / (e * e) - 1);
  return error > kTurnError * problem_.tolerance * scale_.compression;
}

// Part of the step tried after which the first compressed contact turns from compression to
// expansion or back, and its restitution; 1 if none does. The rate of y changes there, so the step
// must end there.
double Integrator::FractionToTurn(double h, double* restitution_of_first) const {
  const double* c = lanes_.c;
  double fraction = 1;
  for (int i = 0; i < lanes_.size(); ++i) {
    if (!OvershootsTurn(i, h)) continue;
    const double part = c[i] / (c[i] - c_new_[i]);
    if (part >= fraction) continue;
    fraction = part;
    *restitution_of_first = restitution(i);
  }
  return fraction;
}

// Contacts whose first force comes in the step that begins at t.
void Integrator::NoteOnsets() {
  for (int i = 0; i < lanes_.size(); ++i) {
    if (lanes_.impulse[i] > 0) continue;
    if (force_[1][i] > 0 || force_[2][i] > 0 || force_[3][i] > 0) {
      solution_.onset[lanes_.contact(i)] = t_;
    }
  }
}

void Integrator::NotePeaks() {
  const double *F3 = force_[2], *F4 = force_[3];
  for (int i = 0, end = lanes_.size(); i < end; ++i) {
    double& peak = solution_.peak[lanes_.contact(i)];
    peak = std::max({peak, F3[i], F4[i]});
  }
}

void Integrator::Accept(double h) {
  NoteOnsets();
  if (solution_.peak) NotePeaks();
  const double *F1 = force_[0], *F2 = force_[1], *F3 = force_[2], *F4 = force_[3];
  const double after = t_ + h, hh = h * h;
  for (int i = 0, end = lanes_.padded(); i < end; i += 2) {
    const Pair a = At(F1 + i), b = At(F2 + i), d = At(F3 + i);
    const Pair dP =
        h * (kVelocity[0] * a + kVelocity[1] * b + kVelocity[2] * d + kVelocity[3] * At(F4 + i));
    // ∫ t F over the step = (t + h) ΔP − ∫ (h − s) F ds
    const Pair remaining = hh * (kPosition[0] * a + kPosition[1] * b + kPosition[2] * d);
    Put(lanes_.moment + i, At(lanes_.moment + i) + (after * dP - remaining));
    Put(lanes_.impulse + i, At(lanes_.impulse + i) + dP);
  }
  std::swap(lanes_.y, y_new_);
  std::swap(lanes_.c, c_new_);
  std::swap(force_[0], force_[3]);
  std::swap(pull_[0], pull_[3]);
  t_ = after;
  if (friction_ && friction_->Accept(t_)) EvaluateStage(lanes_.y, 0);
}

// After a step: a contact that opened within it did so at c, not at c/e²; no force depends on it.
void Integrator::UpdatePhases() {
  for (int i = 0; i < lanes_.size(); ++i) {
    if (lanes_.y[i] < 0) lanes_.y[i] /= rate_[i];
  }
  SetRates();
}

// The rate of expansion; a contact that may not expand drops its compression.
void Integrator::SetRates() {
  const double c_floor = kSpeedFloor * problem_.tolerance * scale_.speed;
  bool dropped = false;
  for (int i = 0; i < lanes_.size(); ++i) {
    // within the floor the sign that c is about to have decides
    const double ahead = std::abs(lanes_.c[i]) < c_floor ? -pull_[0][i] : lanes_.c[i];
    const bool expands = lanes_.y[i] > 0 && ahead < 0;
    rate_[i] = 1;
    if (!expands) continue;
    const double e = restitution(i);
    if (e < kNoExpansion) {
      lanes_.y[i] = 0;
      dropped = true;
    } else {
      rate_[i] = 1 / (e * e);
    }
  }
  if (dropped) EvaluateStage(lanes_.y, 0);
}

// The whole impact of the contact of lane i, all others left out.
SingleFriction Integrator::Alone(int i) const {
  const DelassusMatrix& W = problem_.delassus;
  const int k = lanes_.contact(i);
  const double c = lanes_.c[i], K = problem_.stiffness[k], e = problem_.restitution[k];
  if (friction_ && friction_->mu(i) > 0) {
    return SolveSingleFriction({W.diagonal[k],
                                OwnBlock(W, *problem_.friction, k),
                                c,
                                {lanes_.slip[2 * i], lanes_.slip[2 * i + 1]},
                                friction_->mu(i),
                                K,
                                e},
                               problem_.tolerance);
  }
  const SingleImpact single = SolveSingleImpact(1 / W.diagonal[k], c, K, e);
  return {single.impulse, single.moment, single.duration, single.peak, {}, {}, 1, true};
}

// The lane of the contact that has just closed, if nothing else happens until it opens again: no
// neighbour can close under its impulse, no other contact closes by itself. −1 if something may.
int Integrator::ClosingAlone() const {
  const DelassusMatrix& W = problem_.delassus;
  const double *y = lanes_.y, *c = lanes_.c;
  int alone = -1;
  for (int i = 0; i < lanes_.size(); ++i) {
    if (y[i] != 0 || c[i] <= 0) continue;
    if (alone >= 0) return -1;
    alone = i;
  }
  if (alone < 0) return -1;
  const int k = lanes_.contact(alone);
  const SingleFriction single = Alone(alone);
  bool closes_another = false;
  const auto close = [&](int l, double most) {
    const int i = lanes_.lane(l);
    if (i < 0 || i == alone) return;
    // the impulse changes c by no more than `most`
    const double fastest = std::max(0.0, c[i]) + most;
    closes_another = closes_another || -y[i] <= fastest * single.duration;
  };
  ForRow(W, k, [&](int l, double coupling) { close(l, std::abs(coupling) * single.impulse); });
  if (friction_) {
    const double most = friction_->mu(alone) * single.impulse;
    ForBlocks(W, *problem_.friction, k, [&](int l, const TangentBlock& block) {
      close(l, 2 * most * std::max(std::abs(block.tn[0]), std::abs(block.tn[1])));
    });
  }
  if (closes_another || !single.ended) return -1;
  if (lanes_.window().NextArrival() <= t_ + single.duration) return -1;
  for (int i = 0; i < lanes_.size(); ++i) {
    if (i != alone && c[i] > 0 && -y[i] <= c[i] * single.duration) return -1;
  }
  return alone;
}

// The whole contact of lane i in closed form.
void Integrator::CollideAlone(int i) {
  const DelassusMatrix& W = problem_.delassus;
  const int k = lanes_.contact(i);
  const SingleFriction single = Alone(i);
  const double P = single.impulse, T = single.duration;
  if (lanes_.impulse[i] == 0) solution_.onset[k] = t_;
  if (solution_.peak) solution_.peak[k] = std::max(solution_.peak[k], single.peak);
  lanes_.impulse[i] += P;
  lanes_.moment[i] += t_ * P + single.moment;
  for (int j = 0; j < lanes_.size(); ++j) lanes_.y[j] += lanes_.c[j] * T;
  ForRow(W, k, [&](int l, double coupling) {
    const int j = lanes_.lane(l);
    if (j < 0) return;
    // Δy = −W_kl ∫ (T − s) F ds
    lanes_.y[j] -= coupling * (T * P - single.moment);
    lanes_.c[j] -= coupling * P;
  });
  if (friction_) RubAlone(i, single);
  lanes_.y[i] = 0;
  t_ += T;
}

// What the friction of that does.
void Integrator::RubAlone(int i, const SingleFriction& single) {
  const double P = single.impulse, T = single.duration;
  const Pair Q = At(single.friction), M = At(single.friction_moment), lead = T * Q - M;
  double *impulse = lanes_.friction_impulse + 2 * i, *moment = lanes_.friction_moment + 2 * i;
  Put(impulse, At(impulse) + Q);
  Put(moment, At(moment) + t_ * Q + M);
  ForBlocks(problem_.delassus, *problem_.friction, lanes_.contact(i),
            [&](int l, const TangentBlock& block) {
              const int j = lanes_.lane(l);
              if (j < 0) return;
              lanes_.y[j] -= block.tn[0] * lead[0] + block.tn[1] * lead[1];
              lanes_.c[j] -= block.tn[0] * Q[0] + block.tn[1] * Q[1];
              double* slip = lanes_.slip + 2 * j;
              Put(slip,
                  At(slip) + P * At(block.nt) + Q[0] * At(block.tt[0]) + Q[1] * At(block.tt[1]));
            });
}

void Integrator::MoveWindow() {
  LeaveLateClosings(problem_, scale_, t_, lanes_);
  if (!lanes_.Move(t_)) return;
  if (friction_) friction_->Load();
  work_ += SearchCost(problem_, lanes_);
  EvaluateStage(lanes_.y, 0);
  if (!lossless_) SetRates();
}

ImpactReport Integrator::Run() {
  // first step of a closing: a twentieth of the contact time, then as the error says
  const double first_step = 0.05 * scale_.time;
  double h = first_step;
  ImpactReport report{0, true};
  int turns = 0;
  double after_turn = 0;  // the step that may follow one cut short at a turn
  bool stopped = false;
  while (!IsOver(problem_, scale_, lanes_, t_)) {
    if (work_ >= problem_.work) {
      report.converged = false;
      break;
    }
    work_ += StepCost(lanes_, kProducts + (friction_ ? FrictionStep::kProducts : 0));
    if (!AnyCompressed(lanes_)) {
      work_ += SearchCost(problem_, lanes_);
      if (!FlyToNextClosing(problem_, scale_, lanes_, &t_)) break;
      MoveWindow();
      if (const int alone = ClosingAlone(); alone >= 0) {
        CollideAlone(alone);
        MoveWindow();
        ++report.steps;
        continue;
      }
      h = std::min(h, first_step);
    }
    const double error = TryStep(h);
    const double growth = StepGrowth(error, 4);
    if (error > 1) {
      h *= growth;
      continue;
    }
    // two secant steps put the turn within the speed floor, which the phase allows for
    double e = 1;
    const double fraction = lossless_ || turns == 3 ? 1 : FractionToTurn(h, &e);
    if (fraction < 1) {
      // a contact expands 1/e times as fast as it was compressed; many that rattle turn often
      if (friction_ && turns == 0) after_turn = e * h;
      h *= std::max(fraction, 1e-3);
      ++turns;
      continue;
    }
    turns = 0;
    double growth_of_friction = growth;
    if (friction_) {
      const double of_friction = TryFriction(h);
      growth_of_friction = friction_->Growth(of_friction);
      if (of_friction > 1 && h > kShortest * scale_.time) {
        h *= growth_of_friction;
        continue;
      }
      if (!stopped && friction_->StopAtOnce()) {
        stopped = true;
        EvaluateStage(lanes_.y, 0);
        continue;
      }
      stopped = false;
      growth_of_friction = std::max(growth_of_friction, kShortest * scale_.time / h);
      friction_->Finish(rate_, y_new_, c_new_);
    }
    Accept(h);
    if (!lossless_) UpdatePhases();
    MoveWindow();
    h *= std::min(growth, growth_of_friction);
    if (growth_of_friction >= growth) h = std::max(h, after_turn);
    after_turn = 0;
    ++report.steps;
  }
  lanes_.Finish();
  report.work = work_;
  report.time = t_;
  return report;
}

}  // namespace

int CompressionWorkspace(int size, bool friction) {
  return Lanes::Numbers(size, Integrator::kArrays + (friction ? FrictionStep::kArrays : 0),
                        friction);
}

ImpactReport IntegrateCompression(const ImpactProblem& problem, ImpactSolution* solution,
                                  const Workspace& workspace) {
  return Integrator(problem, solution, workspace).Run();
}

}  // namespace mujoco_impact::law
