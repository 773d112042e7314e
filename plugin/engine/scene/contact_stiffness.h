// SPDX-License-Identifier: Apache-2.0
// How stiff the bodies of a contact are against each other, by their shapes and the material.
//
// K = 4/3 E* √R*, 1/R* the sum of the curvatures of the two surfaces where they touch:
//
//   sphere, capsule          1/r
//   cylinder                 side 1/r, face 0
//   ellipsoid                1/√(R′R″), R′ and R″ its principal radii where the normal is n, which
//                            is (a² n₁² + b² n₂² + c² n₃²)/(a b c) for half-axes a, b, c
//   plane, height field      0
//   box, mesh                face 0
//   their edges and corners  1/(0.05 s), s the smallest half-size: a real edge is rounded
//   both flat                as a sphere of the size of the smaller body
//
// Exact for spheres on spheres and planes, and for ellipsoids on planes but for some percent in
// elongated ones (Johnson, Contact Mechanics, 4.2). Where not, it is of the right order, and sets
// only how long a contact lasts and how it shares an impulse.

#ifndef MUJOCO_IMPACT_ENGINE_SCENE_CONTACT_STIFFNESS_H_
#define MUJOCO_IMPACT_ENGINE_SCENE_CONTACT_STIFFNESS_H_

#include <mujoco/mujoco.h>

#include "engine/scene/materials.h"

namespace mujoco_impact::engine {

// 1/R* [1/m].
mjtNum ContactCurvature(const mjModel* m, const mjData* d, const mjContact& contact);

// How long two bodies touch that close with `speed`, by the masses of the bodies alone [s].
mjtNum EstimateContactTime(const mjModel* m, const mjData* d, const Materials& materials,
                           const mjContact& contact, mjtNum speed);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_SCENE_CONTACT_STIFFNESS_H_
