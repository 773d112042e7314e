// SPDX-License-Identifier: Apache-2.0
// Instances whose geoms can meet.
//
// A contact between geoms of two instances has one law and one set of settings. Which of the two
// instances it takes them from would depend on their order, so both must have the same. Materials
// of geoms may differ (materials.h).

#ifndef MUJOCO_IMPACT_ENGINE_SCENE_MEETING_H_
#define MUJOCO_IMPACT_ENGINE_SCENE_MEETING_H_

#include <mujoco/mujoco.h>

namespace mujoco_impact::engine {

// Two geoms of different instances.
struct Meeting {
  int other;    // instance with other settings; −1: there is none
  int geom[2];  // of this instance and of the other, which can meet
};

// Whether the model lists the two geoms as a pair.
bool IsPair(const mjModel* m, int first, int second);

// The first instance with other settings than `instance` whose geoms can meet the geoms of it.
Meeting FindConflict(const mjModel* m, int instance);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_SCENE_MEETING_H_
