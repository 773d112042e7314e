// SPDX-License-Identifier: Apache-2.0
// Kinematic trees with every kind of joint in every place that matters, for tests of derivatives.

#ifndef MUJOCO_IMPACT_TESTS_ENGINE_TREES_H_
#define MUJOCO_IMPACT_TESTS_ENGINE_TREES_H_

namespace mujoco_impact::engine {

// Runge-Kutta: the velocity of the path is qvel. `last` carries the point that tests look at.
constexpr char kTrees[] = R"(
<mujoco>
  <option timestep="0.002" integrator="RK4" gravity="0.3 -0.2 -9.81">
    <flag contact="disable"/>
  </option>
  <default><geom type="capsule" size=".05 .1"/></default>
  <worldbody>
    <body pos="0 0 1">
      <freejoint/>
      <geom pos=".1 .05 0"/>
      <body pos=".2 .1 0">
        <joint type="hinge" axis=".3 1 .2" pos="0 .1 0" stiffness="3"/>
        <joint type="slide" axis="1 .2 .5" stiffness="7"/>
        <geom pos="0 0 .2"/>
        <body name="last" pos="0 .2 .3" gravcomp=".4">
          <joint type="ball"/>
          <geom pos=".05 0 .1"/>
        </body>
      </body>
    </body>
    <body pos="2 0 1">
      <joint type="ball" pos="0 0 .3"/>
      <geom pos="0 .1 -.2"/>
      <body pos="0 0 -.5">
        <joint type="hinge" axis="0 1 0"/>
        <geom/>
        <body pos=".1 0 -.4"><joint type="slide" axis="0 1 1"/><geom/></body>
        <body pos="-.1 0 -.4"><joint type="hinge" axis="1 0 0"/><geom/></body>
      </body>
    </body>
    <body pos="4 0 1">
      <joint type="slide" axis="1 0 0"/>
      <joint type="hinge" axis="0 0 1"/>
      <geom pos=".1 0 0"/>
    </body>
  </worldbody>
</mujoco>)";

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_TESTS_ENGINE_TREES_H_
