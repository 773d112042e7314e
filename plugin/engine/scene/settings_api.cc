// SPDX-License-Identifier: Apache-2.0
// The settings of an instance as a C function, for an engine that runs no plugins and computes the
// same impacts (src/mujoco_impact/warp/): attributes are parsed, and have their defaults, in
// config.cc alone.

#include <cstddef>

#include "engine/scene/config.h"
#include "engine/scene/ownership.h"

namespace mujoco_impact::engine {

// Laid out alike in src/mujoco_impact/warp/settings.py.
struct SettingsForOthers {
  double restitution, effective_modulus, touch, tolerance;
  // 1 or 0: law `hertz`; loss by bi-stiffness; each contact times itself; passive; no tangential
  // impulses by a setting; no materials
  int hertz, bistiffness, instant, passive, frictionless, plain;
};

// Writes the settings of an instance and returns 1. Where the structure of the caller is not of our
// size, it writes nothing and returns 0.
extern "C" __attribute__((visibility("default"))) int mujoco_impact_settings(
    const mjModel* m, int instance, SettingsForOthers* settings, size_t size) {
  if (size != sizeof *settings) return 0;
  const Config config = ReadConfig(m, instance, Ownership(m, instance).size(), nullptr);
  *settings = {config.restitution,
               config.effective_modulus,
               config.touch,
               config.tolerance,
               config.law == Law::kHertz,
               config.dissipation == law::Dissipation::kBistiffness,
               config.duration_rule == DurationRule::kHertz,
               config.passive,
               config.friction == Friction::kNone,
               config.materials[0] == '\0' && config.material_pairs[0] == '\0'};
  return 1;
}

}  // namespace mujoco_impact::engine
