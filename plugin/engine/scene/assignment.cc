// SPDX-License-Identifier: Apache-2.0

#include "engine/scene/assignment.h"

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "engine/scene/material.h"
#include "engine/scene/ownership.h"

namespace mujoco_impact::engine {

namespace {

const char* Name(const mjModel* m, int type, int id) {
  const char* name = mj_id2name(m, type, id);
  return name ? name : "";
}

// The tuple of an instance, with the materials that its numbers are of.
struct Assignment {
  Assignment(const mjModel* m, int instance, const Material& usual)
      : name(Name(m, mjOBJ_PLUGIN, instance)),
        elements(ElementsOf(m, instance)),
        owned(m, instance) {
    const char* text = MaterialsText(m, instance);
    materials.resize(CountEntries(text));
    ReadMaterials(text, usual, materials.data(), nullptr);
  }

  int count() const { return static_cast<int>(materials.size()); }

  bool Allows(mjtNum number) const {
    return number == std::round(number) && std::abs(number) <= count();
  }

  // Null if the number is of none.
  const Material* Of(mjtNum number) const {
    return number == 0 || !Allows(number) ? nullptr
                                          : &materials[static_cast<int>(std::abs(number)) - 1];
  }

  const char* name;
  TupleElements elements;
  Ownership owned;
  std::vector<Material> materials;
};

std::string Told(const Material* material) {
  return material ? "of '" + std::string(material->name) + "'" : "of no material";
}

// Checks each element by itself and with those before it.
void CheckElements(const mjModel* m, const Assignment& own, ConfigError& error) {
  const TupleElements& elements = own.elements;
  std::vector<int> place(m->ngeom, -1);
  for (int i = 0; i < elements.size; ++i) {
    const int geom = elements.geom[i], before = place[geom];
    const mjtNum number = elements.number[i];
    const char* name = Name(m, mjOBJ_GEOM, geom);
    place[geom] = i;
    if (!own.Allows(number)) {
      std::snprintf(error.message, sizeof(error.message),
                    "the number (prm) of geom '%s' in the tuple '%s' is %g, and the instance has "
                    "%d materials; allowed: whole numbers up to that, negative: not owned",
                    name, own.name, number, own.count());
    } else if (before >= 0) {
      std::snprintf(
          error.message, sizeof(error.message),
          "geom '%s' is named twice in the tuple '%s', once %s and once %s; allowed: once", name,
          own.name, Told(own.Of(elements.number[before])).c_str(), Told(own.Of(number)).c_str());
    } else if (number >= 0 && i > 0 && elements.number[i - 1] < 0) {
      std::snprintf(error.message, sizeof(error.message),
                    "geom '%s' in the tuple '%s' follows one that is not owned; allowed: geoms "
                    "that are not owned, with negative numbers (prm), come last",
                    name, own.name);
    } else {
      continue;
    }
    return;
  }
}

// Which of two instances has a contact of a geom that one of them owns depends on their order.
void CheckOther(const mjModel* m, const Assignment& own, const Assignment& other,
                ConfigError& error) {
  for (int i = 0; i < own.elements.size; ++i) {
    const int geom = own.elements.geom[i], index = other.owned.Index(geom);
    const mjtNum number = own.elements.number[i];
    const Material* ours = own.Of(number);
    if (!ours || index < 0) continue;
    const Material* its =
        index < other.elements.size ? other.Of(other.elements.number[index]) : nullptr;
    // what both own and only one says is said for both
    if (its ? *its == *ours : number > 0) continue;
    std::snprintf(error.message, sizeof(error.message),
                  "geom '%s' is %s in the tuple '%s' and %s in the instance '%s', which owns it; "
                  "allowed: the same in both",
                  Name(m, mjOBJ_GEOM, geom), Told(ours).c_str(), own.name, Told(its).c_str(),
                  other.name);
    return;
  }
}

}  // namespace

ConfigError CheckAssignment(const mjModel* m, int instance, const Config& config) {
  ConfigError error{};
  const Material usual = UsualMaterial(config);
  const Assignment own(m, instance, usual);
  if (own.elements.size == 0 && own.count() > 0) {
    std::snprintf(error.message, sizeof(error.message),
                  "the instance '%s' has materials, and no tuple of its name says which geoms are "
                  "of them",
                  own.name);
  }
  CheckElements(m, own, error);
  for (int other = 0; other < m->nplugin && !error.message[0]; ++other) {
    if (other == instance || m->plugin[other] != m->plugin[instance]) continue;
    CheckOther(m, own, Assignment(m, other, usual), error);
  }
  return error;
}

}  // namespace mujoco_impact::engine
