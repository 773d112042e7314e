// SPDX-License-Identifier: Apache-2.0

#include "engine/path/weight_gradient.h"

#include <gtest/gtest.h>

#include "tests/engine/scene.h"
#include "tests/engine/trees.h"

namespace mujoco_impact::engine {
namespace {

// Generalized forces of gravity and springs at rest in qpos ⊕ s u.
Numbers ForcesAt(const Numbers& qpos, const Numbers& u, mjtNum s) {
  Scene scene(kTrees);
  mju_copy(scene.d()->qpos, qpos.data(), scene.m()->nq);
  scene.Displace(u.data(), s);
  mj_forward(scene.m(), scene.d());
  Numbers force(scene.d()->qfrc_passive, scene.d()->qfrc_passive + scene.Dofs());
  for (int i = 0; i < scene.Dofs(); ++i) force[i] -= scene.d()->qfrc_bias[i];
  return force;
}

bool FallsFreely(const mjModel* m, int dof) {
  return m->jnt_type[m->dof_jntid[m->tree_dofadr[m->dof_treeid[dof]]]] == mjJNT_FREE;
}

TEST(WeightGradient, IsTheDifferenceOfTheForcesAlongADisplacement) {
  Scene scene(kTrees);
  scene.Disturb();
  const int nv = scene.Dofs();
  const Numbers qpos(scene.d()->qpos, scene.d()->qpos + scene.m()->nq);
  const Numbers u = Mixed(nv, 2.2);
  Numbers gradient(nv, 0.25);
  AddWeightGradient(scene.m(), scene.d(), u.data(), gradient.data());
  const mjtNum s = 1e-5;
  const Numbers after = ForcesAt(qpos, u, s), before = ForcesAt(qpos, u, -s);
  for (int i = 0; i < nv; ++i) {
    if (FallsFreely(scene.m(), i)) continue;
    // forces of some 100 N: rounding of 1e-14 over 1e-5, and s²
    EXPECT_NEAR(gradient[i] - 0.25, (after[i] - before[i]) / (2 * s), 1e-6) << "dof " << i;
  }
}

// Its inertia changes as its weight does, and gravity accelerates it as before.
TEST(WeightGradient, IsNoneOfWhatFallsFreely) {
  Scene scene(kTrees);
  mju_zero(scene.m()->body_gravcomp, static_cast<int>(scene.m()->nbody));
  scene.Disturb();
  const Numbers u = Mixed(scene.Dofs(), 2.2);
  Numbers gradient(scene.Dofs());
  AddWeightGradient(scene.m(), scene.d(), u.data(), gradient.data());
  int falling = 0;
  for (int i = 0; i < scene.Dofs(); ++i) {
    if (!FallsFreely(scene.m(), i) || scene.m()->jnt_stiffness[scene.m()->dof_jntid[i]] > 0) {
      continue;
    }
    ++falling;
    EXPECT_NEAR(gradient[i], 0, 1e-12) << "dof " << i;
  }
  EXPECT_GT(falling, 0);
}

TEST(WeightGradient, LeavesTreesAloneThatDoNotMove) {
  Scene scene(kTrees);
  scene.Disturb();
  const int begin = scene.m()->tree_dofadr[1];
  Numbers u(scene.Dofs()), gradient(scene.Dofs());
  u[begin] = 1;
  AddWeightGradient(scene.m(), scene.d(), u.data(), gradient.data());
  EXPECT_NE(gradient[begin], 0);
  for (int i = 0; i < begin; ++i) EXPECT_EQ(gradient[i], 0);
}

}  // namespace
}  // namespace mujoco_impact::engine
