// SPDX-License-Identifier: Apache-2.0
// Fuzz target: the attributes of an instance.
//
// The input is one line of text per attribute, in the order of registration. Whatever it says,
// reading ends, and what is not refused is in its range.

#include <mujoco/mujoco.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "engine/plugin.h"
#include "engine/scene/config.h"

namespace engine = mujoco_impact::engine;

namespace {

constexpr int kOwned = 3;

constexpr char kScene[] = R"(<mujoco>
  <extension><plugin plugin="mujoco_impact.waveform"><instance name="impact"/></plugin></extension>
  <worldbody><body><freejoint/><geom size="1" margin="-.1" gap=".2"/></body></worldbody>
</mujoco>)";

mjModel* LoadScene() {
  engine::RegisterPlugin();
  mjVFS files;
  mj_defaultVFS(&files);
  mj_addBufferVFS(&files, "scene.xml", kScene, sizeof(kScene) - 1);
  char error[500] = "";
  mjModel* model = mj_loadXML("scene.xml", &files, error, sizeof(error));
  mj_deleteVFS(&files);
  if (!model) {
    std::fprintf(stderr, "%s\n", error);
    std::abort();
  }
  return model;
}

void Expect(bool promise, const char* what) {
  if (promise) return;
  std::fprintf(stderr, "broken promise: %s\n", what);
  std::abort();
}

void CheckMaterials(const engine::Config& config) {
  const engine::Material usual = engine::UsualMaterial(config);
  std::vector<engine::Material> materials(engine::CountEntries(config.materials));
  engine::ReadMaterials(config.materials, usual, materials.data(), nullptr);
  for (const engine::Material& material : materials) {
    Expect(!material.name.empty(), "a material has a name");
    Expect(material.compliance > 0, "C > 0");
    for (const double speed : {0.0, 1e-9, 1.0, 1e9}) {
      const double e = material.restitution.At(speed);
      Expect(e >= 0 && e <= 1, "e of a material in [0, 1]");
    }
  }
  std::vector<engine::MaterialPair> pairs(engine::CountEntries(config.material_pairs));
  engine::ReadPairs(config.material_pairs, usual, pairs.data(), nullptr);
  for (const engine::MaterialPair& pair : pairs) {
    Expect(!pair.name[0].empty() && !pair.name[1].empty(), "a pair has two names");
    Expect(pair.modulus >= 0 && std::isfinite(pair.modulus), "E* of a pair");
  }
}

void CheckConfig(const engine::Config& config) {
  Expect(config.restitution >= 0 && config.restitution <= 1, "e in [0, 1]");
  Expect(config.effective_modulus > 0, "E* > 0");
  Expect(config.touch >= 0 && std::isfinite(config.touch), "touch >= 0");
  Expect(config.duration_rule != engine::DurationRule::kFixed ||
             (config.duration > 0 && std::isfinite(config.duration)),
         "duration > 0");
  Expect(config.waveform_restitution >= 0 && config.waveform_restitution <= 1, "E in [0, 1]");
  Expect(config.calibrated.base_duration > 0, "W0 > 0");
  CheckMaterials(config);
  if (config.law != engine::Law::kCalibrated) return;
  Expect(config.calibrated.height_factor > 0, "S_h > 0");
  double alpha[kOwned];
  Expect(engine::ReadList(config.alpha, alpha, kOwned) == kOwned - 1, "an alpha per pair");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static mjModel* const model = LoadScene();
  // MuJoCo keeps the texts one after the other, each ended by a zero
  std::string text;
  int lines = 0;
  for (size_t i = 0; i < size && lines < engine::kAttributeCount; ++i) {
    const bool ends = data[i] == '\n' || data[i] == '\0';
    text.push_back(ends ? '\0' : static_cast<char>(data[i]));
    lines += ends;
  }
  text.append(engine::kAttributeCount - lines + 1, '\0');
  std::vector<char> attributes(text.begin(), text.end());
  char* const before = model->plugin_attr;
  const auto count = model->npluginattr;
  model->plugin_attr = attributes.data();
  model->npluginattr = static_cast<decltype(model->npluginattr)>(attributes.size());
  engine::ConfigError error;
  const engine::Config config = engine::ReadConfig(model, 0, kOwned, &error);
  if (error.message[0] == '\0') {
    CheckConfig(config);
  } else {
    Expect(std::strstr(error.message, "is refused") != nullptr, "a refusal says so");
    Expect(std::strlen(error.message) < sizeof(error.message), "a refusal fits its room");
  }
  model->plugin_attr = before;
  model->npluginattr = count;
  return 0;
}
