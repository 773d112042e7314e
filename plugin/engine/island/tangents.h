// SPDX-License-Identifier: Apache-2.0
// The tangential rows of an island whose contacts have Coulomb friction (law/coulomb.h).
//
// The coefficient is MuJoCo's own of the contact, which has combined those of the geoms, unless a
// material says otherwise (scene/materials.h). Torsional and rolling friction are lengths of the
// size of the contact, .1 mm in an impact, and are left to MuJoCo's contacts at rest.

#ifndef MUJOCO_IMPACT_ENGINE_ISLAND_TANGENTS_H_
#define MUJOCO_IMPACT_ENGINE_ISLAND_TANGENTS_H_

#include <mujoco/mujoco.h>

#include <cstddef>

#include "engine/common/scratch.h"
#include "engine/island/delassus.h"
#include "engine/island/impact.h"
#include "engine/island/island_system.h"
#include "engine/path/mobility.h"
#include "engine/path/motion.h"
#include "engine/scene/materials.h"

namespace mujoco_impact::engine {

// A row like that of a contact, for a direction along the surface.
struct SlipRow {
  RowSegment segment[2];
};

SlipRow MakeSlipRow(const mjModel* m, const ContactRow& row, Scratch& scratch);

// slip = dᵀ(J₂ − J₁) at the surfaces, at τ on the path of `motion`
void FillSlipRow(const mjModel* m, const mjData* d, const ContactRow& row, const Motion& motion,
                 mjtNum tau, const Vector3& direction, SlipRow& slip);

// Two directions that with the normal are perpendicular to each other.
struct TangentPlane {
  Vector3 axis[2];
};

TangentPlane TangentsOf(const Vector3& normal);

// Whether any contact of an island has friction.
bool HasFriction(const Materials& materials, const Gathered& contacts, const int* position,
                 int count);

// Whether any contact at all has friction.
bool HasFriction(const Materials& materials, const Gathered& contacts);

// The tangents of an island: of contact k the axes 2 k and 2 k + 1.
struct Tangents {
  SlipRow* row;     // (2 size)
  Vector3* axis;    // (2 size)
  mjtNum* impulse;  // (2 size) of friction [N s], on geom[1]
  mjtNum* moment;   // (2 size) [N s²]
  mjtNum* after;    // (2 size) slip after the impact [m/s]
  law::CoulombFriction friction;
};

// Bytes of scratch for them: `dofs` is the sum of those of the trees of all contacts, `size` that
// of the Delassus matrix.
size_t TangentBytes(const mjModel* m, const Mobility& mobility, int contacts, size_t dofs,
                    const DelassusSize& size);

// Builds them for the velocity of the bodies at τ (nv).
Tangents* BuildTangents(const mjModel* m, const mjData* d, const Mobility& mobility,
                        const Materials& materials, const IslandSystem& system,
                        const Motion& motion, mjtNum tau, const mjtNum* velocity, Scratch& scratch);

// Turns the rows of contacts with friction from n to n + ρ t, ρ t their tangential impulse over
// the normal one, and notes that in their impacts: everything that delivers impulses goes on as
// without friction.
void TurnRows(const mjModel* m, const Tangents& tangents, IslandSystem& system, Impact* impacts);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_ISLAND_TANGENTS_H_
