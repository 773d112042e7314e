// SPDX-License-Identifier: Apache-2.0
// The impulses that stop contacts from closing faster than they may, all at once:
//
//   p ≥ 0  ⊥  b − (c − W p) ≥ 0
//
// with the closing speeds c and the bounds b ≥ 0 of them. p minimises f = ½ pᵀW p − (c − b)ᵀp over
// p ≥ 0. Projected Gauss-Seidel finds out which contacts push, conjugate gradients how much those
// do (Robinson, Feng, Nocedal and Pang: Subspace accelerated matrix splitting, 2013): a light body
// between heavy ones takes the former as many sweeps as the masses have ratio. Both start at p = 0
// and only lower f, so that kinetic energy, which changes by f − bᵀp, does not grow however early
// they are stopped.

#ifndef MUJOCO_IMPACT_LAW_STOPPING_IMPULSES_H_
#define MUJOCO_IMPACT_LAW_STOPPING_IMPULSES_H_

#include "law/delassus.h"

namespace mujoco_impact::law {

class StoppingImpulses {
 public:
  static constexpr int kArrays = 6;

  // `numbers` has room for kArrays × size.
  StoppingImpulses(const DelassusMatrix& W, double* numbers);

  // Finds p up to changes of speed of `floor`, or until the work is done, in multiplications.
  // Returns whether any contact closes too fast.
  bool Solve(const double* closing_speed, const double* bound, double floor, double work);

  const double* impulse() const { return p_; }
  const double* after() const { return after_; }  // c − W p

  // Multiplications of all solutions.
  double work() const { return work_; }

 private:
  double Sweep(bool fro);
  void MoveInSubspace();
  void FindDirection();
  void FindAfter();
  double After(int k) const;

  const DelassusMatrix& W_;
  const double cost_;  // of a product by W
  double work_ = 0, end_ = 0;
  const double *c_ = nullptr, *b_ = nullptr;
  double *p_, *after_;
  double *residual_, *step_, *answer_, *direction_;  // of the conjugate gradients
};

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_STOPPING_IMPULSES_H_
