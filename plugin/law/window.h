// SPDX-License-Identifier: Apache-2.0
// The part of an island that is integrated.

#ifndef MUJOCO_IMPACT_LAW_WINDOW_H_
#define MUJOCO_IMPACT_LAW_WINDOW_H_

#include "law/impact_problem.h"
#include "law/impact_scale.h"

namespace mujoco_impact::law {

// The contacts that are integrated: those that press or are about to close, and their neighbours.
// Any other contact feels nothing meanwhile, and is caught up exactly when a force comes near,
//
//   c = c_d − Σ W (P − P_d)        y = y_d + c_d (t − t_d) − Σ W (t (P − P_d) − (M − M_d))
//
// from the impulses and moments of its neighbours since it was left (index d). So a wave that
// travels along a row costs as much per ball however long the row is.
class Window {
 public:
  Window(const ImpactProblem& problem, const ImpactSolution& solution, const ImpactScale& scale,
         const Workspace& workspace);

  int size() const { return size_; }
  int operator[](int i) const { return member_[i]; }

  // When the next contact outside closes by itself; infinity if none does.
  double NextArrival() const;

  // Small islands are integrated whole: the window never moves.
  bool whole() const { return whole_; }

  // Whether a contact keeps itself and its neighbours in.
  bool Matters(double y, double c) const {
    if (y > noticeable_compression_) return true;
    return c > noticeable_speed_ && -y <= kStay * scale_.time * c;
  }

  // Whether a contact outside is about to close at t.
  bool IsArrivalDue(double t) const { return t + kAhead * scale_.time >= next_arrival_; }

  // Lets contacts in and out after a step that ended at t, in ascending order; y and c by contact.
  void Move(double t, double* y, double* c);

  static constexpr int kArrays = 5;
  static constexpr int kIndexArrays = 3;

 private:
  // Contact times before a closing at which its contact comes in, and up to which it stays.
  static constexpr double kAhead = 1, kStay = 2;

  double Arrival(int k) const;
  bool IsMember(int k) const { return seen_[k] == 2 * generation_; }
  template <typename Visit>
  void ForBodies(int k, Visit visit);
  int AdmitArrivals(int count, double t, double* y, double* c);
  void Enter(int k, double t, double* y, double* c);
  void Leave(int k, double t, const double* y, const double* c);
  void NeighbourSums(int k, double* impulse, double* moment) const;

  const ImpactProblem& problem_;
  const ImpactSolution& solution_;
  const ImpactScale& scale_;
  const bool whole_;
  const double noticeable_speed_, noticeable_compression_;
  int size_ = 0;
  int generation_ = 0;
  int *member_, *previous_;
  int* seen_;            // by contact: 2 g if taken in generation g, 2 g − 1 if a member before
  double next_arrival_;  // not later than NextArrival()
  double *t_left_, *y_left_, *c_left_, *impulse_left_, *moment_left_;
};

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_WINDOW_H_
