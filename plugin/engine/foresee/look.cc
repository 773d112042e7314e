// SPDX-License-Identifier: Apache-2.0

#include "engine/foresee/look.h"

#include <cmath>

#include "engine/path/contact_path.h"
#include "engine/path/rest.h"
#include "engine/scene/ownership.h"

namespace mujoco_impact::engine {

Look LookAtContacts(const mjModel* m, mjData* d, const MocapRecord* mocap, mjtNum touch) {
  Look look{};
  const mjtNum at_rest = LargestRestSpeed(m, d);
  const auto closes = [&](const mjContact& contact, mjtNum c) {
    return MayClose(m, contact, c, at_rest, touch);
  };
  for (int i = 0; i < d->ncon; ++i) {
    const mjContact& contact = d->contact[i];
    if (!IsOffered(contact)) continue;
    const mjtNum c = ClosingSpeed(m, d, contact, mocap);
    look.moves = look.moves || (IsCarried(contact) && std::abs(c) > at_rest);
    look.closes = look.closes || closes(contact, c);
    if (look.closes || !IsDoubtful(m, d, i)) continue;
    look.closes = AnyFoundAgain(m, d, i, [&](const mjContact& point) {
      return closes(point, ClosingSpeed(m, d, point, mocap));
    });
  }
  return look;
}

}  // namespace mujoco_impact::engine
