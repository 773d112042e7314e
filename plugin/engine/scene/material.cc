// SPDX-License-Identifier: Apache-2.0

#include "engine/scene/material.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "law/hertz_contact.h"

namespace mujoco_impact::engine {

namespace {

constexpr NumberRule kLossRule{
    "restitution_loss", 0, 0, kUnbounded, true, false, "a finite number >= 0 [(s/m)^(1/5)]"};
constexpr NumberRule kFrictionRule{
    "friction", kOfGeom, 0, kUnbounded, true, false, "a finite number >= 0"};
constexpr NumberRule kModulusRule{
    "modulus", 0, 0, kUnbounded, false, false, "a finite number > 0 [Pa]"};
constexpr char kTable[] = "restitution_table";
constexpr char kTableAllowed[] =
    "1 to 16 speed:restitution with commas between, speeds >= 0 [m/s] that grow";

// An entry as it is read: remembers what is wrong with it.
class EntryReader {
 public:
  EntryReader(std::string_view entry, TextFault* fault) : text_(entry), fault_(fault) { Advance(); }

  std::string_view TakeName() {
    const std::string_view name = key_;
    if (name.empty() || has_value_) Refuse("", "a name first", key_);
    name_ = name;
    Advance();
    return name;
  }

  bool AtEnd() const { return key_.empty() && !has_value_; }

  // Takes the word if it has this key.
  bool Take(const NumberRule& rule, double* number) {
    if (!has_value_ || key_ != rule.name) return false;
    double read = 0;
    if (ReadList(value_, &read, 1) == 1 && rule.Allows(read)) {
      *number = read;
    } else {
      Refuse(key_, rule.allowed, value_);
    }
    Advance();
    return true;
  }

  bool TakeRestitution(RestitutionRule* rule) {
    const NumberRule bounds{
        "restitution",
        1,
        rule->least,
        1,
        true,
        true,
        rule->least > 0 ? "a number in [0.05, 1] (dissipation 'viscous')" : "a number in [0, 1]"};
    double number = 1;
    if (Take(bounds, &number)) {
      *rule = ConstantRestitution(number, rule->least);
    } else if (Take(kLossRule, &number)) {
      *rule = {0, number, rule->least, {}, {}};
    } else if (has_value_ && key_ == kTable) {
      if (!ReadTable(bounds, rule)) Refuse(key_, kTableAllowed, value_);
      Advance();
    } else {
      return false;
    }
    if (has_restitution_)
      Refuse("", "only one of restitution, restitution_loss and restitution_table", "");
    has_restitution_ = true;
    return true;
  }

  void RefuseWord(const char* keys) {
    Refuse("", keys, key_);
    Advance();
  }

  // Remembers the first fault of all.
  void Refuse(std::string_view key, const char* allowed, std::string_view value) {
    if (!fault_ || fault_->note[0]) return;
    const auto shown = [](std::string_view text) { return ShownLength(text, 24); };
    if (key.empty() && value.empty()) {
      std::snprintf(fault_->note, sizeof(fault_->note), " ('%.*s' must have %s)", shown(name_),
                    name_.data(), allowed);
      return;
    }
    std::snprintf(fault_->note, sizeof(fault_->note), " ('%.*s': %.*s%s'%.*s', must be %s)",
                  shown(name_), name_.data(), shown(key), key.data(), key.empty() ? "" : " = ",
                  shown(value), value.data(), allowed);
  }

 private:
  void Advance() {
    value_ = TakeWord(text_);
    has_value_ = value_.find('=') != value_.npos;
    key_ = TakePart(value_, '=');
  }

  bool ReadTable(const NumberRule& bounds, RestitutionRule* rule) const {
    RestitutionRule table{0, 0, rule->least, {}, {}};
    for (std::string_view rest = value_; !rest.empty(); ++table.points) {
      const int i = table.points;
      std::string_view point = TakePart(rest, ',');
      const std::string_view speed = TakePart(point, ':');
      if (i == RestitutionRule::kMost) return false;
      if (ReadList(speed, &table.speed[i], 1) != 1) return false;
      if (ReadList(point, &table.value[i], 1) != 1) return false;
      if (table.speed[i] < 0 || (i > 0 && table.speed[i] <= table.speed[i - 1])) return false;
      if (!bounds.Allows(table.value[i])) return false;
    }
    if (table.points == 0) return false;
    *rule = table;
    return true;
  }

  std::string_view text_, name_, key_, value_;
  bool has_value_ = false, has_restitution_ = false;
  TextFault* fault_;
};

bool IsBlank(std::string_view entry) { return TakeWord(entry).empty(); }

std::string_view TakeEntry(std::string_view& text) {
  std::string_view entry;
  while (!text.empty() && IsBlank(entry)) entry = TakePart(text, ';');
  return IsBlank(entry) ? std::string_view() : entry;
}

}  // namespace

double RestitutionRule::At(double u) const {
  // e = 1 − c u^(1/5)
  if (points == 0) return std::max(least, 1 - loss * std::pow(u, 0.2));
  const int above = static_cast<int>(std::upper_bound(speed, speed + points, u) - speed);
  if (above == 0) return value[0];
  if (above == points) return value[points - 1];
  const double part = (u - speed[above - 1]) / (speed[above] - speed[above - 1]);
  return value[above - 1] + part * (value[above] - value[above - 1]);
}

bool RestitutionRule::IsElastic() const {
  return loss == 0 && std::all_of(value, value + points, [](double e) { return e == 1; });
}

RestitutionRule ConstantRestitution(double e, double least) { return {1, 0, least, {0}, {e}}; }

int CountEntries(std::string_view text) {
  int count = 0;
  while (!TakeEntry(text).empty()) ++count;
  return count;
}

void ReadMaterials(std::string_view text, const Material& usual, Material* materials,
                   TextFault* fault) {
  if (fault) fault->note[0] = '\0';
  int count = 0;
  for (std::string_view entry = TakeEntry(text); !entry.empty(); entry = TakeEntry(text)) {
    EntryReader reader(entry, fault);
    Material& material = materials[count] = usual;
    material.name = reader.TakeName();
    while (!reader.AtEnd()) {
      if (reader.TakeRestitution(&material.restitution)) continue;
      if (reader.Take(kYoungRule, &material.young)) continue;
      if (reader.Take(kPoissonRule, &material.poisson)) continue;
      if (reader.Take(kFrictionRule, &material.friction)) continue;
      reader.RefuseWord(
          "restitution, restitution_loss, restitution_table, young, poisson or friction = ...");
    }
    material.compliance = law::Compliance(material.young, material.poisson);
    const auto same = [&](const Material& one) { return one.name == material.name; };
    if (fault && std::any_of(materials, materials + count, same))
      reader.Refuse("", "one entry", "");
    ++count;
  }
}

void ReadPairs(std::string_view text, const Material& usual, MaterialPair* pairs,
               TextFault* fault) {
  if (fault) fault->note[0] = '\0';
  int count = 0;
  for (std::string_view entry = TakeEntry(text); !entry.empty(); entry = TakeEntry(text)) {
    EntryReader reader(entry, fault);
    MaterialPair& pair = pairs[count] = {{}, false, usual.restitution, kOfGeom, 0};
    for (std::string_view& name : pair.name) name = reader.TakeName();
    while (!reader.AtEnd()) {
      if (reader.TakeRestitution(&pair.restitution)) {
        pair.has_restitution = true;
        continue;
      }
      if (reader.Take(kFrictionRule, &pair.friction)) continue;
      if (reader.Take(kModulusRule, &pair.modulus)) continue;
      reader.RefuseWord(
          "restitution, restitution_loss, restitution_table, friction or modulus = ...");
    }
    const auto same = [&](const MaterialPair& one) { return one.IsOf(pair.name[0], pair.name[1]); };
    if (fault && std::any_of(pairs, pairs + count, same))
      reader.Refuse("", "one entry of the pair", "");
    ++count;
  }
}

}  // namespace mujoco_impact::engine
