// SPDX-License-Identifier: Apache-2.0
//
// Three balls through MuJoCo's C interface, for scripts/cross: ball 1 hits two that touch.
//
//   three_balls PLUGIN_LIBRARY

#include <mujoco/mujoco.h>

#include <cmath>
#include <cstdio>

namespace {

constexpr char kScene[] = R"(
<mujoco>
  <extension><plugin plugin="mujoco_impact.waveform"><instance name="impact"/></plugin></extension>
  <option gravity="0 0 0"/>
  <default>
    <geom size=".015" margin="-.0002" gap=".008"/>
    <joint type="slide" axis="1 0 0"/>
  </default>
  <worldbody>
    <body pos="-.05 0 0"><joint/><geom/></body>
    <body><joint/><geom/></body>
    <body pos=".03 0 0"><joint/><geom/></body>
  </worldbody>
  <keyframe><key qvel=".5 0 0"/></keyframe>
</mujoco>)";

// velocities after the impact over that before: Hertz contacts, integrated
constexpr double kExpected[] = {-0.070952, 0.076403, 0.994549};
// rounding of the numbers above, and the tolerance of the law
constexpr double kTolerance = 1e-5;

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  mj_loadPluginLibrary(argv[1]);
  char error[500] = "";
  mjSpec* spec = mj_parseXMLString(kScene, nullptr, error, sizeof error);
  mjModel* m = spec ? mj_compile(spec, nullptr) : nullptr;
  if (!m) {
    std::printf("%s\n", spec ? mjs_getError(spec) : error);
    return 1;
  }
  mjData* d = mj_makeData(m);
  mj_resetDataKeyframe(m, d, 0);
  while (d->time < 0.2) mj_step(m, d);
  bool right = true;
  std::printf("MuJoCo %s:", mj_versionString());
  for (int ball = 0; ball < 3; ++ball) {
    const double velocity = d->qvel[ball] / 0.5;
    right = right && std::abs(velocity - kExpected[ball]) < kTolerance;
    std::printf(" %.6f", velocity);
  }
  std::printf(right ? ", as it should be\n" : ", which is wrong\n");
  mj_deleteData(d);
  mj_deleteModel(m);
  mj_deleteSpec(spec);
  return right ? 0 : 1;
}
