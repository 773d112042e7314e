// SPDX-License-Identifier: Apache-2.0
// What an impulse does to the velocities: M⁻¹, and what equality constraints make of it.
//
// MuJoCo answers a force f in the same step with
//
//   a = M̃⁻¹ f + M⁻¹Jᵀ(A + R)⁻¹ a_ref      M̃⁻¹ = M⁻¹ − M⁻¹Jᵀ(A + R)⁻¹J M⁻¹,  A = J M⁻¹Jᵀ
//
// J the rows of the equality constraints, R their regularization: an impulse on a body moves those
// that it is tied to as well. Stops that hold in an impact are rigid ties of it (stops.h). Dry
// friction and contacts of MuJoCo are left out.

#ifndef MUJOCO_IMPACT_ENGINE_PATH_MOBILITY_H_
#define MUJOCO_IMPACT_ENGINE_PATH_MOBILITY_H_

#include <mujoco/mujoco.h>

#include <cstddef>

#include "engine/common/scratch.h"

namespace mujoco_impact::engine {

class Stops;

class Mobility {
 public:
  // Of the constraints that MuJoCo found in the state in `d`; they stay as they are when the bodies
  // are moved within the step.
  Mobility(const mjModel* m, mjData* d, Scratch& scratch);

  // Those of `others`, and the stops that hold, by the inertia of the bodies where they are now;
  // the scratch must have `StopBytes`.
  Mobility(const Mobility& others, const Stops& stops, Scratch& scratch);
  static size_t StopBytes(const mjModel* m, const Mobility& others, const Stops& stops);

  mjData* data() const { return d_; }

  // Number of rows: of equality constraints, then of stops.
  int ties() const { return ties_; }
  int stops() const { return stops_; }

  // J_i and M⁻¹ J_iᵀ (nv each).
  mjtNum* row(int i) const { return rows_ + i * m_->nv; }
  mjtNum* answer(int i) const { return answer_ + i * m_->nv; }

  // Whether an impulse on one of the trees moves the other.
  bool AreTied(int tree, int other) const { return Group(tree) == Group(other); }

  // A tree that stands for all that are tied to this one.
  int Group(int tree) const { return group_ ? group_[tree] : tree; }

  // x = M̃⁻¹ y (nv each, not the same array), zero for trees that sleep.
  void Solve(mjtNum* x, const mjtNum* y) const;

  // x = M⁻¹ y becomes M̃⁻¹ y; `force`, unless null, gets what each tie pulls with for that (ties).
  void Tie(mjtNum* x, mjtNum* force = nullptr) const;

  // Takes out of a velocity, or an acceleration, what the stops that hold do not let through.
  void Halt(mjtNum* x) const;

  // Adds to a sum the impulses of the stops that hold against `impulse` (nv each).
  void AddStops(const mjtNum* impulse, mjtNum* sum, Scratch& scratch) const;

  // Calls visit(tree, its first degree of freedom) for the trees of row i.
  template <typename Visit>
  void ForTrees(int i, Visit visit) const {
    for (int tree = 0; tree < m_->ntree; ++tree) {
      const int begin = m_->tree_dofadr[tree];
      if (!mju_isZero(row(i) + begin, m_->tree_dofnum[tree])) visit(tree, begin);
    }
  }

  // a += M⁻¹Jᵀ(A + R)⁻¹ a_ref: what ties pull with where they are not satisfied.
  void AddReference(mjtNum* a) const;

  // J x for x that is zero but on the dofs of one tree, added to `result` (ties).
  void AddTieRates(int tree, const mjtNum* x, mjtNum* result) const;

  // y = (A + R)⁻¹ x (ties each).
  void SolveTies(mjtNum* y, const mjtNum* x) const { mju_cholSolve(y, factor_, x, ties_); }

 private:
  void TakeRows(Scratch& scratch);
  void AddForces(const mjtNum* force, mjtNum* x) const;
  void FindGroups(Scratch& scratch);

  const mjModel* m_;
  mjData* d_;
  int ties_ = 0, stops_ = 0;
  mjtNum* rows_ = nullptr;       // J (ties × nv)
  mjtNum* answer_ = nullptr;     // J M⁻¹ (ties × nv)
  mjtNum* factor_ = nullptr;     // of A + R (ties × ties)
  mjtNum* reference_ = nullptr;  // a_ref (ties)
  mjtNum* work_ = nullptr;       // (2 ties)
  int* group_ = nullptr;         // (ntree)
};

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_PATH_MOBILITY_H_
