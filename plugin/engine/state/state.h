// SPDX-License-Identifier: Apache-2.0
// The layout of an instance's plugin_state: everything that evolves, and nothing else.
//
//   header | per owned geom: its record | pulse slots | position correction (nv)
//          | held force (nv) | per kinematic tree: its flight | per mocap body: pose, velocity
//
// It describes itself (the header holds the sizes), so that Python finds the pulses in it.
// `compute` writes what it has pending: slots with a negative serial, `delivered_next` of the
// others, pending numbers of records, the correction, the held force, flights, velocities of mocap
// bodies, and the work and the stage of the header. `advance` commits that. A repeated `compute`
// overwrites it. Times are on the state's own clock, the seconds stepped since reset: a state
// restored without its mjData.time goes on all the same.

#ifndef MUJOCO_IMPACT_ENGINE_STATE_STATE_H_
#define MUJOCO_IMPACT_ENGINE_STATE_STATE_H_

#include <mujoco/mujoco.h>

#include <algorithm>

#include "engine/state/geom_record.h"
#include "engine/state/mocap.h"
#include "engine/state/pulse.h"

namespace mujoco_impact::engine {

static_assert(sizeof(mjtNum) == sizeof(double), "mujoco_impact needs a MuJoCo of double precision");

// What impacts do to a tree that flies, beside its entries of the correction and the held
// force (flights.h).
struct FlightRecord {
  // Whether it was struck: a free body, one that contacts of MuJoCo carry, or a tree of several
  // joints, whose entries are differences of its motion at the end of the step.
  static constexpr double kNotStruck = 0, kFree = 1, kCarried = 2, kArm = 3;

  double struck;
  double work;         // by which its spin is richer than unstruck [J]
  double velocity[3];  // of its centre at the end of the step, unstruck [m/s]
};

struct Header {
  double version;
  double count;        // pulses begun since reset
  double slot_offset;  // of the first slot, in numbers
  double slot_size;
  double slot_number;
  double clock;           // seconds stepped since reset
  double active;          // pulses not yet delivered
  double pending;         // 1: compute has something for advance to commit
  double touch;           // the attribute, for the scan that every step pays [m]
  double capacity;        // bound of the geoms owned, for which there is room
  double pending_pulses;  // of them, new pulses
  // Runge-Kutta: the forces of its first stage are held for the other three
  double stage_open;         // 1: a first stage has been computed since the last advance
  double stage_time;         // mjData.time of it
  double stage_fingerprint;  // of its position and velocity
  double later_stages;       // 1: a later stage was seen, so the step is a Runge-Kutta step
  double work;               // that the impacts of the step took, over what they may (budget.h)
  double pressed_until;      // on the clock: when the last pulse presses no more [s]
  double pushed_until;       // on the clock: end of the last step in which pulses acted [s]
};

class State {
 public:
  // Numbers that an instance owning up to `capacity` geoms needs in the model.
  static int Size(const mjModel* m, int capacity);

  // Sets every number of the state of `instance`.
  static void Reset(const mjModel* m, mjtNum* plugin_state, int instance);

  // Binds to the state in `d`; one that was not written by Reset is reset first, with a warning.
  State(const mjModel* m, mjData* d, int instance);

  // Resets the state with a warning unless every pulse is one between geoms of the model: not so if
  // it was restored from another model of the same sizes, or damaged.
  void ResetUnlessSound(const mjModel* m, int instance);

  Header& header() { return *header_; }
  const Header& header() const { return *header_; }
  int capacity() const { return capacity_; }
  int slots() const { return slots_; }
  GeomRecord& record(int index) { return records_[index]; }
  Pulse& pulse(int slot) { return pulses_[slot]; }
  const Pulse& pulse(int slot) const { return pulses_[slot]; }
  mjtNum* correction() { return correction_; }
  mjtNum* held_force() { return held_force_; }
  FlightRecord& flight(int tree) { return flights_[tree]; }
  MocapRecord* mocap() { return mocap_; }  // null if the model has no mocap body

 private:
  int capacity_, slots_;
  Header* header_;
  GeomRecord* records_;
  Pulse* pulses_;
  mjtNum* correction_;  // Δq that advance adds to the position (nv)
  // generalized force of the first Runge-Kutta stage; of a body that flies, its change of velocity
  mjtNum* held_force_;     // (nv)
  FlightRecord* flights_;  // (ntree)
  MocapRecord* mocap_;
};

// Visits the pulses that are not yet delivered.
template <typename AnyState, typename Visit>
void ForPulsesUnderWay(AnyState& state, Visit visit) {
  for (int i = 0; i < state.slots(); ++i) {
    if (state.pulse(i).under_way()) visit(state.pulse(i));
  }
}

// Visits these and the pulses that begin in this step, those that come at once included.
template <typename AnyState, typename Visit>
void ForPulsesOfStep(AnyState& state, Visit visit) {
  for (int i = 0; i < state.slots(); ++i) {
    if (state.pulse(i).serial < 0 || state.pulse(i).under_way()) visit(state.pulse(i));
  }
}

// When the last of the pulses under way ends, from the start of the step; 0 if there are none [s].
inline mjtNum ActiveEnd(const State& state) {
  mjtNum end = 0;
  if (state.header().active == 0) return end;
  ForPulsesUnderWay(
      state, [&](const Pulse& pulse) { end = std::max(end, pulse.end() - state.header().clock); });
  return end;
}

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_STATE_STATE_H_
