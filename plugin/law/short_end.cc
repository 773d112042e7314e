// SPDX-License-Identifier: Apache-2.0

#include "law/short_end.h"

#include <algorithm>
#include <cmath>

#include "law/impact_clock.h"

namespace mujoco_impact::law {

namespace {

// Of p, over all contacts: what there is work for at least.
constexpr double kFewestSweeps = 10;

// Of the work: what is left for the plastic end, and the most that one p before it may take.
constexpr double kOfPlasticEnd = 0.5, kOfOne = 0.25;

class End {
 public:
  End(const ImpactProblem& problem, double t, ImpactSolution& solution, double* numbers)
      : problem_(problem),
        W_(problem.delassus),
        t_(t),
        floor_(problem.tolerance * MeasureScale(problem).speed),
        cost_(Cost(W_) + W_.size),
        solution_(solution),
        impulse_(numbers),
        allowed_(numbers + W_.size),
        after_(numbers + 2 * W_.size) {
    FindAllowed();
    SpeedsAfter(problem, solution);
  }

  double Run() {
    const double e = problem_.restitution, work = problem_.work_of_end;
    while (e > 0 && work_ < (1 - kOfPlasticEnd) * work) {
      if (!FindImpulses(kOfOne * work)) return work_;
      const double s = ConservingScale();
      Give(e == 1 ? s : std::min(1 + e, s));
    }
    FindImpulses(kOfPlasticEnd * work);
    Give(1);
    return work_;
  }

 private:
  // g / t_left, g = max(0, g₀ − c t + W (t P − M)) where the bodies are at time t.
  void FindAllowed() {
    for (int k = 0; k < W_.size; ++k) {
      impulse_[k] = t_ * solution_.impulse[k] - solution_.moment[k];
    }
    Multiply(W_, impulse_, allowed_);
    const double time_left = std::max(problem_.horizon - t_, 0.0);
    for (int k = 0; k < W_.size; ++k) {
      const double gap = problem_.gap[k] - problem_.closing_speed[k] * t_ + allowed_[k];
      allowed_[k] = gap > 0 ? gap / time_left : 0;
    }
  }

  // p, and c − W p; false if nothing closes.
  bool FindImpulses(double work) {
    std::fill_n(impulse_, W_.size, 0.0);
    std::copy_n(solution_.closing_speed, W_.size, after_);
    if (W_.by_body) std::fill_n(W_.by_body->work, W_.by_body->dofs(), 0.0);
    const double most = std::max(kFewestSweeps, work / cost_);
    int sweeps = 0;
    while (sweeps < most && Sweep(sweeps % 2 == 1) > floor_) ++sweeps;
    work_ += (sweeps + 3) * cost_;
    if (W_.by_body) {
      for (int k = 0; k < W_.size; ++k) after_[k] = After(k);
    }
    return sweeps > 0;
  }

  // One over all contacts, to or fro; returns the largest change of a closing speed by an impulse
  // of its own contact.
  double Sweep(bool fro) {
    double largest = 0;
    for (int i = 0; i < W_.size; ++i) {
      const int k = fro ? W_.size - 1 - i : i;
      const double change =
          std::max(-impulse_[k], (After(k) - allowed_[k]) / W_.diagonal[k]);
      if (change == 0) continue;
      impulse_[k] += change;
      if (W_.by_body) {
        AddAnswer(*W_.by_body, k, change, W_.by_body->work);
      } else {
        ForRow(W_, k, [&](int l, double coupling) { after_[l] -= coupling * change; });
      }
      largest = std::max(largest, std::abs(change) * W_.diagonal[k]);
    }
    return largest;
  }

  // c − W p of a contact; by bodies it is not kept up by the sweep.
  double After(int k) const {
    return W_.by_body ? after_[k] - RowTimes(*W_.by_body, k, W_.by_body->work) : after_[k];
  }

  // s* = 2 cᵀp / (pᵀ W p), at which p conserves energy.
  double ConservingScale() const {
    double linear = 0, quadratic = 0;
    for (int k = 0; k < W_.size; ++k) {
      const double c = solution_.closing_speed[k];
      linear += c * impulse_[k];
      quadratic += (c - after_[k]) * impulse_[k];
    }
    return quadratic > 0 ? 2 * linear / quadratic : 1;
  }

  // Adds s p to the solution.
  void Give(double s) {
    for (int k = 0; k < W_.size; ++k) {
      solution_.closing_speed[k] += s * (after_[k] - solution_.closing_speed[k]);
      if (impulse_[k] <= 0) continue;
      if (solution_.impulse[k] <= 0) solution_.onset[k] = t_;
      solution_.impulse[k] += s * impulse_[k];
      solution_.moment[k] += t_ * s * impulse_[k];
    }
  }

  const ImpactProblem& problem_;
  const DelassusMatrix& W_;
  const double t_, floor_, cost_;
  double work_ = 0;
  ImpactSolution& solution_;
  double *impulse_, *allowed_, *after_;  // p, g / t_left, c − W p
};

}  // namespace

double EndShort(const ImpactProblem& problem, double t, ImpactSolution* solution,
                const Workspace& workspace) {
  return End(problem, t, *solution, workspace.numbers).Run();
}

}  // namespace mujoco_impact::law
