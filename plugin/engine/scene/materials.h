// SPDX-License-Identifier: Apache-2.0
// What a contact is made of: its stiffness, restitution and friction, by the materials of its two
// geoms.
//
// The elements of the tuple of an instance say of which material a geom is: ±i, the i-th of the
// attribute `materials`; 0, of none. A geom without one has the settings of the instance. What
// counts is the tuple of the instance that owns the contact, then that of the instance that owns
// the geom. Two materials combine by one rule, whatever their order:
//
//   stiffness     1/E* = C₁ + C₂            the compliances C = (1 − ν²)/E in series
//   restitution   e² = (C₁ e₁² + C₂ e₂²)/(C₁ + C₂)        (law/hertz_contact.h)
//   friction      MuJoCo's rule, with the friction of a material in place of that of its geom: of
//                 the geom of higher priority, else the larger
//
// unless an entry of `material_pairs` is of the two. Contacts of two geoms without material are as
// MuJoCo and the settings have them, and so is the friction of pairs that the model lists.

#ifndef MUJOCO_IMPACT_ENGINE_SCENE_MATERIALS_H_
#define MUJOCO_IMPACT_ENGINE_SCENE_MATERIALS_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/scene/config.h"
#include "engine/scene/material.h"

namespace mujoco_impact::engine {

// Bytes of scratch that they take, at most.
size_t MaterialBytes(const mjModel* m);

class Materials {
 public:
  Materials(const mjModel* m, int instance, const Config& config, Scratch& scratch);

  // E* [Pa].
  double EffectiveModulus(const mjContact& contact) const;

  // e of a contact in an impact that closes with `speed` [m/s].
  double Restitution(const mjContact& contact, double speed) const;

  // μ of Coulomb friction [-].
  double Friction(const mjContact& contact) const;

  // Whether no contact loses energy along its normal.
  bool IsElastic() const { return elastic_; }

 private:
  void ReadInstance(int instance, const char* text, bool own, Scratch& scratch);
  bool IsPlain(const mjContact& contact) const {
    return !of_geom_ || (!of_geom_[contact.geom[0]] && !of_geom_[contact.geom[1]]);
  }
  const Material& Of(int geom) const { return of_geom_[geom] ? *of_geom_[geom] : usual_; }
  const MaterialPair* PairOf(const mjContact& contact) const;

  const mjModel* m_;
  const Config& config_;
  Material usual_{};
  const Material** of_geom_ = nullptr;  // (ngeom) null: as the settings; null: all of them
  MaterialPair* pairs_ = nullptr;
  int pair_count_ = 0;
  bool elastic_;
};

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_SCENE_MATERIALS_H_
