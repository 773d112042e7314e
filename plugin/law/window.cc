// SPDX-License-Identifier: Apache-2.0

#include "law/window.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "law/pair.h"

namespace mujoco_impact::law {

namespace {

// Small islands are integrated whole; in larger ones only the contacts near a force.
constexpr int kWholeIsland = 8;

// Parts of the scale, in units of the tolerance, from which a closing or a compression matters to
// the neighbours: ahead of a wave motion dies away faster than exponentially, but never to zero,
// and behind it contacts keep a trace of compression. The force of either is negligible.
constexpr double kNoticeableSpeed = 1e-3;
constexpr double kNoticeableCompression = 1e-1;

}  // namespace

Window::Window(const ImpactProblem& problem, const ImpactSolution& solution,
               const ImpactScale& scale, const Workspace& workspace)
    : problem_(problem),
      solution_(solution),
      scale_(scale),
      whole_(problem.delassus.size <= kWholeIsland),
      noticeable_speed_(kNoticeableSpeed * problem.tolerance * scale.speed),
      noticeable_compression_(kNoticeableCompression * problem.tolerance * scale.compression) {
  const int n = problem.delassus.size;
  double** const arrays[kArrays] = {&t_left_, &y_left_, &c_left_, &impulse_left_, &moment_left_};
  for (int i = 0; i < kArrays; ++i) *arrays[i] = workspace.numbers + i * n;
  int** const index_arrays[kIndexArrays] = {&member_, &previous_, &seen_};
  for (int i = 0; i < kIndexArrays; ++i) *index_arrays[i] = workspace.indices + i * n;
  for (int k = 0; k < n; ++k) {
    seen_[k] = -1;
    t_left_[k] = impulse_left_[k] = moment_left_[k] = 0;
    y_left_[k] = -problem.gap[k];
    c_left_[k] = problem.closing_speed[k];
    if (whole_) member_[size_++] = k;
  }
  if (const BodyRows* rows = problem.delassus.by_body) std::fill_n(rows->mark, rows->bodies, 0);
  next_arrival_ = NextArrival();
}

double Window::Arrival(int k) const {
  const bool closes = c_left_[k] > noticeable_speed_;
  return closes ? t_left_[k] - y_left_[k] / c_left_[k] : std::numeric_limits<double>::infinity();
}

double Window::NextArrival() const {
  double next = std::numeric_limits<double>::infinity();
  if (whole_) return next;
  for (int k = 0; k < problem_.delassus.size; ++k) {
    if (!IsMember(k)) next = std::min(next, Arrival(k));
  }
  return next;
}

// Lets in the contacts that are about to close, as if they had been members before; returns how
// many those are now.
int Window::AdmitArrivals(int count, double t, double* y, double* c) {
  if (!IsArrivalDue(t)) return count;
  next_arrival_ = std::numeric_limits<double>::infinity();
  for (int k = 0; k < problem_.delassus.size; ++k) {
    if (seen_[k] == 2 * generation_ - 1) continue;
    const double arrival = Arrival(k);
    if (arrival > t + kAhead * scale_.time) {
      next_arrival_ = std::min(next_arrival_, arrival);
      continue;
    }
    Enter(k, t, y, c);
    seen_[k] = 2 * generation_ - 1;
    previous_[count++] = k;
  }
  return count;
}

void Window::NeighbourSums(int k, double* impulse, double* moment) const {
  const DelassusMatrix& W = problem_.delassus;
  *impulse = *moment = 0;
  if (const BodyRows* rows = W.by_body) {
    *impulse = RowTimes(*rows, k, rows->work + rows->dofs());
    *moment = RowTimes(*rows, k, rows->work + 2 * rows->dofs());
    return;
  }
  for (int a = W.row_start[k]; a < W.row_start[k + 1]; ++a) {
    *impulse += W.value[a] * solution_.impulse[W.column[a]];
    *moment += W.value[a] * solution_.moment[W.column[a]];
  }
  if (!problem_.friction) return;
  Pair of_impulse{}, of_moment{};
  for (int a = W.row_start[k]; a < W.row_start[k + 1]; ++a) {
    const Pair nt = At(problem_.friction->block[a].nt);
    of_impulse += nt * At(solution_.friction + 2 * W.column[a]);
    of_moment += nt * At(solution_.friction_moment + 2 * W.column[a]);
  }
  *impulse += of_impulse[0] + of_impulse[1];
  *moment += of_moment[0] + of_moment[1];
}

void Window::Enter(int k, double t, double* y, double* c) {
  double impulse, moment;
  NeighbourSums(k, &impulse, &moment);
  const double dP = impulse - impulse_left_[k], dM = moment - moment_left_[k];
  c[k] = c_left_[k] - dP;
  y[k] = y_left_[k] + c_left_[k] * (t - t_left_[k]) - (t * dP - dM);
}

void Window::Leave(int k, double t, const double* y, const double* c) {
  NeighbourSums(k, &impulse_left_[k], &moment_left_[k]);
  t_left_[k] = t;
  y_left_[k] = y[k];
  c_left_[k] = c[k];
}

// Visits the contacts of the bodies of contact k, those of each body once in a generation.
template <typename Visit>
void Window::ForBodies(int k, Visit visit) {
  const BodyRows& rows = *problem_.delassus.by_body;
  for (int i = 2 * k; i < 2 * k + 2; ++i) {
    const int body = rows.part[i].body;
    if (body < 0 || rows.mark[body] == generation_) continue;
    rows.mark[body] = generation_;
    for (int a = rows.contact_start[body]; a < rows.contact_start[body + 1]; ++a) {
      visit(rows.contact[a]);
    }
  }
}

void Window::Move(double t, double* y, double* c) {
  if (whole_) return;
  const DelassusMatrix& W = problem_.delassus;
  if (const BodyRows* rows = W.by_body) {
    Answer(W, solution_.impulse, rows->work + rows->dofs());
    Answer(W, solution_.moment, rows->work + 2 * rows->dofs());
    if (const CoulombFriction* friction = problem_.friction) {
      AddTangentAnswers(W, *friction, solution_.friction, rows->work + rows->dofs());
      AddTangentAnswers(W, *friction, solution_.friction_moment, rows->work + 2 * rows->dofs());
    }
  }
  std::swap(member_, previous_);
  ++generation_;
  // previous members carry an odd mark until they are taken again
  for (int i = 0; i < size_; ++i) seen_[previous_[i]] = 2 * generation_ - 1;
  int number = AdmitArrivals(size_, t, y, c);
  size_ = 0;
  const auto take = [&](int l) {
    if (IsMember(l)) return;
    if (seen_[l] != 2 * generation_ - 1) {
      Enter(l, t, y, c);
      previous_[number++] = l;  // it may matter to its own neighbours at once
    }
    seen_[l] = 2 * generation_;
    member_[size_++] = l;
  };
  for (int i = 0; i < number; ++i) {
    const int k = previous_[i];
    if (!Matters(y[k], c[k])) continue;
    if (W.by_body) {
      ForBodies(k, take);
    } else {
      ForNeighbours(W, k, take);
    }
  }
  for (int i = 0; i < number; ++i) {
    const int k = previous_[i];
    if (IsMember(k)) continue;
    Leave(k, t, y, c);
    next_arrival_ = std::min(next_arrival_, Arrival(k));
  }
  std::sort(member_, member_ + size_);
}

}  // namespace mujoco_impact::law
