// SPDX-License-Identifier: Apache-2.0

#include "engine/scene/ownership.h"

namespace mujoco_impact::engine {

namespace {

int TupleOf(const mjModel* m, int instance) {
  const char* name = mj_id2name(m, mjOBJ_PLUGIN, instance);
  return name ? mj_name2id(m, mjOBJ_TUPLE, name) : -1;
}

}  // namespace

TupleElements ElementsOf(const mjModel* m, int instance) {
  const int tuple = TupleOf(m, instance);
  if (tuple < 0) return {nullptr, nullptr, 0};
  const int begin = m->tuple_adr[tuple];
  return {m->tuple_objid + begin, m->tuple_objprm + begin, m->tuple_size[tuple]};
}

Ownership::Ownership(const mjModel* m, int instance)
    : m_(m), instance_(instance), geoms_(nullptr), size_(static_cast<int>(m->ngeom)) {
  if (TupleOf(m, instance) < 0) return;
  const TupleElements elements = ElementsOf(m, instance);
  geoms_ = elements.geom;
  size_ = elements.size;
  while (size_ > 0 && elements.number[size_ - 1] < 0) --size_;
}

int Ownership::Index(int geom) const {
  if (!geoms_) return geom;
  // geoms that were added in a row, as most are
  const int guess = size_ > 0 ? geom - geoms_[0] : -1;
  if (guess >= 0 && guess < size_ && geoms_[guess] == geom) return guess;
  for (int i = 0; i < size_; ++i) {
    if (geoms_[i] == geom) return i;
  }
  return -1;
}

bool Ownership::Owns(const mjContact& contact) const {
  if (!Touches(contact)) return false;
  for (int other = 0; other < instance_; ++other) {
    const bool ours = m_->plugin[other] == m_->plugin[instance_];
    if (ours && Ownership(m_, other).Touches(contact)) return false;
  }
  return true;
}

int OwnedCapacity(const mjModel* m, int instance) {
  return TupleOf(m, instance) >= 0 ? static_cast<int>(m->ntupledata) : static_cast<int>(m->ngeom);
}

const char* TupleFault(const mjModel* m, int instance) {
  const int tuple = TupleOf(m, instance);
  if (tuple < 0) return nullptr;
  for (int i = 0; i < m->tuple_size[tuple]; ++i) {
    if (m->tuple_objtype[m->tuple_adr[tuple] + i] != mjOBJ_GEOM) {
      return "the tuple of the instance may hold geoms only";
    }
  }
  return nullptr;
}

}  // namespace mujoco_impact::engine
