// SPDX-License-Identifier: Apache-2.0
// A pulse of one contact, as the state keeps it.

#ifndef MUJOCO_IMPACT_ENGINE_STATE_PULSE_H_
#define MUJOCO_IMPACT_ENGINE_STATE_PULSE_H_

#include <mujoco/mujoco.h>

#include "engine/common/vector3.h"

namespace mujoco_impact::engine {

// The line along which a pulse acts: where, from the origins of its two bodies, and the direction
// of the force on the second. World frame.
struct LineOfAction {
  double normal[3];
  double arm[2][3];  // [m]
};

// A pulse under way or, once delivered, the record of it until its slot is needed again.
struct Pulse {
  double serial;           // order of the pulse, from 1; 0: never used; negative: pending
  double geom[2];          // ids; the normal points from the first to the second
  double onset;            // on the clock [s]
  double impulse;          // P_k [N s]
  double alpha;            // P_k over the impulse of the waveform [-]
  double duration;         // W [s]
  double restitution;      // E of the waveform [-]
  double peak;             // largest force: that of the Hertz contact, or H of the waveform [N]
  double closing;          // speed at which its contact closed; 0 or less: others closed it [m/s]
  double place[3];         // where its surfaces met, world frame [m]
  double delivered_last;   // part of the impulse delivered by the start of the last step [-]
  double delivered;        // by the start of this one
  double delivered_next;   // and by its end; committed by advance
  double scale;            // of what is not delivered, over that part of P_k (settled_energy.h) [-]
  double scale_next;       // in this step; committed by advance
  double finishing;        // 1: all that is left comes in this step
  double loss;             // kinetic energy that its impact loses, by the part of its impulse [J]
  double point[2][3];      // where the force acts, in the frames of the two bodies [m]
  double tangent[3];       // tangential impulse over P_k, on geom[1], world frame [-]
  LineOfAction line;       // in the last step, or at the onset
  LineOfAction line_next;  // in this step; committed by advance

  // Until when its contact does not pull its bodies back: a waveform is not over just when they
  // have parted, and one that came at once has them on the path that it leaves.
  double parts_until() const { return onset + 2 * duration; }
  bool under_way() const { return serial > 0 && delivered < 1; }
  double end() const { return onset + duration; }  // on the clock [s]
  // What is yet to come in this step and after it [N s].
  double remaining() const { return scale_next * impulse * (1 - delivered); }
  // What is yet to come after this step [N s].
  double remaining_next() const { return scale_next * impulse * (1 - delivered_next); }
  bool slides() const { return tangent[0] != 0 || tangent[1] != 0 || tangent[2] != 0; }
};

// The body of geom[side] of the pulse.
inline int BodyOf(const mjModel* m, const Pulse& pulse, int side) {
  return m->geom_bodyid[static_cast<int>(pulse.geom[side])];
}

// Force of the pulse on its second body in this step, over its normal force.
inline Vector3 PulseDirection(const Pulse& pulse) {
  return Load(pulse.line_next.normal) + Load(pulse.tangent);
}

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_STATE_PULSE_H_
