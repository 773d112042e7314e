// SPDX-License-Identifier: Apache-2.0
// Friction of one contact over a step, what all others do given.
//
// Friction p = ∫ F_t ds has the bound R = μ ΔP. It changes the slip from v at the beginning to b +
// A p at the end, A = W_tt of the contact. Coulomb's law over the step:
//
//   sticks:      p = −A⁻¹ b, the slip at the end is 0
//   slides:      p = −(A + λ)⁻¹ (v + b), λ ≥ 0, |p| = R: against the mean slip of the step, so that
//   its
//                work p·(v + b + A p)/2 is ≤ 0 and a slip that turns is right to second order
//   stops, or begins to slide, within the step: what it does before and after, one after the other;
//                exact for a slip along a line and forces that share their time course
//
// Sliding friction minimises pᵀA p/2 + gᵀp on the disc |p| ≤ R, g = v + b.

#ifndef MUJOCO_IMPACT_LAW_FRICTION_ON_DISC_H_
#define MUJOCO_IMPACT_LAW_FRICTION_ON_DISC_H_

#include "law/pair.h"

namespace mujoco_impact::law {

// W_tt of a contact, symmetric and positive definite: A = (a b; b c).
struct Tangents {
  double a, b, c;
};

// A⁻¹
inline Tangents Inverse(const Tangents& A) {
  const double over = 1 / (A.a * A.c - A.b * A.b);
  return {over * A.c, -over * A.b, over * A.a};
}

// W_tt with its null directions lifted by 1e-9 of its trace, so that A⁻¹ exists: friction does
// nothing along them.
Tangents Lifted(const double tt[2][2]);

// A x
inline Pair Times(const Tangents& A, Pair x) {
  return Pair{A.a * x[0] + A.b * x[1], A.b * x[0] + A.c * x[1]};
}

// The step as a contact sees it. Ratios of friction to normal force are in units of 1/ΔP.
struct ContactStep {
  const Tangents &A, &inverse;
  double R;     // μ ΔP [N s]
  Pair v, b;    // slip at the beginning, and at the end without its own friction [m/s]
  Pair before;  // ratio at the end of the step before
  bool stuck;   // whether that was within the cone
  // change of the slip in a step that goes on as it is at the beginning, and at the end, where the
  // ratio is as given: friction of its own included [m/s]
  const double *first_rate, *rate, *ratio;
};

struct StepFriction {
  Pair p;        // ∫ F_t ds [N s]
  Pair lead;     // ∫ (h − s) F_t ds in units of what the normal force has: ∫ (h − s) F ds / ΔP
  Pair ratio;    // at the end
  double theta;  // part of the step after which it stops or begins to slide; 0: it does not
};

StepFriction FrictionOfStep(const ContactStep& step);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_FRICTION_ON_DISC_H_
