// SPDX-License-Identifier: Apache-2.0
// The kinematic trees of contacts, and of what kind they are, as far as it decides how an impact is
// followed.

#ifndef MUJOCO_IMPACT_ENGINE_SCENE_TREE_KINDS_H_
#define MUJOCO_IMPACT_ENGINE_SCENE_TREE_KINDS_H_

#include <mujoco/mujoco.h>

namespace mujoco_impact::engine {

// The kinematic trees that a contact joins; −1 for a static side.
struct ContactTrees {
  int tree[2];
};

ContactTrees TreesOf(const mjModel* m, const mjContact& contact);

// Whether the tree hangs on one free joint and nothing in it moves against the rest.
bool IsFreeBody(const mjModel* m, int tree);

// Whether it has the same inertia about all axes through its joint as well.
bool IsBall(const mjModel* m, int tree);

// Whether the inertia of the tree stays as it is while its bodies move: one degree of freedom,
// slides alone, or a ball whose centre is its joint.
bool KeepsInertia(const mjModel* m, int tree);

// The first number of the position of a tree in qpos, and how many it has.
int FirstPosition(const mjModel* m, int tree);
int PositionNumber(const mjModel* m, int tree);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_SCENE_TREE_KINDS_H_
