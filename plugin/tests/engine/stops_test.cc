// SPDX-License-Identifier: Apache-2.0

#include "engine/path/stops.h"

#include <gtest/gtest.h>

#include "engine/common/scratch.h"
#include "engine/path/mobility.h"
#include "tests/engine/scene.h"

namespace mujoco_impact::engine {
namespace {

// Stops of every kind, all overrun a little.
constexpr char kOverrun[] = R"(
<mujoco>
  <compiler angle="radian"/>
  <option jacobian="JACOBIAN"/>
  <default><geom size=".05" mass=".3"/></default>
  <worldbody>
    <body pos="0 0 1">
      <joint type="ball" range="0 .5"/><geom pos="0 .1 .1"/>
      <body pos=".3 0 0">
        <joint axis="0 1 0" range="-1 .2"/><joint axis="1 0 0" range=".1 2" margin=".05"/>
        <geom pos=".1 .1 0"/>
      </body>
    </body>
    <body pos="1 0 1">
      <joint name="slide" type="slide" axis="0 0 1" range="-1 .2"/><geom/>
      <site name="a" pos=".1 0 0"/>
    </body>
    <body pos="2 0 1"><freejoint/><geom/><site name="b" pos=".1 0 .1"/></body>
  </worldbody>
  <tendon>
    <spatial range="0 .9"><site site="a"/><site site="b"/></spatial>
    <fixed range=".5 1"><joint joint="slide" coef="2"/></fixed>
  </tendon>
</mujoco>)";

class Overrun : public testing::TestWithParam<const char*> {
 protected:
  Overrun() : scene_(Xml()) {
    mjData* d = scene_.d();
    const mjtNum axis[3] = {0.6, 0, 0.8};
    mju_axisAngle2Quat(d->qpos, axis, 0.51);
    d->qpos[4] = 0.21;
    d->qpos[5] = 0.12;
    d->qpos[6] = 0.22;
    mj_forward(scene_.m(), d);
  }

  static std::string Xml() {
    std::string xml = kOverrun;
    return xml.replace(xml.find("JACOBIAN"), 8, GetParam());
  }

  // Row i of MuJoCo's Jacobian.
  Numbers RowOf(int i) {
    const mjData* d = scene_.d();
    Numbers row(scene_.Dofs()), unit(d->nefc);
    unit[i] = 1;
    mj_mulJacTVec(scene_.m(), d, row.data(), unit.data());
    return row;
  }

  Scene scene_;
};

// Each is pushed alone by an impulse against its row: it holds, and is MuJoCo's row.
TEST_P(Overrun, StopsAreTheRowsOfMuJoCosLimits) {
  mjData* d = scene_.d();
  ASSERT_EQ(d->nefc, 6);
  for (int i = 0; i < d->nefc; ++i) {
    Scratch scratch(d);
    Numbers none(scene_.Dofs()), change(scene_.Dofs());
    const Motion still{none.data(), none.data(), none.data()};
    const Numbers row = RowOf(i);
    SolveInertia(scene_.m(), d, change.data(), row.data());
    mju_scl(change.data(), change.data(), -1, scene_.Dofs());
    const Mobility ties(scene_.m(), d, scratch);
    Stops stops(scene_.m(), d, still, scratch);
    stops.Look(still, 0);
    EXPECT_TRUE(stops.FindHeld(ties, none.data(), change.data(), 1e-4, true)) << "row " << i;
    bool found = false;
    stops.ForHeld([&](const mjtNum* held) {
      mjtNum difference = 0;
      for (int j = 0; j < scene_.Dofs(); ++j) difference += std::abs(held[j] - row[j]);
      found |= difference < 1e-12;
    });
    EXPECT_TRUE(found) << "row " << i;
    // nothing goes through those that hold
    const auto rate = [&] { return mju_dot(row.data(), change.data(), scene_.Dofs()); };
    const mjtNum free = rate();
    Mobility(ties, stops, scratch).Tie(change.data());
    EXPECT_NEAR(rate(), 0, -1e-11 * free) << "row " << i;
  }
}

// The same impulses the other way.
TEST_P(Overrun, StopsThatArePulledDoNotHold) {
  mjData* d = scene_.d();
  for (int i = 0; i < d->nefc; ++i) {
    Scratch scratch(d);
    Numbers none(scene_.Dofs()), change(scene_.Dofs());
    const Motion still{none.data(), none.data(), none.data()};
    const Numbers row = RowOf(i);
    SolveInertia(scene_.m(), d, change.data(), row.data());
    const Mobility ties(scene_.m(), d, scratch);
    Stops stops(scene_.m(), d, still, scratch);
    stops.Look(still, 0);
    stops.FindHeld(ties, none.data(), change.data(), 1e-4, true);
    stops.ForHeld([&](const mjtNum* held) {
      for (int j = 0; j < scene_.Dofs(); ++j) {
        if (held[j] != row[j]) return;
      }
      ADD_FAILURE() << "row " << i;
    });
  }
}

INSTANTIATE_TEST_SUITE_P(Jacobians, Overrun, testing::Values("dense", "sparse"));

}  // namespace
}  // namespace mujoco_impact::engine
