// SPDX-License-Identifier: Apache-2.0
// Disjoint sets of kinematic trees, joined by what acts between them.

#ifndef MUJOCO_IMPACT_ENGINE_COMMON_TREE_SETS_H_
#define MUJOCO_IMPACT_ENGINE_COMMON_TREE_SETS_H_

#include "engine/common/scratch.h"

namespace mujoco_impact::engine {

// With path halving.
class TreeSets {
 public:
  TreeSets(int ntree, Scratch& scratch) : parent_(scratch.Take<int>(ntree)) {
    for (int i = 0; i < ntree; ++i) parent_[i] = i;
  }

  int Root(int tree) {
    while (parent_[tree] != tree) {
      parent_[tree] = parent_[parent_[tree]];
      tree = parent_[tree];
    }
    return tree;
  }

  void Join(int a, int b) { parent_[Root(a)] = Root(b); }

 private:
  int* parent_;
};

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_COMMON_TREE_SETS_H_
