// SPDX-License-Identifier: Apache-2.0
// The contacts of one island as rows of a Jacobian, and their Delassus matrix W = J M̃⁻¹ Jᵀ.
//
// A row has at most two segments, one per kinematic tree that the contact joins, so W couples only
// contacts that share a tree, or tied ones (a row of balls gives a tridiagonal W), and no row is
// ever as long as the model. Rows are taken at the time of impact: n(τ)ᵀ (J + τ J̇).

#ifndef MUJOCO_IMPACT_ENGINE_ISLAND_ISLAND_SYSTEM_H_
#define MUJOCO_IMPACT_ENGINE_ISLAND_ISLAND_SYSTEM_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/foresee/gather.h"
#include "engine/path/contact_path.h"
#include "engine/path/mobility.h"
#include "engine/path/motion.h"
#include "law/impact_problem.h"

namespace mujoco_impact::engine {

// The part of a contact's row that lies on one kinematic tree.
struct RowSegment {
  int tree;                 // −1: static or merged into the other segment
  mjtNum* jacobian;         // J_k on the dofs of the tree
  mjtNum* inverse_inertia;  // M⁻¹ J_kᵀ on the dofs of the tree
};

struct ContactRow {
  const mjContact* contact;
  ContactPath path;
  Vector3 normal;    // n(τ), from geom[0] to geom[1]
  mjtNum gap;        // gap(τ) [m]
  mjtNum curvature;  // 1/R* [1/m]
  mjtNum turn_rate;  // of the normal [rad/s]
  Vector3 driven;    // velocity that mocap bodies give to side 0 over side 1 [m/s]
  RowSegment segment[2];
};

struct IslandSystem {
  int size;
  ContactRow* row;
  law::DelassusMatrix delassus;
};

// Bytes of scratch that the island of the contacts at these positions takes, with tangential rows
// or without.
size_t IslandBytes(const mjModel* m, const Mobility& mobility, const Gathered& contacts,
                   const int* position, int count, bool friction, Scratch& scratch);

// Builds the rows at time τ on the path of `motion`; the gaps are those of the time `begin`, when
// the first contact of the island closes.
IslandSystem BuildIsland(const mjModel* m, const mjData* d, const Mobility& mobility,
                         Gathered& contacts, const int* position, int count, const Motion& motion,
                         mjtNum tau, mjtNum begin, Scratch& scratch);

// J x of two segments for a vector of all degrees of freedom.
mjtNum SegmentsTimes(const mjModel* m, const RowSegment segment[2], const mjtNum* x);

// Fills in M⁻¹ Jᵀ of two segments.
void SolveSegments(const mjModel* m, const mjData* d, const RowSegment segment[2]);

// J_k x for a vector of all degrees of freedom.
mjtNum RowTimes(const mjModel* m, const ContactRow& row, const mjtNum* x);

// x += M⁻¹ J_kᵀ s, without what ties make of it
void AddUntied(const mjModel* m, const RowSegment row[2], mjtNum s, mjtNum* x);

// x += M̃⁻¹ J_kᵀ s
void AddAnswer(const mjModel* m, const Mobility& mobility, const RowSegment row[2], mjtNum s,
               mjtNum* x, Scratch& scratch);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_ISLAND_ISLAND_SYSTEM_H_
