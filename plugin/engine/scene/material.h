// SPDX-License-Identifier: Apache-2.0
// Materials, and what is said of two of them in contact: the attributes `materials` and
// `material_pairs`.
//
//   materials        steel restitution=0.95 young=2e11; cork restitution_loss=0.3 friction=0.4
//   material_pairs   steel cork restitution=0.5
//
// Entries are separated by semicolons: a name, or the two of a pair, and words key=value. Parsed
// whenever an impact is due, like all attributes (config.h).

#ifndef MUJOCO_IMPACT_ENGINE_SCENE_MATERIAL_H_
#define MUJOCO_IMPACT_ENGINE_SCENE_MATERIAL_H_

#include <limits>
#include <string_view>

#include "engine/scene/texts.h"

namespace mujoco_impact::engine {

// Bounds of what both a material and the settings of an instance have.
constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr NumberRule kRestitutionRule{"restitution", 1, 0, 1, true, true, "a number in [0, 1]"};
constexpr NumberRule kYoungRule{
    "young", 2e11, 0, kUnbounded, false, false, "a finite number > 0 [Pa]"};
constexpr NumberRule kPoissonRule{"poisson", 0.3, -1, 0.5, false, true, "a number in (-1, 0.5]"};

// The restitution of an impact that closes with a speed u [m/s]: a table, linear between its
// points and constant beyond; or, without points, 1 − loss u^(1/5), the law of viscoelastic
// spheres (Kuwabara and Kono 1987) to first order.
struct RestitutionRule {
  static constexpr int kMost = 16;

  int points;
  double loss;  // [(s/m)^(1/5)]
  double least;
  double speed[kMost], value[kMost];

  double At(double u) const;
  bool IsElastic() const;
  bool operator==(const RestitutionRule&) const = default;
};

// The same restitution at every speed.
RestitutionRule ConstantRestitution(double e, double least);

constexpr double kOfGeom = -1;  // friction that is not said: MuJoCo's own counts

struct Material {
  std::string_view name;
  RestitutionRule restitution;
  double young;       // [Pa]
  double poisson;     // [-]
  double friction;    // μ in impacts [-], or kOfGeom
  double compliance;  // (1 − ν²)/E [1/Pa]

  bool operator==(const Material&) const = default;
};

// What counts between two materials instead of what follows from each of them.
struct MaterialPair {
  std::string_view name[2];
  bool has_restitution;
  RestitutionRule restitution;
  double friction;  // [-], or kOfGeom
  double modulus;   // E* [Pa]; 0: not said

  bool IsOf(std::string_view one, std::string_view other) const {
    return (name[0] == one && name[1] == other) || (name[0] == other && name[1] == one);
  }
};

// What is wrong with a text; empty if nothing is.
struct TextFault {
  char note[160];
};

int CountEntries(std::string_view text);

// Read all entries into `materials` and `pairs`, which have room for CountEntries. What a material
// does not say is that of `usual`. `fault` may be null.
void ReadMaterials(std::string_view text, const Material& usual, Material* materials,
                   TextFault* fault);
void ReadPairs(std::string_view text, const Material& usual, MaterialPair* pairs, TextFault* fault);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_SCENE_MATERIAL_H_
