// SPDX-License-Identifier: Apache-2.0

#include "law/viscous.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "law/friction_step.h"
#include "law/impact_clock.h"
#include "law/lanes.h"

namespace mujoco_impact::law {

namespace {

constexpr int kStages = 7;

// Dormand-Prince 5(4): row i combines the slopes of the stages before it; the last row is the step.
constexpr double kCombine[kStages][6] = {
    {0, 0, 0, 0, 0, 0},
    {1.0 / 5, 0, 0, 0, 0, 0},
    {3.0 / 40, 9.0 / 40, 0, 0, 0, 0},
    {44.0 / 45, -56.0 / 15, 32.0 / 9, 0, 0, 0},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729, 0, 0},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656, 0},
    {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
constexpr double kNode[kStages] = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1};
constexpr double kError[kStages] = {71.0 / 57600,      0,          -71.0 / 16695, 71.0 / 1920,
                                    -17253.0 / 339200, 22.0 / 525, -1.0 / 40};

// With friction a step is no shorter than this part of the contact time, whatever its error.
constexpr double kShortest = 1e-3;

class Integrator {
 public:
  Integrator(const ImpactProblem& problem, ImpactSolution* solution, const Workspace& workspace);
  ImpactReport Run();

  static constexpr int kArrays = 2 + 3 * kStages;
  static constexpr int kProducts = 2 * kStages;  // by W a step, the longer sums by lane included

 private:
  void EvaluateStage(const double* y, const double* c, int stage);
  void CombineStages(double h, int stage);
  double TryStep(double h);
  double TryFriction(double h);
  void Accept(double h);
  void MoveWindow();

  const ImpactProblem& problem_;
  ImpactSolution& solution_;
  const ImpactScale scale_;
  const double damping_;  // x / c_ref [s/m]
  Lanes lanes_;
  double t_ = 0, work_ = 0;
  // by lane: the step tried, and F, W F, c at the stages
  double *y_new_, *c_new_;
  double *force_[kStages], *pull_[kStages], *speed_[kStages];
  std::optional<FrictionStep> friction_;
  double* rate_ = nullptr;  // with friction: dy/dt over c, by lane
};

Integrator::Integrator(const ImpactProblem& problem, ImpactSolution* solution,
                       const Workspace& workspace)
    : problem_(problem),
      solution_(*solution),
      scale_(MeasureScale(problem)),
      damping_(scale_.speed > 0 ? ViscousDamping(problem.restitution) / scale_.speed : 0),
      lanes_(problem, *solution, scale_,
             kArrays + (problem.friction ? FrictionStep::kArrays + 1 : 0), workspace),
      y_new_(lanes_.Take()),
      c_new_(lanes_.Take()) {
  for (int i = 0; i < kStages; ++i) {
    force_[i] = lanes_.Take();
    pull_[i] = lanes_.Take();
    speed_[i] = lanes_.Take();
  }
  if (problem.friction) {
    friction_.emplace(problem, scale_, lanes_);
    rate_ = lanes_.Take();
    std::fill_n(rate_, problem.delassus.size, 1.0);
  }
  EvaluateStage(lanes_.y, lanes_.c, 0);
}

// F_k = K_k y_k³ᐟ² (1 + x c_k/c_ref), never attracting.
void Integrator::EvaluateStage(const double* y, const double* c, int stage) {
  const double* K = lanes_.stiffness;
  double* __restrict F = force_[stage], * __restrict speed = speed_[stage];
  for (int i = 0; i < lanes_.padded(); ++i) {
    const double loss = 1 + damping_ * c[i];
    const double pressed = y[i] > 0 ? y[i] : 0;
    F[i] = K[i] * pressed * std::sqrt(pressed) * (loss > 0 ? loss : 0);
    speed[i] = c[i];
  }
  lanes_.Multiply(F, pull_[stage]);
}

void Integrator::CombineStages(double h, int stage) {
  for (int i = 0; i < lanes_.padded(); ++i) {
    double dy = 0, dc = 0;
    for (int j = 0; j < stage; ++j) {
      dy += kCombine[stage][j] * speed_[j][i];
      dc -= kCombine[stage][j] * pull_[j][i];
    }
    y_new_[i] = lanes_.y[i] + h * dy;
    c_new_[i] = lanes_.c[i] + h * dc;
  }
}

// Advances into y_new, c_new and returns the error in units of the tolerance.
double Integrator::TryStep(double h) {
  for (int stage = 1; stage < kStages; ++stage) {
    CombineStages(h, stage);
    EvaluateStage(y_new_, c_new_, stage);
  }
  double error = 0;
  for (int i = 0; i < lanes_.size(); ++i) {
    double dy = 0, dc = 0;
    for (int j = 0; j < kStages; ++j) {
      dy += kError[j] * speed_[j][i];
      dc += kError[j] * pull_[j][i];
    }
    error =
        std::max({error, h * std::abs(dy) / scale_.compression, h * std::abs(dc) / scale_.speed});
  }
  return error / problem_.tolerance;
}

// Solves the friction of the step tried and returns its error.
double Integrator::TryFriction(double h) {
  for (int i = 0; i < lanes_.size(); ++i) {
    double dP = 0, lead = 0;
    for (int j = 0; j < kStages - 1; ++j) {
      const double weighted = kCombine[kStages - 1][j] * h * force_[j][i];
      dP += weighted;
      lead += weighted * (1 - kNode[j]) * h;
    }
    friction_->dP[i] = dP;
    friction_->lead[i] = lead;
  }
  return friction_->Try(force_[0], force_[kStages - 1]);
}

void Integrator::Accept(double h) {
  for (int i = 0; i < lanes_.size(); ++i) {
    double dP = 0, dM = 0;
    for (int j = 0; j < kStages - 1; ++j) {
      const double weighted = kCombine[kStages - 1][j] * h * force_[j][i];
      dP += weighted;
      dM += weighted * (t_ + kNode[j] * h);
    }
    // weights of the method are partly negative: a single share may be, the sum is not
    if (dP != 0 && lanes_.impulse[i] == 0) solution_.onset[lanes_.contact(i)] = t_;
    lanes_.impulse[i] += dP;
    lanes_.moment[i] += dM;
    if (!solution_.peak) continue;
    double& peak = solution_.peak[lanes_.contact(i)];
    for (int j = 1; j < kStages; ++j) peak = std::max(peak, force_[j][i]);
  }
  std::swap(lanes_.y, y_new_);
  std::swap(lanes_.c, c_new_);
  std::swap(force_[0], force_[kStages - 1]);
  std::swap(pull_[0], pull_[kStages - 1]);
  std::swap(speed_[0], speed_[kStages - 1]);
  t_ += h;
  if (!friction_) return;
  friction_->Accept(t_);
  EvaluateStage(lanes_.y, lanes_.c, 0);
}

void Integrator::MoveWindow() {
  LeaveLateClosings(problem_, scale_, t_, lanes_);
  if (!lanes_.Move(t_)) return;
  if (friction_) friction_->Load();
  work_ += SearchCost(problem_, lanes_);
  EvaluateStage(lanes_.y, lanes_.c, 0);
}

ImpactReport Integrator::Run() {
  const double first_step = 0.05 * scale_.time;
  double h = first_step;
  ImpactReport report{0, true};
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
      h = std::min(h, first_step);
    }
    const double error = TryStep(h);
    double growth = StepGrowth(error, 5);
    double of_friction = 0;
    if (friction_ && error <= 1) {
      of_friction = TryFriction(h);
      growth = std::min(growth, friction_->Growth(of_friction));
    }
    if (error <= 1 && (of_friction <= 1 || h <= kShortest * scale_.time)) {
      if (friction_) friction_->Finish(rate_, y_new_, c_new_);
      Accept(h);
      MoveWindow();
      ++report.steps;
    }
    h *= growth;
  }
  lanes_.Finish();
  for (int k = 0; k < problem_.delassus.size; ++k) {
    solution_.impulse[k] = std::max(0.0, solution_.impulse[k]);
  }
  report.work = work_;
  report.time = t_;
  return report;
}

}  // namespace

double ViscousDamping(double restitution) {
  const double e = restitution;
  if (e >= 1) return 0;
  // g(x) = x (1 + e) − ln((1 + x)/(1 − e x)) has its positive root in (0, 1/e); bisect, since g is
  // positive near 0 and falls to −∞ at 1/e
  double low = 1e-9, high = (1 - 1e-15) / e;
  for (int i = 0; i < 100; ++i) {
    const double x = 0.5 * (low + high);
    const double g = x * (1 + e) - std::log1p(x) + std::log1p(-e * x);
    (g > 0 ? low : high) = x;
  }
  return 0.5 * (low + high);
}

int ViscousWorkspace(int size, bool friction) {
  return Lanes::Numbers(size, Integrator::kArrays + (friction ? FrictionStep::kArrays + 1 : 0),
                        friction);
}

ImpactReport IntegrateViscous(const ImpactProblem& problem, ImpactSolution* solution,
                              const Workspace& workspace) {
  return Integrator(problem, solution, workspace).Run();
}

}  // namespace mujoco_impact::law
