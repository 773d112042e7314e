// SPDX-License-Identifier: Apache-2.0

#include "engine/path/point.h"

#include <gtest/gtest.h>

#include "engine/common/scratch.h"
#include "tests/engine/scene.h"
#include "tests/engine/trees.h"

namespace mujoco_impact::engine {
namespace {

const Vector3 kLocal{0.07, -0.04, 0.11}, kNormal{0.48, -0.6, 0.64};

// One point of every moving body of the trees, moved along the path of a motion.
class MovingPoint : public testing::TestWithParam<int> {
 protected:
  MovingPoint() : scene_(kTrees), scratch_(scene_.d()) {
    scene_.Disturb();
    const int nv = scene_.Dofs();
    const Mobility mobility(scene_.m(), scene_.d(), scratch_);
    motion_ = PredictMotion(scene_.m(), scene_.d(), mobility, scratch_);
    point_ = {GetParam(), Now()};
    qpos_.assign(scene_.d()->qpos, scene_.d()->qpos + scene_.m()->nq);
    tree_ = scene_.m()->body_treeid[point_.body];
    begin_ = scene_.m()->tree_dofadr[tree_];
    dofs_ = scene_.m()->tree_dofnum[tree_];
    EXPECT_EQ(nv, 6 + 2 + 3 + 3 + 3 + 2);
  }

  // Where the point is with the bodies of mjData.
  Vector3 Now() {
    const mjData* d = scene_.d();
    return Load(d->xpos + 3 * GetParam()) + Rotate(d->xmat + 9 * GetParam(), kLocal);
  }

  // MuJoCo's own nᵀ J of the point at τ on the path, and where it is then.
  Numbers RowOfMuJoCo(mjtNum tau, Vector3* moved) {
    Scene there(kTrees);
    const int nv = there.Dofs();
    Numbers u(nv), jacobian(3 * nv), row(dofs_);
    for (int i = 0; i < nv; ++i) {
      u[i] = tau * motion_.velocity[i] + tau * tau / 2 * motion_.acceleration[i] +
             tau * tau * tau / 6 * motion_.jerk[i];
    }
    mju_copy(there.d()->qpos, qpos_.data(), there.m()->nq);
    there.Displace(u.data(), 1);
    mj_forward(there.m(), there.d());
    const mjData* d = there.d();
    *moved = Load(d->xpos + 3 * point_.body) + Rotate(d->xmat + 9 * point_.body, kLocal);
    mj_jac(there.m(), d, jacobian.data(), nullptr, &moved->x, point_.body);
    for (int i = 0; i < dofs_; ++i) {
      const int dof = begin_ + i;
      row[i] = kNormal.x * jacobian[dof] + kNormal.y * jacobian[nv + dof] +
               kNormal.z * jacobian[2 * nv + dof];
    }
    return row;
  }

  Scene scene_;
  Scratch scratch_;
  Motion motion_;
  BodyPoint point_;
  Numbers qpos_;
  int tree_, begin_, dofs_;
};

INSTANTIATE_TEST_SUITE_P(Bodies, MovingPoint, testing::Range(1, 9));

TEST_P(MovingPoint, ItsRowIsThatOfMuJoCo) {
  Numbers row(dofs_);
  Vector3 here;
  AddRow(scene_.m(), scene_.d(), point_, kNormal, -2, row.data());
  const Numbers expected = RowOfMuJoCo(0, &here);
  for (int i = 0; i < dofs_; ++i) EXPECT_NEAR(row[i], -2 * expected[i], 1e-14) << "dof " << i;
}

TEST_P(MovingPoint, ItsVelocityIsThatOfMuJoCo) {
  mjtNum velocity[6];
  const mjData* d = scene_.d();
  mj_objectVelocity(scene_.m(), d, mjOBJ_XBODY, point_.body, velocity, 0);
  const Vector3 expected =
      Load(velocity + 3) + Cross(Load(velocity), point_.position - Load(d->xpos + 3 * point_.body));
  EXPECT_LT(Norm(PointVelocity(scene_.m(), d, point_) - expected), 1e-14);
}

// What is left out is of third order: the error of the displacement falls by 8 with half the time.
TEST_P(MovingPoint, ItsDisplacementIsGoodToSecondOrder) {
  const PointDerivatives path = PointMotion(scene_.m(), scene_.d(), point_, motion_, true);
  const auto error = [&](mjtNum tau) {
    Vector3 moved;
    RowOfMuJoCo(tau, &moved);
    return Norm(point_.position + Displacement(path, tau) - moved);
  };
  const mjtNum tau = 1e-3;
  EXPECT_LT(error(tau), 1e-7);
  EXPECT_LT(error(tau / 2), 0.15 * error(tau) + 1e-15);
}

// J + τ J̇: what is left out is of second order.
TEST_P(MovingPoint, ItsRowAtALaterTimeIsGoodToFirstOrder) {
  const auto error = [&](mjtNum tau) {
    Vector3 moved;
    const Numbers expected = RowOfMuJoCo(tau, &moved);
    Numbers row(dofs_);
    AddRowAt(scene_.m(), scene_.d(), point_, motion_, tau, moved, kNormal, 1, row.data());
    mjtNum most = 0;
    for (int i = 0; i < dofs_; ++i) most = std::max(most, std::abs(row[i] - expected[i]));
    return most;
  };
  const mjtNum tau = 1e-3;
  EXPECT_LT(error(tau), 1e-5);
  EXPECT_LT(error(tau / 2), 0.3 * error(tau) + 1e-14);
}

// A ball whose centre of mass is elsewhere, for what it carries.
TEST(FreeBody, IsNotTurnedByAForceThroughItsOrigin) {
  Scene scene(kTrees);
  scene.Disturb();
  Scratch scratch(scene.d());
  const Mobility mobility(scene.m(), scene.d(), scratch);
  const Motion motion = PredictMotion(scene.m(), scene.d(), mobility, scratch);
  const BodyPoint origin{1, Load(scene.d()->xpos + 3)};
  const mjtNum tau = 0.01;
  const PointDerivatives path = PointMotion(scene.m(), scene.d(), origin, motion, true);
  const Vector3 moved = origin.position + Displacement(path, tau);
  Numbers row(scene.m()->tree_dofnum[0]);
  AddRowAt(scene.m(), scene.d(), origin, motion, tau, moved, kNormal, 1, row.data());
  EXPECT_NEAR(row[0], kNormal.x, 1e-15);
  for (int i = 3; i < 6; ++i) EXPECT_NEAR(row[i], 0, 1e-15);
}

}  // namespace
}  // namespace mujoco_impact::engine
