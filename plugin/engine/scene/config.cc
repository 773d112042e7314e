// SPDX-License-Identifier: Apache-2.0

#include "engine/scene/config.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <vector>

#include "engine/scene/texts.h"
#include "law/hertz_contact.h"
#include "law/impact_law.h"
#include "law/viscous.h"

namespace mujoco_impact::engine {

namespace {

constexpr char kLaw[] = "law";
constexpr char kRestitution[] = "restitution";
constexpr char kDissipation[] = "dissipation";
constexpr char kYoung[] = "young";
constexpr char kPoisson[] = "poisson";
constexpr char kDuration[] = "duration";
constexpr char kTouch[] = "touch";
constexpr char kTolerance[] = "tolerance";
constexpr char kPassive[] = "passive";
constexpr char kAlpha[] = "alpha";
constexpr char kHeight[] = "sh";
constexpr char kWidth[] = "sw";
constexpr char kBaseWidth[] = "w0";
constexpr char kUnitFactor[] = "kappa";
constexpr char kShape[] = "e";
constexpr char kFriction[] = "friction";
constexpr char kStatic[] = "mu_s";
constexpr char kDynamic[] = "mu_d";
constexpr char kMaterials[] = "materials";
constexpr char kPairs[] = "material_pairs";

// Bodies that come closer sink into each other by as much before it is an impact.
constexpr NumberRule kTouchRule{kTouch, 1e-9, 0, 1e-3, true, true, "a number in [0, 1e-3] [m]"};
constexpr NumberRule kToleranceRule{
    kTolerance, law::kDefaultTolerance,     law::kSmallestTolerance, law::kLargestTolerance, true,
    true,       "a number in [1e-12, 1e-2]"};
// Factors of equation (6) and α, whose products of five are squared in a balance of energy.
constexpr double kLargestFactor = 1e25;
constexpr NumberRule kHeightRule{
    kHeight, 0, 0, kLargestFactor, false, true, "a number in (0, 1e25] [N s/(kg m)]"};
constexpr NumberRule kWidthRule{kWidth, 0, 0, kLargestFactor, true, true, "a number in [0, 1e25]"};
constexpr NumberRule kBaseWidthRule{
    kBaseWidth, 7.5e-3, 0, kLargestFactor, false, true, "a number in (0, 1e25] [s]"};
constexpr NumberRule kUnitFactorRule{
    kUnitFactor, 0.083, 0, kLargestFactor, true, true, "a number in [0, 1e25]"};
constexpr NumberRule kShapeRule{kShape, 1, 0, 1, true, true, "a number in [0, 1]"};
constexpr NumberRule kStaticRule{kStatic, 0, 0, kUnbounded, true, false, "a finite number >= 0"};
constexpr NumberRule kDynamicRule{kDynamic, 0, 0, kUnbounded, true, false, "a finite number >= 0"};
constexpr NumberRule kSecondsRule{
    kDuration, 0, 0, kUnbounded, false, false, "'hertz', 'paper' or a finite number > 0 [s]"};

constexpr char kAlphaAllowed[] =
    "one number in [0, 1e25] per neighbouring pair of owned geoms, separated by spaces";

constexpr char kMaterialsAllowed[] =
    "entries such as 'steel restitution=0.95 young=2e11', separated by semicolons";
constexpr char kPairsAllowed[] =
    "entries such as 'steel cork restitution=0.5', of names of the attribute 'materials', "
    "separated by semicolons";

// Reads attributes one by one and remembers the first that is bad.
class Reader {
 public:
  Reader(const mjModel* m, int instance, ConfigError* error)
      : m_(m), instance_(instance), error_(error) {
    if (error_) error_->message[0] = '\0';
  }

  const char* Text(const char* name) const {
    const char* text = mj_getPluginConfig(m_, instance_, name);
    return text ? text : "";
  }

  bool IsSet(const char* name) const { return Text(name)[0] != '\0'; }

  void Refuse(const char* name, const char* allowed, const char* note = "") {
    if (!error_ || error_->message[0]) return;
    // of a long value the beginning, so that there is room for what is allowed
    constexpr int kShown = 120;
    const std::string_view text = Text(name);
    const int shown = ShownLength(text, kShown);
    const bool cut = shown < static_cast<int>(text.size());
    std::snprintf(error_->message, sizeof(error_->message),
                  "attribute '%s' = '%.*s%s' is refused%s; allowed: %s", name, shown, text.data(),
                  cut ? "..." : "", note, allowed);
  }

  double Number(const NumberRule& rule) {
    if (!IsSet(rule.name)) return rule.fallback;
    double value = 0.0;
    if (ReadList(Text(rule.name), &value, 1) == 1 && rule.Allows(value)) return value;
    Refuse(rule.name, rule.allowed);
    return rule.fallback;
  }

  // Index of the word among `words`; the first is the default.
  template <int number>
  int Word(const char* name, const char* const (&words)[number], const char* allowed) {
    if (!IsSet(name)) return 0;
    for (int i = 0; i < number; ++i) {
      if (std::strcmp(Text(name), words[i]) == 0) return i;
    }
    Refuse(name, allowed);
    return 0;
  }

 private:
  const mjModel* m_;
  int instance_;
  ConfigError* error_;
};

void ReadDuration(Reader& reader, Config& config) {
  const char* text = reader.Text(kDuration);
  // equation (6) gives the calibrated law its own duration
  const DurationRule fallback =
      config.law == Law::kCalibrated ? DurationRule::kPaper : DurationRule::kHertz;
  config.duration = 0;
  if (text[0] == '\0') {
    config.duration_rule = fallback;
  } else if (std::strcmp(text, "hertz") == 0) {
    config.duration_rule = DurationRule::kHertz;
  } else if (std::strcmp(text, "paper") == 0) {
    config.duration_rule = DurationRule::kPaper;
  } else {
    config.duration_rule = DurationRule::kFixed;
    config.duration = reader.Number(kSecondsRule);
  }
}

// The factors are looked up only if they count, or are to be checked: most scenes have no friction.
void ReadFriction(Reader& reader, Config& config, bool check) {
  config.friction = static_cast<Friction>(
      reader.Word(kFriction, {"coulomb", "none", "paper"}, "'coulomb', 'none' or 'paper'"));
  config.paper_friction = {0, 0};
  if (config.friction != Friction::kPaper && !check) return;
  config.paper_friction = {reader.Number(kStaticRule), reader.Number(kDynamicRule)};
}

void CheckAlpha(Reader& reader, const Config& config, int owned) {
  const int count = ReadList(config.alpha, nullptr, 0);
  char note[96] = "";
  if (count >= 0 && count != owned - 1) {
    std::snprintf(note, sizeof(note), " (%d given, %d needed for %d owned geoms)", count, owned - 1,
                  owned);
  }
  if (count != owned - 1) {
    reader.Refuse(kAlpha, kAlphaAllowed, note);
    return;
  }
  std::vector<double> alpha(count);
  ReadList(config.alpha, alpha.data(), count);
  const bool good = std::all_of(alpha.begin(), alpha.end(),
                                [](double a) { return a >= 0 && a <= kLargestFactor; });
  if (!good) reader.Refuse(kAlpha, kAlphaAllowed);
}

void CheckFriction(Reader& reader, const Config& config) {
  for (const NumberRule* rule : {&kStaticRule, &kDynamicRule}) {
    const bool paper = config.friction == Friction::kPaper;
    if (paper && !reader.IsSet(rule->name)) {
      reader.Refuse(rule->name, rule->allowed, " (friction 'paper' needs it)");
    } else if (!paper && reader.IsSet(rule->name)) {
      reader.Refuse(rule->name, "only with friction = 'paper'");
    }
  }
}

bool IsNamed(const std::vector<Material>& materials, std::string_view name) {
  return std::any_of(materials.begin(), materials.end(),
                     [name](const Material& material) { return material.name == name; });
}

void CheckMaterials(Reader& reader, const Config& config) {
  const Material usual = UsualMaterial(config);
  TextFault fault;
  std::vector<Material> materials(CountEntries(config.materials));
  ReadMaterials(config.materials, usual, materials.data(), &fault);
  if (fault.note[0]) reader.Refuse(kMaterials, kMaterialsAllowed, fault.note);
  std::vector<MaterialPair> pairs(CountEntries(config.material_pairs));
  ReadPairs(config.material_pairs, usual, pairs.data(), &fault);
  if (fault.note[0]) reader.Refuse(kPairs, kPairsAllowed, fault.note);
  for (const MaterialPair& pair : pairs) {
    for (const std::string_view name : pair.name) {
      if (IsNamed(materials, name)) continue;
      std::snprintf(fault.note, sizeof(fault.note), " ('%.*s' is none of the attribute '%s')",
                    static_cast<int>(std::min<size_t>(name.size(), 60)), name.data(), kMaterials);
      reader.Refuse(kPairs, kPairsAllowed, fault.note);
    }
  }
}

void CheckCombination(Reader& reader, const Config& config, int owned) {
  CheckFriction(reader, config);
  if (config.law == Law::kCalibrated) {
    CheckAlpha(reader, config, owned);
    if (!reader.IsSet(kHeight)) {
      reader.Refuse(kHeight, kHeightRule.allowed, " (law 'calibrated' needs it)");
    }
    if (reader.IsSet(kFriction) && config.friction == Friction::kCoulomb) {
      reader.Refuse(kFriction, "'none' or 'paper'", " with law = 'calibrated'");
    }
    for (const char* name : {kMaterials, kPairs}) {
      if (reader.IsSet(name)) reader.Refuse(name, "only with law = 'hertz'");
    }
    return;
  }
  CheckMaterials(reader, config);
  for (const char* name : {kAlpha, kHeight, kShape}) {
    if (reader.IsSet(name)) reader.Refuse(name, "only with law = 'calibrated'");
  }
  if (config.dissipation == law::Dissipation::kViscous &&
      config.restitution < law::kViscousMinimum) {
    reader.Refuse(kRestitution, "a number in [0.05, 1] with dissipation = 'viscous'");
  }
}

}  // namespace

const char* const kAttributes[] = {kLaw,      kRestitution, kDissipation, kYoung,     kPoisson,
                                   kDuration, kTouch,       kPassive,     kAlpha,     kHeight,
                                   kWidth,    kBaseWidth,   kUnitFactor,  kShape,     kFriction,
                                   kStatic,   kDynamic,     kTolerance,   kMaterials, kPairs};
const int kAttributeCount = sizeof(kAttributes) / sizeof(kAttributes[0]);

const char* MaterialsText(const mjModel* m, int instance) {
  return Reader(m, instance, nullptr).Text(kMaterials);
}

const char* PairsText(const mjModel* m, int instance) {
  return Reader(m, instance, nullptr).Text(kPairs);
}

Material UsualMaterial(const Config& config) {
  const double least = config.dissipation == law::Dissipation::kViscous ? law::kViscousMinimum : 0;
  return {"",      ConstantRestitution(config.restitution, least), config.young, config.poisson,
          kOfGeom, law::Compliance(config.young, config.poisson)};
}

Config ReadConfig(const mjModel* m, int instance, int owned, ConfigError* error) {
  Reader reader(m, instance, error);
  Config config;
  config.law =
      static_cast<Law>(reader.Word(kLaw, {"hertz", "calibrated"}, "'hertz' or 'calibrated'"));
  config.dissipation = static_cast<law::Dissipation>(
      reader.Word(kDissipation, {"bistiffness", "viscous"}, "'bistiffness' or 'viscous'"));
  config.passive = reader.Word(kPassive, {"true", "false"}, "'true' or 'false'") == 0;
  config.restitution = reader.Number(kRestitutionRule);
  config.young = reader.Number(kYoungRule);
  config.poisson = reader.Number(kPoissonRule);
  config.effective_modulus = law::EffectiveModulus(config.young, config.poisson);
  config.touch = reader.Number(kTouchRule);
  config.tolerance = reader.Number(kToleranceRule);
  config.calibrated.height_factor = reader.Number(kHeightRule);
  config.calibrated.duration_factor = reader.Number(kWidthRule);
  config.calibrated.base_duration = reader.Number(kBaseWidthRule);
  config.calibrated.unit_factor = reader.Number(kUnitFactorRule);
  const double shape = reader.Number(kShapeRule);
  config.waveform_restitution = config.law == Law::kCalibrated ? shape : config.restitution;
  ReadFriction(reader, config, error != nullptr);
  config.alpha = reader.Text(kAlpha);
  config.materials = reader.Text(kMaterials);
  config.material_pairs = reader.Text(kPairs);
  ReadDuration(reader, config);
  if (error) CheckCombination(reader, config, owned);
  return config;
}

}  // namespace mujoco_impact::engine
