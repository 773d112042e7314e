// SPDX-License-Identifier: Apache-2.0
// Coulomb friction of the contacts of an island: their tangential rows.
//
// Contact k has, besides its normal row J_n, two tangential ones J_t, perpendicular to the normal
// and to each other. Its slip v = J_t v_bodies [m/s] has the sign of −c = J_n v_bodies: that of one
// side over the other. A normal force F ≥ 0 acts as J_nᵀ F, friction F_t as J_tᵀ F_t:
//
//   F_t = −μ F v / |v|     if the contact slides
//   |F_t| ≤ μ F, v stays 0 if it sticks
//   dc/dt = −(W_nn F + W_nt F_t)        dv/dt = W_tn F + W_tt F_t
//
// (Darboux-Keller dynamics.) W_nn is the Delassus matrix of impact_problem.h. Rotating the two
// tangents of a contact changes no motion.

#ifndef MUJOCO_IMPACT_LAW_COULOMB_H_
#define MUJOCO_IMPACT_LAW_COULOMB_H_

#include "law/delassus.h"

namespace mujoco_impact::law {

// The couplings of the contacts k and l in which tangential rows take part [1/kg].
struct TangentBlock {
  double nt[2];     // J_n,k M⁻¹ J_t,lᵀ: of the normal of k with t1 and t2 of l
  double tn[2];     // J_t,k M⁻¹ J_n,lᵀ: of t1 and t2 of k with the normal of l
  double tt[2][2];  // J_t,k M⁻¹ J_t,lᵀ: tt[i][j] of the tangent i of k with the tangent j of l
};

struct CoulombFriction {
  const double* mu;  // (size) [-] ≥ 0; 0: none, but the contact has tangential rows all the same
  const double*
      slip;  // (2 size) v before the impact [m/s]: t1 and t2 of contact 0, of contact 1, …
  // the tangential rows, in the form that W has: in compressed rows the blocks of its entries,
  // which are then those of all contacts that share a body,
  const TangentBlock* block;  // (row_start[size]), else null
  double* work;               // (row_start[size]), whatever is in it, else null
  // or by bodies: t1 of contact k has the parts 4 k and 4 k + 1, t2 those after them
  const BodyRow* part;  // (4 size), else null
};

// The tangential rows by bodies: row 2 k + a is tangent a of contact k. They share the work.
inline BodyRows TangentRows(const DelassusMatrix& W, const CoulombFriction& friction) {
  BodyRows rows = *W.by_body;
  rows.part = friction.part;
  return rows;
}

// z += M⁻¹ J_tᵀ x, by bodies; x (2 size)
void AddTangentAnswers(const DelassusMatrix& W, const CoulombFriction& friction, const double* x,
                       double* z);

// normal += W_nt x
void AddTangential(const DelassusMatrix& W, const CoulombFriction& friction, const double* x,
                   double* normal);

// slip = v + W_tn p + W_tt x, of the normal impulses p and the tangential ones x
void SlipAfter(const DelassusMatrix& W, const CoulombFriction& friction, const double* p,
               const double* x, double* slip);

// The couplings of the contacts k and l, by bodies.
inline TangentBlock BlockOf(const BodyRows& normals, const BodyRows& tangents, int k, int l) {
  TangentBlock block;
  for (int i = 0; i < 2; ++i) {
    block.nt[i] = Coupling(normals, tangents, k, 2 * l + i);
    block.tn[i] = Coupling(tangents, normals, 2 * k + i, l);
    for (int j = 0; j < 2; ++j) block.tt[i][j] = Coupling(tangents, 2 * k + i, 2 * l + j);
  }
  return block;
}

// Calls visit(l, block) for every contact l that shares a body with contact k, itself included.
template <typename Visit>
void ForBlocks(const DelassusMatrix& W, const CoulombFriction& friction, int k, Visit visit) {
  if (!W.by_body) {
    for (int a = W.row_start[k]; a < W.row_start[k + 1]; ++a) visit(W.column[a], friction.block[a]);
    return;
  }
  const BodyRows &normals = *W.by_body, tangents = TangentRows(W, friction);
  ForNeighbours(W, k, [&](int l) { visit(l, BlockOf(normals, tangents, k, l)); });
}

// Whether friction moves anything: balls on slides, say, cannot slip over each other.
inline bool CanSlip(const TangentBlock& own, double W_nn) {
  constexpr double kImmobile = 1e-9;
  return own.tt[0][0] + own.tt[1][1] > kImmobile * W_nn;
}

// The couplings of one contact with itself.
TangentBlock OwnBlock(const DelassusMatrix& W, const CoulombFriction& friction, int k);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_COULOMB_H_
