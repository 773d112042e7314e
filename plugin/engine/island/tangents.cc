// SPDX-License-Identifier: Apache-2.0

#include "engine/island/tangents.h"

#include <algorithm>
#include <cmath>
#include <new>

#include "engine/island/delassus.h"
#include "engine/island/islands.h"
#include "engine/path/point.h"
#include "engine/scene/tree_kinds.h"

namespace mujoco_impact::engine {

namespace {

// J_k M⁻¹ J_lᵀ of two rows.
mjtNum Couple(const mjModel* m, const RowSegment* k, const RowSegment* l) {
  mjtNum sum = 0;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      if (k[i].tree < 0 || k[i].tree != l[j].tree) continue;
      sum += mju_dot(k[i].jacobian, l[j].inverse_inertia, m->tree_dofnum[k[i].tree]);
    }
  }
  return sum;
}

// What ties take up of the couplings: of each contact the rates J_t M⁻¹ Jᵀ of its three rows, and
// the forces (A + R)⁻¹ times that (3 × size × ties).
class TiedRows {
 public:
  TiedRows(const Mobility& mobility, const IslandSystem& system, const SlipRow* slip,
           Scratch& scratch)
      : ties_(mobility.ties()) {
    if (ties_ == 0) return;
    rates_ = scratch.Zeros(3 * system.size * ties_);
    forces_ = scratch.Take<mjtNum>(3 * system.size * ties_);
    for (int k = 0; k < system.size; ++k) {
      const RowSegment* rows[3] = {system.row[k].segment, slip[2 * k].segment,
                                   slip[2 * k + 1].segment};
      for (int a = 0; a < 3; ++a) {
        mjtNum* rates = rates_ + (3 * k + a) * ties_;
        for (int i = 0; i < 2; ++i) {
          const RowSegment& segment = rows[a][i];
          if (segment.tree >= 0) mobility.AddTieRates(segment.tree, segment.inverse_inertia, rates);
        }
        mobility.SolveTies(forces_ + (3 * k + a) * ties_, rates);
      }
    }
  }

  // Of row a of contact k with row b of contact l; 0 is the normal.
  mjtNum TakenUp(int k, int a, int l, int b) const {
    if (ties_ == 0) return 0;
    return mju_dot(forces_ + (3 * k + a) * ties_, rates_ + (3 * l + b) * ties_, ties_);
  }

 private:
  const int ties_;
  mjtNum *rates_ = nullptr, *forces_ = nullptr;
};

law::TangentBlock* BuildBlocks(const mjModel* m, const Mobility& mobility,
                               const IslandSystem& system, const SlipRow* slip, Scratch& scratch) {
  const law::DelassusMatrix& W = system.delassus;
  auto* blocks = scratch.Take<law::TangentBlock>(W.row_start[W.size]);
  const TiedRows tied(mobility, system, slip, scratch);
  for (int k = 0; k < W.size; ++k) {
    for (int a = W.row_start[k]; a < W.row_start[k + 1]; ++a) {
      const int l = W.column[a];
      law::TangentBlock& block = blocks[a];
      for (int i = 0; i < 2; ++i) {
        const RowSegment *of_k = slip[2 * k + i].segment, *of_l = slip[2 * l + i].segment;
        block.nt[i] = Couple(m, system.row[k].segment, of_l) - tied.TakenUp(k, 0, l, i + 1);
        block.tn[i] = Couple(m, of_k, system.row[l].segment) - tied.TakenUp(k, i + 1, l, 0);
        for (int j = 0; j < 2; ++j) {
          block.tt[i][j] =
              Couple(m, of_k, slip[2 * l + j].segment) - tied.TakenUp(k, i + 1, l, j + 1);
        }
      }
    }
  }
  return blocks;
}

// Whether a contact can part while friction holds it: the Schur complement of its own couplings,
//
//   W_nn − W_nt W_tt⁻¹ W_tn
//
// is no small part of W_nn. That of an arm of one or two joints on a wall cannot. In rigid friction
// it would wedge, with impulses without bound that move nothing, and so its impacts have none.
bool CanPart(const law::TangentBlock& own, mjtNum nn) {
  constexpr mjtNum kLeast = 1e-2, kRounding = 1e-9;
  const mjtNum n1 = own.nt[0], n2 = own.nt[1], b = own.tt[0][1];
  const mjtNum a = own.tt[0][0] + kRounding * nn, c = own.tt[1][1] + kRounding * nn;
  const mjtNum taken = (c * n1 * n1 - 2 * b * n1 * n2 + a * n2 * n2) / (a * c - b * b);
  return nn - taken > kLeast * nn;
}

// The velocity of the surfaces along their geoms (`surfacevel`), of side 0 over side 1.
Vector3 BeltVelocity(const mjModel* m, const mjData* d, const ContactRow& row, mjtNum tau) {
  Vector3 velocity[2];
  for (int i = 0; i < 2; ++i) {
    const int geom = row.contact->geom[i];
    const mjtNum* belt = m->geom_surfacevel + 6 * geom;
    const mjtNum* R = d->geom_xmat + 9 * geom;
    const Vector3 surface = SurfacePoint(m, geom, i, row.path.SideAt(i, tau), row.normal);
    const Vector3 arm = surface - Load(d->geom_xpos + 3 * geom);
    velocity[i] = Rotate(R, Load(belt)) + Cross(Rotate(R, Load(belt + 3)), arm);
  }
  return velocity[0] - velocity[1];
}

}  // namespace

TangentPlane TangentsOf(const Vector3& n) {
  const Vector3 other = std::abs(n.x) < 0.5 ? Vector3{1, 0, 0} : Vector3{0, 1, 0};
  const Vector3 across = Cross(n, other);
  const Vector3 first = 1 / Norm(across) * across;
  return {{first, Cross(n, first)}};
}

SlipRow MakeSlipRow(const mjModel* m, const ContactRow& row, Scratch& scratch) {
  SlipRow slip;
  for (int i = 0; i < 2; ++i) {
    const int tree = row.segment[i].tree;
    const int dofs = tree < 0 ? 0 : m->tree_dofnum[tree];
    slip.segment[i] = {tree, scratch.Zeros(dofs), scratch.Zeros(dofs)};
  }
  return slip;
}

void FillSlipRow(const mjModel* m, const mjData* d, const ContactRow& row, const Motion& motion,
                 mjtNum tau, const Vector3& direction, SlipRow& slip) {
  for (const RowSegment& segment : slip.segment) {
    if (segment.tree >= 0) mju_zero(segment.jacobian, m->tree_dofnum[segment.tree]);
  }
  const ContactTrees trees = TreesOf(m, *row.contact);
  const bool merged = trees.tree[0] == trees.tree[1];
  for (int i = 0; i < 2; ++i) {
    if (trees.tree[i] < 0) continue;
    const Vector3 surface =
        SurfacePoint(m, row.contact->geom[i], i, row.path.SideAt(i, tau), row.normal);
    AddRowAt(m, d, row.path.side(i), motion, tau, surface, direction, i == 0 ? -1 : 1,
             slip.segment[merged ? 0 : i].jacobian);
  }
}

bool HasFriction(const Materials& materials, const Gathered& contacts, const int* position,
                 int count) {
  return std::any_of(position, position + count,
                     [&](int i) { return materials.Friction(*contacts.contact[i]) > 0; });
}

bool HasFriction(const Materials& materials, const Gathered& contacts) {
  return std::any_of(contacts.contact, contacts.contact + contacts.count,
                     [&](const mjContact* contact) { return materials.Friction(*contact) > 0; });
}

size_t TangentBytes(const mjModel* m, const Mobility& mobility, int contacts, size_t dofs,
                    const DelassusSize& size) {
  const size_t n = contacts, ties = mobility.ties();
  const size_t rows = 2 * n * (sizeof(SlipRow) + sizeof(Vector3) + sizeof(RowSegment*));
  // two rows of a Jacobian and two answers; impulse, moment, slip before and after; μ
  size_t numbers = 2 * 2 * dofs + 4 * 2 * n + n;
  size_t matrix = 0;
  if (IsByBody(size)) {
    // what is tied has its rows side by side
    numbers += ties > 0 ? 2 * 2 * size.dofs + static_cast<size_t>(m->nv) : 0;
    matrix = 4 * n * sizeof(law::BodyRow) + 2 * m->ntree * sizeof(int);
  } else {
    numbers += size.couplings + 2 * 3 * n * ties;
    matrix = size.couplings * sizeof(law::TangentBlock);
  }
  constexpr size_t kAlignment = 1024;
  return sizeof(Tangents) + rows + matrix + numbers * sizeof(mjtNum) + kAlignment;
}

Tangents* BuildTangents(const mjModel* m, const mjData* d, const Mobility& mobility,
                        const Materials& materials, const IslandSystem& system,
                        const Motion& motion, mjtNum tau, const mjtNum* velocity,
                        Scratch& scratch) {
  const int n = system.size;
  const law::DelassusMatrix& W = system.delassus;
  auto* tangents = new (scratch.Take<Tangents>(1))
      Tangents{scratch.Take<SlipRow>(2 * n), scratch.Take<Vector3>(2 * n), scratch.Zeros(2 * n),
               scratch.Zeros(2 * n),         scratch.Zeros(2 * n),         {}};
  mjtNum *mu = scratch.Take<mjtNum>(n), *slip = scratch.Take<mjtNum>(2 * n);
  for (int k = 0; k < n; ++k) {
    const ContactRow& row = system.row[k];
    const TangentPlane plane = TangentsOf(row.normal);
    mu[k] = materials.Friction(*row.contact);
    const Vector3 belt = m->flg_surfacevel ? BeltVelocity(m, d, row, tau) : Vector3{};
    for (int i = 2 * k; i < 2 * k + 2; ++i) {
      SlipRow& along = tangents->row[i] = MakeSlipRow(m, row, scratch);
      tangents->axis[i] = plane.axis[i - 2 * k];
      FillSlipRow(m, d, row, motion, tau, tangents->axis[i], along);
      SolveSegments(m, d, along.segment);
      // of side 1 over side 0
      slip[i] =
          SegmentsTimes(m, along.segment, velocity) - Dot(row.driven + belt, tangents->axis[i]);
    }
  }
  law::CoulombFriction& friction = tangents->friction;
  friction = {mu, slip, nullptr, nullptr, nullptr};
  if (W.by_body) {
    const RowSegment** rows = scratch.Take<const RowSegment*>(2 * n);
    for (int i = 0; i < 2 * n; ++i) rows[i] = tangents->row[i].segment;
    friction.part = RowParts(m, mobility, rows, 2 * n, scratch);
  } else {
    friction.block = BuildBlocks(m, mobility, system, tangents->row, scratch);
    friction.work = scratch.Take<mjtNum>(W.row_start[n]);
  }
  for (int k = 0; k < n; ++k) {
    if (!CanPart(law::OwnBlock(W, friction, k), W.diagonal[k])) mu[k] = 0;
  }
  return tangents;
}

void TurnRows(const mjModel* m, const Tangents& tangents, IslandSystem& system, Impact* impacts) {
  for (int k = 0; k < system.size; ++k) {
    const mjtNum P = impacts[k].impulse;
    if (P <= 0) continue;
    for (int i = 2 * k; i < 2 * k + 2; ++i) {
      const mjtNum ratio = tangents.impulse[i] / P;
      impacts[k].tangent += ratio * tangents.axis[i];
      for (int side = 0; side < 2; ++side) {
        const RowSegment& row = system.row[k].segment[side];
        if (row.tree < 0) continue;
        const RowSegment& along = tangents.row[i].segment[side];
        const int dofs = m->tree_dofnum[row.tree];
        mju_addToScl(row.jacobian, along.jacobian, ratio, dofs);
        mju_addToScl(row.inverse_inertia, along.inverse_inertia, ratio, dofs);
      }
    }
  }
}

}  // namespace mujoco_impact::engine
