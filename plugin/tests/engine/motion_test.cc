// SPDX-License-Identifier: Apache-2.0

#include "engine/path/motion.h"

#include <gtest/gtest.h>

#include "tests/engine/scene.h"
#include "tests/engine/trees.h"

namespace mujoco_impact::engine {
namespace {

TEST(TreeInertia, IsSolvedAsMuJoCoSolvesAllOfThem) {
  Scene scene(kTrees);
  scene.Disturb();
  const Numbers y = Mixed(scene.Dofs(), 0.7);
  Numbers expected(scene.Dofs()), x = y;
  mj_solveM(scene.m(), scene.d(), expected.data(), y.data(), 1);
  for (int tree = 0; tree < scene.m()->ntree; ++tree) {
    SolveTreeInertia(scene.m(), scene.d(), tree, x.data() + scene.m()->tree_dofadr[tree]);
  }
  for (int i = 0; i < scene.Dofs(); ++i) {
    EXPECT_NEAR(x[i], expected[i], 1e-12 * (1 + std::abs(expected[i]))) << "dof " << i;
  }
}

}  // namespace
}  // namespace mujoco_impact::engine
