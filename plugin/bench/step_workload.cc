// SPDX-License-Identifier: Apache-2.0
// Steps of a model, for counting instructions.
//
//   step_workload MODEL.mjb STATE STEPS FOLDER [PLUGIN_LIBRARY...]
//
// Steps the model from STATE, the numbers of mjSTATE_INTEGRATION as doubles, and prints how often.
// A binary model knows its plugins by their order: FOLDER has MuJoCo's own, which come first.
// Count only `MeasuredSteps`:
//
//   valgrind --tool=callgrind --toggle-collect='MeasuredSteps*' step_workload ...

#include <mujoco/mujoco.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <vector>

// What is counted: the steps, nothing around them.
extern "C" __attribute__((noinline)) void MeasuredSteps(const mjModel* m, mjData* d, int steps) {
  for (int i = 0; i < steps; ++i) mj_step(m, d);
}

int main(int argc, char** argv) {
  if (argc < 5) {
    std::fprintf(stderr, "usage: step_workload MODEL.mjb STATE STEPS FOLDER [LIBRARY...]\n");
    return 2;
  }
  mj_loadAllPluginLibraries(argv[4], nullptr);
  for (int i = 5; i < argc; ++i) mj_loadPluginLibrary(argv[i]);
  mjModel* m = mj_loadModel(argv[1], nullptr);
  if (!m) return 1;
  mjData* d = mj_makeData(m);
  const int size = mj_stateSize(m, mjSTATE_INTEGRATION);
  std::vector<mjtNum> state(size);
  std::ifstream file(argv[2], std::ios::binary);
  if (!file.read(reinterpret_cast<char*>(state.data()), size * sizeof(mjtNum))) {
    std::fprintf(stderr, "%s holds fewer than %d numbers\n", argv[2], size);
    return 1;
  }
  // once before, so that memory is there and functions are bound
  mj_setState(m, d, state.data(), mjSTATE_INTEGRATION);
  mj_step(m, d);
  mj_setState(m, d, state.data(), mjSTATE_INTEGRATION);
  const int steps = std::atoi(argv[3]);
  MeasuredSteps(m, d, steps);
  std::printf("steps %d\n", steps);
  mj_deleteData(d);
  mj_deleteModel(m);
}
