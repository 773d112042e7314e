// SPDX-License-Identifier: Apache-2.0

#include "engine/scene/materials.h"

#include <algorithm>
#include <cmath>

#include "engine/scene/meeting.h"
#include "engine/scene/ownership.h"
#include "law/hertz_contact.h"

namespace mujoco_impact::engine {

namespace {

double Own(const mjContact& contact) {
  return contact.dim == 1 ? 0 : std::min(contact.friction[0], contact.friction[1]);
}

// The friction of a geom that is of a material.
double FrictionOf(const mjModel* m, int geom, const Material& material) {
  return material.friction == kOfGeom ? m->geom_friction[3 * geom] : material.friction;
}

}  // namespace

size_t MaterialBytes(const mjModel* m) {
  size_t bytes = 0, pairs = 0;
  for (int instance = 0; instance < m->nplugin; ++instance) {
    bytes += CountEntries(MaterialsText(m, instance)) * sizeof(Material);
    pairs = std::max<size_t>(pairs, CountEntries(PairsText(m, instance)));
  }
  return bytes == 0 ? 0 : bytes + pairs * sizeof(MaterialPair) + m->ngeom * sizeof(Material*);
}

Materials::Materials(const mjModel* m, int instance, const Config& config, Scratch& scratch)
    : m_(m), config_(config), elastic_(config.restitution == 1) {
  // the tuple of this instance has the last word, before it the first of the others
  for (int other = m->nplugin - 1; other >= 0; --other) {
    if (other == instance || m->plugin[other] != m->plugin[instance]) continue;
    ReadInstance(other, MaterialsText(m, other), false, scratch);
  }
  ReadInstance(instance, config.materials, true, scratch);
  if (!of_geom_) return;
  usual_ = UsualMaterial(config);
  pair_count_ = CountEntries(config.material_pairs);
  pairs_ = scratch.Take<MaterialPair>(pair_count_);
  ReadPairs(config.material_pairs, usual_, pairs_, nullptr);
  for (int i = 0; i < pair_count_; ++i) {
    elastic_ = elastic_ && pairs_[i].restitution.IsElastic();
  }
}

void Materials::ReadInstance(int instance, const char* text, bool own, Scratch& scratch) {
  const int count = CountEntries(text);
  if (count == 0) return;
  if (!of_geom_) {
    of_geom_ = scratch.Take<const Material*>(m_->ngeom);
    std::fill_n(of_geom_, m_->ngeom, nullptr);
  }
  Material* materials = scratch.Take<Material>(count);
  ReadMaterials(text, UsualMaterial(config_), materials, nullptr);
  for (int i = 0; i < count; ++i) elastic_ = elastic_ && materials[i].restitution.IsElastic();
  const TupleElements elements = ElementsOf(m_, instance);
  for (int i = 0; i < elements.size; ++i) {
    const mjtNum number = elements.number[i];
    if (number == 0 || std::abs(number) > count) continue;
    // what others do not own is theirs alone
    if (own || number > 0) {
      of_geom_[elements.geom[i]] = &materials[static_cast<int>(std::abs(number)) - 1];
    }
  }
}

const MaterialPair* Materials::PairOf(const mjContact& contact) const {
  const std::string_view one = Of(contact.geom[0]).name, other = Of(contact.geom[1]).name;
  const MaterialPair *begin = pairs_, *end = pairs_ + pair_count_;
  const MaterialPair* pair =
      std::find_if(begin, end, [&](const MaterialPair& it) { return it.IsOf(one, other); });
  return pair == end ? nullptr : pair;
}

double Materials::EffectiveModulus(const mjContact& contact) const {
  if (IsPlain(contact)) return config_.effective_modulus;
  const MaterialPair* pair = PairOf(contact);
  if (pair && pair->modulus > 0) return pair->modulus;
  return 1 / (Of(contact.geom[0]).compliance + Of(contact.geom[1]).compliance);
}

double Materials::Restitution(const mjContact& contact, double speed) const {
  if (IsPlain(contact)) return config_.restitution;
  const MaterialPair* pair = PairOf(contact);
  if (pair && pair->has_restitution) return pair->restitution.At(speed);
  const Material &one = Of(contact.geom[0]), &other = Of(contact.geom[1]);
  return law::CompositeRestitution(one.restitution.At(speed), one.compliance,
                                   other.restitution.At(speed), other.compliance);
}

double Materials::Friction(const mjContact& contact) const {
  if (config_.friction != engine::Friction::kCoulomb || config_.law != Law::kHertz) return 0;
  if (contact.dim == 1 || IsPlain(contact)) return Own(contact);
  const MaterialPair* pair = PairOf(contact);
  if (pair && pair->friction != kOfGeom) return pair->friction;
  const int geom[2] = {contact.geom[0], contact.geom[1]};
  const Material *one = &Of(geom[0]), *other = &Of(geom[1]);
  const bool said = one->friction != kOfGeom || other->friction != kOfGeom;
  if (!said || IsPair(m_, geom[0], geom[1])) return Own(contact);
  const int lead = m_->geom_priority[geom[0]] - m_->geom_priority[geom[1]];
  if (lead != 0) return FrictionOf(m_, geom[lead > 0 ? 0 : 1], lead > 0 ? *one : *other);
  return std::max(FrictionOf(m_, geom[0], *one), FrictionOf(m_, geom[1], *other));
}

}  // namespace mujoco_impact::engine
