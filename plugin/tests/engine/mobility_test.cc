// SPDX-License-Identifier: Apache-2.0

#include "engine/path/mobility.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "engine/path/motion.h"
#include "tests/engine/scene.h"

namespace mujoco_impact::engine {
namespace {

// Ties of every kind, each soft in its own way, and violated once the scene is disturbed.
constexpr char kTied[] = R"(
<mujoco>
  <option timestep="0.002" integrator="INTEGRATOR" jacobian="JACOBIAN">
    <flag contact="disable" diagexact="EXACT"/>
  </option>
  <default><geom size=".05" mass=".3"/></default>
  <worldbody>
    <body name="a" pos="0 0 1"><freejoint/><geom pos=".1 0 0"/></body>
    <body name="b" pos="1 0 1">
      <joint type="ball"/><geom pos="0 .1 .1"/>
      <body pos=".3 0 0"><joint name="b" axis="0 1 0"/><geom pos=".1 0 0"/></body>
    </body>
    <body name="c" pos="2 0 1"><joint name="c" type="slide" axis="0 0 1"/><geom/></body>
    <body name="d" pos="3 0 1"><joint name="d" type="slide" axis="1 0 0"/><geom/>
      <site name="d" pos="0 .1 0"/></body>
    <body name="e" pos="4 0 1"><freejoint/><geom/><site name="e" pos=".2 0 .1"/></body>
    <body pos="5 0 1"><freejoint/><geom/></body>
  </worldbody>
  <equality>
    <connect body1="a" body2="b" anchor="0 0 0" solref=".03 .7" solimp=".6 .97 .9"/>
    <joint joint1="b" joint2="c" polycoef="0 1 .5 0 0" solimp=".8 .97 .5 .3 3"/>
    <joint joint1="d" solref="-150 -12" solimp=".9 .99 .8 .5 2"/>
    <weld body1="c" body2="e" solref=".0001 1" solimp=".5 .8 1.2" torquescale=".3"/>
    <connect site1="d" site2="e" solimp=".7 .8 2.5"/>
    <tendon tendon1="bd" solimp=".5 .9 2"/>
  </equality>
  <tendon>
    <fixed name="bd"><joint joint="b" coef=".4"/><joint joint="d" coef="-1"/></fixed>
  </tendon>
</mujoco>)";

struct Solver {
  std::string integrator, jacobian, exact = "disable";
};

void PrintTo(const Solver& solver, std::ostream* out) {
  *out << solver.integrator << ", " << solver.jacobian << ", diagexact " << solver.exact;
}

class Ties : public testing::TestWithParam<Solver> {
 protected:
  Ties() : scene_(Xml()) { scene_.Disturb(); }

  static std::string Xml() {
    std::string xml = kTied;
    xml.replace(xml.find("INTEGRATOR"), 10, GetParam().integrator);
    xml.replace(xml.find("JACOBIAN"), 8, GetParam().jacobian);
    xml.replace(xml.find("EXACT"), 5, GetParam().exact);
    return xml;
  }

  // M̃⁻¹ f + what ties pull with, by MuJoCo: the acceleration under the force f.
  Numbers Acceleration(const Numbers& force) {
    mjData* d = scene_.d();
    mju_copy(d->qfrc_applied, force.data(), scene_.Dofs());
    mj_forward(scene_.m(), d);
    return Numbers(d->qacc, d->qacc + scene_.Dofs());
  }

  // Takes away what MuJoCo computes only after the passive forces, in which the plugin runs.
  void Forget() {
    mjData* d = scene_.d();
    const mjtNum unknown = std::numeric_limits<mjtNum>::quiet_NaN();
    std::fill_n(d->efc_aref, d->nefc, unknown);
    if (scene_.m()->opt.integrator != mjINT_DISCRETE) return;
    std::fill_n(d->efc_R, d->nefc, unknown);
    std::fill_n(d->efc_KBIP, 4 * d->nefc, unknown);
  }

  Scene scene_;
};

INSTANTIATE_TEST_SUITE_P(Solvers, Ties,
                         testing::Values(Solver{"Euler", "dense"}, Solver{"Euler", "sparse"},
                                         Solver{"RK4", "dense"}, Solver{"implicitfast", "sparse"},
                                         Solver{"discrete", "dense"}, Solver{"discrete", "sparse"},
                                         Solver{"discrete", "sparse", "enable"}));

// What MuJoCo's solver leaves undone of a problem without inequalities.
constexpr mjtNum kSolver = 1e-9;

TEST_P(Ties, AnswerAForceAsMuJoCoDoes) {
  const int nv = scene_.Dofs();
  const Numbers force = Mixed(nv, 0.9);
  const Numbers without = Acceleration(Numbers(nv)), with = Acceleration(force);
  Forget();
  Scratch scratch(scene_.d());
  const Mobility mobility(scene_.m(), scene_.d(), scratch);
  ASSERT_EQ(mobility.ties(), 3 + 1 + 1 + 6 + 3 + 1);
  Numbers answer(nv);
  mobility.Solve(answer.data(), force.data());
  for (int i = 0; i < nv; ++i) {
    EXPECT_NEAR(answer[i], with[i] - without[i], kSolver * (1 + std::abs(with[i]))) << "dof " << i;
  }
}

TEST_P(Ties, PullTheFreeMotionAsMuJoCoDoes) {
  const int nv = scene_.Dofs();
  const Numbers expected = Acceleration(Mixed(nv, 0.4));
  Forget();
  Scratch scratch(scene_.d());
  const Mobility mobility(scene_.m(), scene_.d(), scratch);
  const Motion motion = PredictMotion(scene_.m(), scene_.d(), mobility, scratch);
  for (int i = 0; i < nv; ++i) {
    EXPECT_NEAR(motion.acceleration[i], expected[i], kSolver * (1 + std::abs(expected[i])))
        << "dof " << i;
  }
}

TEST_P(Ties, JoinTheTreesThatTheyTie) {
  Scratch scratch(scene_.d());
  const Mobility mobility(scene_.m(), scene_.d(), scratch);
  EXPECT_TRUE(mobility.AreTied(0, 1));
  EXPECT_TRUE(mobility.AreTied(0, 4));
  EXPECT_FALSE(mobility.AreTied(0, 5));
}

}  // namespace
}  // namespace mujoco_impact::engine
