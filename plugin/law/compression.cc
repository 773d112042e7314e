// SPDX-License-Identifier: Apache-2.0

#include "law/compression.h"

#include <algorithm>
#include <cmath>

#include "law/impact_clock.h"
#include "law/single_impact.h"
#include "law/window.h"

namespace mujoco_impact::law {

namespace {

constexpr int kMaxSteps = 1000000;

// Below this restitution the expansion is so fast that it is over at once (e² < 1e-6 of the work).
constexpr double kNoExpansion = 1e-3;

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

class Integrator {
 public:
  Integrator(const ImpactProblem& problem, ImpactSolution* solution, const Workspace& workspace);
  ImpactReport Run();

  static constexpr int kArrays = 14;

 private:
  void EvaluateStage(const double* y, int stage);
  double TryStep(double h);
  double FractionToTurn() const;
  void Accept(double h);
  void UpdatePhases();
  void MoveWindow();
  int ClosingAlone() const;
  void CollideAlone(int k);

  const ImpactProblem& problem_;
  ImpactSolution& solution_;
  const int n_;
  const ImpactScale scale_;
  const bool lossless_;
  const bool drops_expansion_;
  Window window_;
  double t_ = 0;

  double *y_, *c_, *rate_;  // state; rate is dy/dt over c: 1, or 1/e² while expanding
  double *y_new_, *c_new_, *y_stage_;
  double *force_[4], *pull_[4];  // F and W F at the four stages
};

Integrator::Integrator(const ImpactProblem& problem, ImpactSolution* solution,
                       const Workspace& workspace)
    : problem_(problem),
      solution_(*solution),
      n_(problem.delassus.size),
      scale_(MeasureScale(problem)),
      lossless_(problem.restitution == 1),
      drops_expansion_(problem.restitution < kNoExpansion),
      window_(problem, *solution, scale_,
              {workspace.numbers + kArrays * problem.delassus.size, workspace.indices}) {
  double* numbers = workspace.numbers;
  double** const arrays[kArrays] = {&y_,       &c_,        &rate_,     &y_new_,    &c_new_,
                                    &y_stage_, &force_[0], &force_[1], &force_[2], &force_[3],
                                    &pull_[0], &pull_[1],  &pull_[2],  &pull_[3]};
  for (double** array : arrays) {
    *array = numbers;
    numbers += n_;
  }
  for (int k = 0; k < n_; ++k) {
    y_[k] = -problem.gap[k];
    c_[k] = problem.closing_speed[k];
    rate_[k] = 1;
    solution_.impulse[k] = solution_.moment[k] = solution_.onset[k] = 0;
    for (double* force : force_) force[k] = 0;
  }
}

// F_k = K_k y_k³ᐟ² and the deceleration W F it causes.
void Integrator::EvaluateStage(const double* y, int stage) {
  const DelassusMatrix& W = problem_.delassus;
  double* F = force_[stage];
  for (int i = 0; i < window_.size(); ++i) {
    const int k = window_[i];
    F[k] = y[k] > 0 ? problem_.stiffness[k] * y[k] * std::sqrt(y[k]) : 0;
  }
  for (int i = 0; i < window_.size(); ++i) pull_[stage][window_[i]] = RowTimes(W, window_[i], F);
}

// Advances y, c by h into y_new, c_new and returns the error in units of the tolerance.
double Integrator::TryStep(double h) {
  const double *g1 = pull_[0], *g2 = pull_[1], *g3 = pull_[2], *g4 = pull_[3];
  const double hh = h * h;
  const int size = window_.size();
  for (int i = 0; i < size; ++i) {
    const int k = window_[i];
    y_stage_[k] = y_[k] + rate_[k] * (kNode2 * h * c_[k] - hh * kStage2 * g1[k]);
  }
  EvaluateStage(y_stage_, 1);
  for (int i = 0; i < size; ++i) {
    const int k = window_[i];
    const double g = kStage3[0] * g1[k] + kStage3[1] * g2[k];
    y_stage_[k] = y_[k] + rate_[k] * (kNode3 * h * c_[k] - hh * g);
  }
  EvaluateStage(y_stage_, 2);
  for (int i = 0; i < size; ++i) {
    const int k = window_[i];
    const double g = kPosition[0] * g1[k] + kPosition[1] * g2[k] + kPosition[2] * g3[k];
    y_new_[k] = y_[k] + rate_[k] * (h * c_[k] - hh * g);
  }
  EvaluateStage(y_new_, 3);
  double y_error = 0, c_error = 0;
  for (int i = 0; i < size; ++i) {
    const int k = window_[i];
    c_new_[k] = c_[k] - h * (kVelocity[0] * g1[k] + kVelocity[1] * g2[k] + kVelocity[2] * g3[k] +
                             kVelocity[3] * g4[k]);
    const double dy = kPositionError[0] * g1[k] + kPositionError[1] * g2[k] +
                      kPositionError[2] * g3[k] + kPositionError[3] * g4[k];
    const double dc = kVelocityError[0] * g1[k] + kVelocityError[1] * g2[k] +
                      kVelocityError[2] * g3[k] + kVelocityError[3] * g4[k];
    y_error = std::max(y_error, rate_[k] * std::abs(dy));
    c_error = std::max(c_error, std::abs(dc));
  }
  return std::max(hh * y_error / scale_.compression, h * c_error / scale_.speed) /
         problem_.tolerance;
}

// Part of the step tried after which the first compressed contact turns from compression to
// expansion or back; 1 if none does. The rate of y changes there, so the step must end there.
double Integrator::FractionToTurn() const {
  const double c_floor = kSpeedFloor * scale_.speed;
  double fraction = 1;
  for (int i = 0; i < window_.size(); ++i) {
    const int k = window_[i];
    const bool turned = c_[k] * c_new_[k] < 0 && std::abs(c_new_[k]) > c_floor;
    if (y_new_[k] > 0 && turned) fraction = std::min(fraction, c_[k] / (c_[k] - c_new_[k]));
  }
  return fraction;
}

void Integrator::Accept(double h) {
  const double *F1 = force_[0], *F2 = force_[1], *F3 = force_[2], *F4 = force_[3];
  for (int i = 0; i < window_.size(); ++i) {
    const int k = window_[i];
    const double dP = h * (kVelocity[0] * F1[k] + kVelocity[1] * F2[k] + kVelocity[2] * F3[k] +
                           kVelocity[3] * F4[k]);
    if (dP > 0) {
      // ∫ t F over the step = (t + h) ΔP − ∫ (h − s) F ds
      const double remaining =
          h * h * (kPosition[0] * F1[k] + kPosition[1] * F2[k] + kPosition[2] * F3[k]);
      solution_.moment[k] += (t_ + h) * dP - remaining;
      if (solution_.impulse[k] == 0) solution_.onset[k] = t_;
      solution_.impulse[k] += dP;
    }
    y_[k] = y_new_[k];
    c_[k] = c_new_[k];
  }
  std::swap(force_[0], force_[3]);
  std::swap(pull_[0], pull_[3]);
  t_ += h;
}

// Sets the rate of expansion; a contact that may not expand drops its compression.
void Integrator::UpdatePhases() {
  const double e = problem_.restitution;
  const double c_floor = kSpeedFloor * scale_.speed;
  bool dropped = false;
  for (int i = 0; i < window_.size(); ++i) {
    const int k = window_[i];
    // a contact that opened within the step did so at c, not at c/e²; no force depends on it
    if (y_[k] < 0) y_[k] /= rate_[k];
    // within the floor the sign that c is about to have decides
    const double ahead = std::abs(c_[k]) < c_floor ? -pull_[0][k] : c_[k];
    const bool expands = y_[k] > 0 && ahead < 0;
    if (expands && drops_expansion_) {
      y_[k] = 0;
      dropped = true;
    }
    rate_[k] = expands && !drops_expansion_ ? 1 / (e * e) : 1;
  }
  if (dropped) EvaluateStage(y_, 0);
}

// The contact that has just closed, if nothing else happens until it opens again: no neighbour can
// close under its impulse, no other contact closes by itself. −1 if something may.
int Integrator::ClosingAlone() const {
  const DelassusMatrix& W = problem_.delassus;
  int alone = -1;
  for (int i = 0; i < window_.size(); ++i) {
    const int k = window_[i];
    if (y_[k] != 0 || c_[k] <= 0) continue;
    if (alone >= 0) return -1;
    alone = k;
  }
  if (alone < 0) return -1;
  const double mu = 1 / W.diagonal[alone];
  const SingleImpact single =
      SolveSingleImpact(mu, c_[alone], problem_.stiffness[alone], problem_.restitution);
  for (int a = W.row_start[alone]; a < W.row_start[alone + 1]; ++a) {
    const int l = W.column[a];
    // the impulse changes c by at most |W_kl| P
    const double fastest = std::max(0.0, c_[l]) + std::abs(W.value[a]) * single.impulse;
    if (l != alone && -y_[l] <= fastest * single.duration) return -1;
  }
  if (window_.NextArrival() <= t_ + single.duration) return -1;
  for (int i = 0; i < window_.size(); ++i) {
    const int l = window_[i];
    if (l != alone && c_[l] > 0 && -y_[l] <= c_[l] * single.duration) return -1;
  }
  return alone;
}

// The whole contact in closed form.
void Integrator::CollideAlone(int k) {
  const DelassusMatrix& W = problem_.delassus;
  const SingleImpact single =
      SolveSingleImpact(1 / W.diagonal[k], c_[k], problem_.stiffness[k], problem_.restitution);
  const double P = single.impulse, T = single.duration;
  if (solution_.impulse[k] == 0) solution_.onset[k] = t_;
  solution_.impulse[k] += P;
  solution_.moment[k] += t_ * P + single.moment;
  for (int i = 0; i < window_.size(); ++i) y_[window_[i]] += c_[window_[i]] * T;
  for (int a = W.row_start[k]; a < W.row_start[k + 1]; ++a) {
    const int l = W.column[a];
    // Δy = −W_kl ∫ (T − s) F ds
    y_[l] -= W.value[a] * (T * P - single.moment);
    c_[l] -= W.value[a] * P;
  }
  y_[k] = 0;
  t_ += T;
}

void Integrator::MoveWindow() {
  if (window_.Move(t_, y_, c_, force_, 4)) EvaluateStage(y_, 0);
}

ImpactReport Integrator::Run() {
  // first step of a closing: a twentieth of the contact time, then as the error says
  const double first_step = 0.05 * scale_.time;
  double h = first_step;
  ImpactReport report{0, true};
  MoveWindow();
  EvaluateStage(y_, 0);
  int turns = 0;
  while (!IsOver(problem_, scale_, window_, t_, y_, c_)) {
    if (report.steps == kMaxSteps) {
      report.converged = false;
      break;
    }
    if (!AnyCompressed(window_, y_)) {
      if (!FlyToNextClosing(problem_, scale_, window_, &t_, y_, c_)) break;
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
    const double fraction = lossless_ || turns == 3 ? 1 : FractionToTurn();
    if (fraction < 1) {
      h *= std::max(fraction, 1e-3);
      ++turns;
      continue;
    }
    turns = 0;
    Accept(h);
    if (!lossless_) UpdatePhases();
    MoveWindow();
    h *= growth;
    ++report.steps;
  }
  SpeedsAfter(problem_, solution_);
  return report;
}

}  // namespace

int CompressionWorkspace(int size) { return (Integrator::kArrays + Window::kArrays) * size; }

ImpactReport IntegrateCompression(const ImpactProblem& problem, ImpactSolution* solution,
                                  const Workspace& workspace) {
  return Integrator(problem, solution, workspace).Run();
}

}  // namespace mujoco_impact::law
