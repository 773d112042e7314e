// SPDX-License-Identifier: Apache-2.0
// Friction of one contact over a step, the forces of all others given.
//
// With the friction p = ∫ F_t dt that has the bound |p| ≤ R = μ ΔP, the slip goes from v to b + A
// p, A = W_tt of the contact. Coulomb's law over a step:
//
//   sticks:  p = −A⁻¹ b, the slip at the end is 0, if |p| ≤ R
//   slides:  p = −(A + λ)⁻¹ (v + b), λ ≥ 0, |p| = R: p is against the mean slip of the step, which
//            makes its work, p·(v + b + A p)/2, ≤ 0 and a turning slip right to second order
//   turns round: where that has no solution, or leaves a slip along p, p is against the slip at the
//            end, p = −(A + λ)⁻¹ b
//
// All three minimise pᵀA p/2 + gᵀp on the disc |p| ≤ R, for one g or the other.

#ifndef MUJOCO_IMPACT_LAW_FRICTION_ON_DISC_H_
#define MUJOCO_IMPACT_LAW_FRICTION_ON_DISC_H_

#include "law/pair.h"

namespace mujoco_impact::law {

// A symmetric positive definite 2 × 2 matrix.
struct Tangents {
  double a, b, c;  // A = (a b; b c)
};

// A with its null directions lifted by 1e-9 of its trace, so that A⁻¹ exists: friction does nothing
// along them.
Tangents Lifted(const double tt[2][2]);

// p [N s] of a contact with slip v at the beginning and b [m/s] at the end without its friction, in
// a step in which |p| ≤ R.
Pair FrictionOfStep(const Tangents& A, Pair v, Pair b, double R);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_FRICTION_ON_DISC_H_
