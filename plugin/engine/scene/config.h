// SPDX-License-Identifier: Apache-2.0
// The attributes of one plugin instance: the only place where they are named, parsed and checked.
//
// plugin/README.md has the table for users. The model holds the attributes as text; they are read
// when the instance is created (to refuse bad ones) and whenever an impact is due. Nothing parsed
// is kept between steps, so the state of a simulation never disagrees with its model.

#ifndef MUJOCO_IMPACT_ENGINE_SCENE_CONFIG_H_
#define MUJOCO_IMPACT_ENGINE_SCENE_CONFIG_H_

#include <mujoco/mujoco.h>

#include "engine/scene/material.h"
#include "law/calibrated.h"
#include "law/friction.h"
#include "law/impact_problem.h"

namespace mujoco_impact::engine {

enum class Law { kHertz, kCalibrated };
enum class DurationRule { kHertz, kPaper, kFixed };
// Coulomb with the coefficients of MuJoCo's contacts; none; equations (7)-(9).
enum class Friction { kCoulomb, kNone, kPaper };

struct Config {
  Law law;
  double restitution;  // e of the law `hertz` [-]
  law::Dissipation dissipation;
  double young, poisson;     // [Pa], [-]
  double effective_modulus;  // E* of two bodies of that [Pa]
  DurationRule duration_rule;
  double duration;   // [s], for kFixed
  double touch;      // gaps below it count as touching [m]
  double tolerance;  // of the integration of an impact, relative [-]
  bool passive;
  law::CalibratedWaveform calibrated;
  double waveform_restitution;  // E of the shape [-]
  Friction friction;            // tangential impulses
  law::PaperFriction paper_friction;
  const char* alpha;                       // text of the list, for the law `calibrated`
  const char *materials, *material_pairs;  // texts (material.h)
};

// Whether the law times each contact itself, by the physical contact time: such an impact is over
// at once where the step is longer.
inline bool InstantRule(const Config& config) {
  return config.law == Law::kHertz && config.duration_rule == DurationRule::kHertz;
}

// Names of all attributes, for registration.
extern const char* const kAttributes[];
extern const int kAttributeCount;

// Why an attribute was refused; empty if all are good.
struct ConfigError {
  char message[512];
};

// The text of the attributes `materials` and `material_pairs` alone.
const char* MaterialsText(const mjModel* m, int instance);
const char* PairsText(const mjModel* m, int instance);

// Reads the attributes of `instance`; with `error` also checks each and tells the first that is
// bad. `owned` is the number of geoms the instance owns.
Config ReadConfig(const mjModel* m, int instance, int owned, ConfigError* error);

// What bodies are of whose geoms have no material: the settings of the instance.
Material UsualMaterial(const Config& config);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_SCENE_CONFIG_H_
