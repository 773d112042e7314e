// SPDX-License-Identifier: Apache-2.0

#include "law/impact_law.h"

#include <algorithm>
#include <cmath>

#include "law/compression.h"
#include "law/friction_guard.h"
#include "law/impact_clock.h"
#include "law/lanes.h"
#include "law/passivity.h"
#include "law/short_end.h"
#include "law/single_friction.h"
#include "law/single_impact.h"
#include "law/viscous.h"

namespace mujoco_impact::law {

namespace {

// A factor beyond is no correction: the pushes cancel each other.
constexpr double kMostScale = 10;

bool IsViscous(const ImpactProblem& problem) {
  return problem.dissipation == Dissipation::kViscous && problem.restitution < 1;
}

ImpactReport SolveIsolated(const ImpactProblem& problem, ImpactSolution* solution) {
  const double u = problem.closing_speed[0];
  solution->impulse[0] = solution->moment[0] = solution->onset[0] = 0;
  solution->closing_speed[0] = u;
  if (solution->peak) solution->peak[0] = 0;
  if (u <= 0 || problem.gap[0] > u * problem.horizon) return {0, true};
  const double mu = 1 / problem.delassus.diagonal[0];
  const SingleImpact single = SolveSingleImpact(mu, u, problem.stiffness[0], problem.restitution);
  const double onset = problem.gap[0] / u;
  solution->impulse[0] = single.impulse;
  solution->moment[0] = single.moment + onset * single.impulse;
  solution->onset[0] = onset;
  solution->closing_speed[0] = -problem.restitution * u;
  if (solution->peak) solution->peak[0] = single.peak;
  return {1, true};
}

void Scale(double factor, int n, double* x) {
  for (int i = 0; i < n; ++i) x[i] *= factor;
}

bool HasFriction(const ImpactProblem& problem) {
  const double* mu = problem.friction->mu;
  return std::any_of(mu, mu + problem.delassus.size, [](double one) { return one > 0; });
}

ImpactReport SolveWithoutFriction(const ImpactProblem& problem, bool passive,
                                  ImpactSolution* solution, const Workspace& workspace) {
  ImpactProblem frictionless = problem;
  frictionless.friction = nullptr;
  const ImpactReport report = SolveImpact(frictionless, passive, solution, workspace);
  std::fill_n(solution->friction, 2 * problem.delassus.size, 0.0);
  std::fill_n(solution->friction_moment, 2 * problem.delassus.size, 0.0);
  SlipAfter(problem.delassus, *problem.friction, solution->impulse, solution->friction,
            solution->slip);
  return report;
}

// What is left of negative shares of a step (viscous.cc) may be outside.
void KeepInCone(const CoulombFriction& friction, int n, ImpactSolution* solution) {
  for (int k = 0; k < n; ++k) {
    double* Q = solution->friction + 2 * k;
    const double most = friction.mu[k] * solution->impulse[k], size = std::hypot(Q[0], Q[1]);
    if (size <= most) continue;
    Scale(most / size, 2, Q);
    Scale(most / size, 2, solution->friction_moment + 2 * k);
  }
}

ImpactReport SolveIsolatedFriction(const ImpactProblem& problem, ImpactSolution* solution) {
  const DelassusMatrix& W = problem.delassus;
  const CoulombFriction& friction = *problem.friction;
  const double u = problem.closing_speed[0];
  solution->impulse[0] = solution->moment[0] = solution->onset[0] = 0;
  std::fill_n(solution->friction, 2, 0.0);
  std::fill_n(solution->friction_moment, 2, 0.0);
  if (solution->peak) solution->peak[0] = 0;
  ImpactReport report{0, true};
  if (u > 0 && problem.gap[0] <= u * problem.horizon) {
    constexpr double kWorkOfStep = 500;  // multiplications
    const TangentBlock own = OwnBlock(W, friction, 0);
    const double mu = CanSlip(own, W.diagonal[0]) ? friction.mu[0] : 0;
    const SingleFriction single = SolveSingleFriction({W.diagonal[0],
                                                       own,
                                                       u,
                                                       {friction.slip[0], friction.slip[1]},
                                                       mu,
                                                       problem.stiffness[0],
                                                       problem.restitution},
                                                      problem.tolerance);
    const double onset = problem.gap[0] / u;
    solution->impulse[0] = single.impulse;
    solution->moment[0] = single.moment + onset * single.impulse;
    solution->onset[0] = onset;
    if (solution->peak) solution->peak[0] = single.peak;
    for (int i = 0; i < 2; ++i) {
      solution->friction[i] = single.friction[i];
      solution->friction_moment[i] = single.friction_moment[i] + onset * single.friction[i];
    }
    report = {single.steps, single.ended, kWorkOfStep * single.steps, onset + single.duration};
  }
  return report;
}

ImpactReport SolveWithFriction(const ImpactProblem& problem, bool passive, ImpactSolution* solution,
                               const Workspace& workspace) {
  if (!HasFriction(problem)) return SolveWithoutFriction(problem, passive, solution, workspace);
  if (problem.delassus.size == 1 && !IsViscous(problem)) {
    ImpactReport report = SolveIsolatedFriction(problem, solution);
    if (!report.converged) report.work += EndShort(problem, report.time, solution, workspace);
    SpeedsAfter(problem, *solution);
    if (passive) RemoveGain(problem, *solution);
    return report;
  }
  ImpactReport report = IsViscous(problem) ? IntegrateViscous(problem, solution, workspace)
                                           : IntegrateCompression(problem, solution, workspace);
  KeepInCone(*problem.friction, problem.delassus.size, solution);
  if (!report.converged) report.work += EndShort(problem, report.time, solution, workspace);
  SpeedsAfter(problem, *solution);
  if (passive) RemoveGain(problem, *solution);
  return report;
}

}  // namespace

int ImpactNumbers(int size, bool friction) {
  return std::max(CompressionWorkspace(size, friction), ViscousWorkspace(size, friction));
}

int ImpactIndices(int size) { return Lanes::Indices(size); }

ImpactReport SolveImpact(const ImpactProblem& problem, bool passive, ImpactSolution* solution,
                         const Workspace& workspace) {
  if (problem.friction) return SolveWithFriction(problem, passive, solution, workspace);
  const int n = problem.delassus.size;
  const bool viscous = IsViscous(problem);
  if (n == 1 && !viscous) return SolveIsolated(problem, solution);
  ImpactReport report = viscous ? IntegrateViscous(problem, solution, workspace)
                                : IntegrateCompression(problem, solution, workspace);
  if (!report.converged) report.work += EndShort(problem, report.time, solution, workspace);
  SpeedsAfter(problem, *solution);
  if (!passive) return report;
  const double s = ConservativeScale(problem.delassus, problem.closing_speed, solution->impulse,
                                     workspace.numbers);
  // also one that was cut short, whose end by itself is plastic
  const double factor = problem.restitution == 1 ? s : std::min(1.0, s);
  if (s > 0 && s < kMostScale) {
    Scale(factor, n, solution->impulse);
    Scale(factor, n, solution->moment);
  } else {
    RemoveGain(problem.delassus, problem.closing_speed, solution->impulse, solution->moment,
               workspace.numbers);
  }
  SpeedsAfter(problem, *solution);
  return report;
}

}  // namespace mujoco_impact::law
