// SPDX-License-Identifier: Apache-2.0
// What impacts have done to an owned geom: what the sensor reports.

#ifndef MUJOCO_IMPACT_ENGINE_STATE_GEOM_RECORD_H_
#define MUJOCO_IMPACT_ENGINE_STATE_GEOM_RECORD_H_

namespace mujoco_impact::engine {

struct GeomReading {
  // the current or last impact
  double impulse;  // Σ P [N s]
  double peak;     // Σ of the largest forces of its points [N]
  double alpha;    // Σ α [-]
  // since reset
  double count;     // impacts
  double total[3];  // ∫ F dt, world frame [N s]
  double largest;   // largest peak [N]
};

struct GeomRecord {
  GeomReading last;  // committed
  double partner;    // the other geom of the last impact, from 1
  double began;      // its step, on the clock [s]
  GeomReading next;  // with the impacts of this step; committed by advance
  double partner_next;
  double began_next;
  double force[3];  // average of this step, world frame [N]
  double carried;   // 1: one of MuJoCo's contacts holds it at the start of the step (runge_kutta.h)
};

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_STATE_GEOM_RECORD_H_
