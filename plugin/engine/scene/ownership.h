// SPDX-License-Identifier: Apache-2.0
// Which contacts an instance owns.
//
// The impacts of a contact are ours if one of its geoms is in the tuple that bears the instance's
// name, and a negative margin keeps MuJoCo's solver from it while the bodies do not overlap. Deeper
// than that margin the solver carries it, and an impact there is still ours (rest.h). Without such
// a tuple every geom is owned. A contact between geoms of two instances belongs to the first of
// them alone.

#ifndef MUJOCO_IMPACT_ENGINE_SCENE_OWNERSHIP_H_
#define MUJOCO_IMPACT_ENGINE_SCENE_OWNERSHIP_H_

#include <mujoco/mujoco.h>

namespace mujoco_impact::engine {

// The elements of the tuple of an instance; none without a tuple.
struct TupleElements {
  const int* geom;
  const mjtNum* number;  // of the material (materials.h); negative: the geom is not owned
  int size;
};

TupleElements ElementsOf(const mjModel* m, int instance);

// The geoms of an instance, in the order of its tuple. Geoms at its end whose number is negative
// are not among them: the tuple only says of which material they are.
class Ownership {
 public:
  Ownership(const mjModel* m, int instance);

  int size() const { return size_; }

  // Position of the geom in the order of the tuple; -1 if it is not owned.
  int Index(int geom) const;

  // Geom at a position of that order.
  int Geom(int index) const { return geoms_ ? geoms_[index] : index; }

  bool Owns(const mjContact& contact) const;

 private:
  bool Touches(const mjContact& contact) const {
    return Index(contact.geom[0]) >= 0 || Index(contact.geom[1]) >= 0;
  }

  const mjModel* m_;
  int instance_;
  const int* geoms_;  // null: all
  int size_;
};

// Whether a negative margin hands the impacts of the contact to the plugin.
inline bool IsOffered(const mjContact& contact) {
  return contact.exclude <= 1 && contact.adhesion == 0 && contact.includemargin < 0 &&
         contact.geom[0] >= 0 && contact.geom[1] >= 0;
}

// Whether the bodies overlap so deep that MuJoCo's solver carries the contact.
inline bool IsCarried(const mjContact& contact) { return contact.dist <= contact.includemargin; }

// Whether the contact is one of ours that overlaps deeper than its depth, so that it has rows.
inline bool IsTakenOver(const Ownership& ownership, const mjContact& contact) {
  return IsOffered(contact) && contact.efc_address >= 0 && ownership.Owns(contact);
}

// Upper bound of the geoms an instance owns, the same while the model is compiled and afterwards.
// MuJoCo asks for the sizes of state and sensor before it has filled in the tuples, so the bound is
// the number of elements of all tuples (or of all geoms, if the instance has no tuple).
int OwnedCapacity(const mjModel* m, int instance);

// Why the tuple of the instance cannot be used, or null.
const char* TupleFault(const mjModel* m, int instance);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_SCENE_OWNERSHIP_H_
