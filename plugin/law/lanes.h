// SPDX-License-Identifier: Apache-2.0
// The contacts of the window side by side: what an integrator works on.
//
// Lane i is contact window[i]. An array of lanes has a zero in front and is padded to an even
// number with contacts that never press: loops over it need no remainder, and the Delassus matrix
// of a row of bodies no special ends, so that compilers make vector instructions of both.

#ifndef MUJOCO_IMPACT_LAW_LANES_H_
#define MUJOCO_IMPACT_LAW_LANES_H_

#include "law/impact_problem.h"
#include "law/impact_scale.h"
#include "law/pair.h"
#include "law/window.h"

namespace mujoco_impact::law {

class Lanes {
 public:
  // With room for arrays of the integrator's own, `arrays` numbers a lane.
  Lanes(const ImpactProblem& problem, const ImpactSolution& solution, const ImpactScale& scale,
        int arrays, const Workspace& workspace);

  static int Numbers(int size, int arrays, bool friction);
  static int Indices(int size);

  const Window& window() const { return window_; }
  int size() const { return window_.size(); }
  int padded() const { return (size() + 1) & ~1; }
  int contact(int i) const { return window_[i]; }

  // Whether every contact is in its own lane.
  bool all() const { return size() == problem_.delassus.size; }

  // Multiplications in W x, about.
  double product_cost() const { return product_cost_; }

  // The lane of a contact; −1 if it is outside the window.
  int lane(int contact) const { return lane_[contact]; }

  // An array of the integrator's own, zeroed, of so many numbers a lane.
  double* Take(int width = 1);

  // Lets contacts in and out after a step that ended at t; true if the lanes are other ones now.
  bool Move(double t);

  // With friction: the ratio of that of lane i to its normal force. Products are those by W_nn +
  // W_nt ratio, of normal forces with the friction that they bring with them.
  void SetRatio(int i, Pair ratio);

  // product = W x; x has zeros in its padding.
  void Multiply(const double* x, double* product) const {
    if (!tridiagonal_) return MultiplyRows(x, product);
    for (int i = 0, end = padded(); i < end; i += 2) {
      Put(product + i, At(lower_ + i) * At(x + i - 1) + At(middle_ + i) * At(x + i) +
                           At(upper_ + i) * At(x + i + 1));
    }
  }

  // Writes impulses and moments to the solution.
  void Finish();

  double *y, *c;             // compression [m] and closing speed [m/s]
  double *impulse, *moment;  // P [N s], M [N s²] so far
  double* stiffness;         // K [N/m^1.5]; 0 in the padding

  // with friction, two numbers a lane: F_t / F, v [m/s], and what friction has given so far
  double *ratio = nullptr, *slip = nullptr;
  double *friction_impulse = nullptr, *friction_moment = nullptr;

 private:
  static constexpr int kArrays = 9;          // of lanes
  static constexpr int kContactArrays = 2;   // by contact
  static constexpr int kFrictionArrays = 8;  // of lanes, if there is friction
  static constexpr int kMargin = 3;          // numbers that an array of lanes has beyond its size

  void Load();
  void Store();
  void LoadMatrix();
  void MultiplyRows(const double* x, double* product) const;
  void MultiplyByBody(const BodyRows& rows, const double* x, double* product) const;
  void MultiplyColumns(const double* x, double* product) const;
  void LoadFriction();
  bool IsFull() const;
  void StoreFriction() const;
  bool MustMove(double t) const;

  const ImpactProblem& problem_;
  const ImpactSolution& solution_;
  double* free_;  // where the next array begins
  double *y_of_contact_, *c_of_contact_;
  Window window_;
  int* lane_;
  double* ratio_of_contact_;
  double* matters_;                   // by lane: 1 if it keeps its neighbours in the window
  double *lower_, *middle_, *upper_;  // W, if lanes couple with their neighbours only
  bool tridiagonal_ = false;
  bool full_ = false;  // with friction: all lanes couple, in the order of the contacts
  double product_cost_ = 0;
};

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_LANES_H_
