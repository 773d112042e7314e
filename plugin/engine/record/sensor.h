// SPDX-License-Identifier: Apache-2.0
// The sensor of an instance: what the impacts do to each owned geom.
//
// Per owned geom, in the order of the tuple: force on it in the world frame, averaged over the step
// (3) [N]; impulse of its current or last impact [N s]; largest force of that [N]; α [-]; since
// reset: impacts, impulse in the world frame (3) [N s], largest force [N] (record.h). Room is left
// for all tuples of the model (ownership.h); what is beyond the owned geoms is zero. MuJoCo's own
// force, touch and contact sensors do not see these contacts.

#ifndef MUJOCO_IMPACT_ENGINE_RECORD_SENSOR_H_
#define MUJOCO_IMPACT_ENGINE_RECORD_SENSOR_H_

#include <mujoco/mujoco.h>

namespace mujoco_impact::engine {

constexpr int kNumbersPerGeom = 11;

// The stage at which MuJoCo asks for the sensor comes before the passive forces, so there it
// reports what has been committed; `compute` of the passive forces then adds the impacts of this
// step. The stages that come later cost a pass over all bodies for quantities that no one needs
// here.

// Writes the output of every sensor of the instance; `impacts` says whether those of this step have
// been computed.
void ComputeSensors(const mjModel* m, mjData* d, int instance, bool impacts);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_RECORD_SENSOR_H_
