// SPDX-License-Identifier: Apache-2.0
// Finds the contacts that close within the step.
//
// Asked only if one may close by the velocities MuJoCo has at hand (look.h): then by the path of
// the bodies, and when.

#ifndef MUJOCO_IMPACT_ENGINE_FORESEE_GATHER_H_
#define MUJOCO_IMPACT_ENGINE_FORESEE_GATHER_H_

#include <mujoco/mujoco.h>

#include "engine/common/scratch.h"
#include "engine/foresee/outlook.h"
#include "engine/path/contact_path.h"
#include "engine/scene/ownership.h"
#include "engine/state/state.h"

namespace mujoco_impact::engine {

// Whether any contact that is offered may close where pulses are under way, which add `kick` to the
// velocity in this step (nv): contacts deeper than their depth may close, too.
bool AnyMayCloseByPulses(const mjModel* m, mjData* d, const MocapRecord* mocap, mjtNum touch,
                         const mjtNum* kick);

// The owned contacts between bodies of which at least one moves, those deeper than their depth
// included while a pulse presses there. `kick` is null if no pulse is under way.
struct Gathered {
  int count, room;            // room: for points that are found later
  const mjContact** contact;  // where MuJoCo found them, or as they were found since
  mjContact* found;           // those, null if all follow from centres
  mjtNum farthest;            // the largest distance of one of them when the first may close [m]
  int asked;                  // pairs of which the narrow phase was asked so far
  const MocapRecord* mocap;   // null if there is no such body
  const mjtNum* kick;         // what pulses add to the velocity in this step (nv), or null
  ContactAnchor* anchor;      // the same, wherever the bodies are; valid where `anchored`
  bool* anchored;
  mjtNum* lowest;  // gap that it has at least by the end of the step, if nothing strikes [m]
  bool* relevant;  // whether it may still close: it was struck, or waits for its turn
  bool* due;       // whether it closes in the rest of the step
  bool* near;      // whether it may take part in the impact of a neighbour
  mjtNum* tau;     // when, from the time of the outlook, if due [s]
};

// Points found later of each pair whose contact does not follow from centres; a pair that touches
// in more has them of the start of the step besides.
constexpr int kMorePoints = 8;

// Bytes that a contact takes here, with what aligns it.
constexpr size_t kGatheredBytes = 2 * sizeof(void*) + sizeof(mjContact) + sizeof(ContactAnchor) +
                                  2 * sizeof(mjtNum) + 7 * sizeof(bool);

Gathered GatherContacts(const mjModel* m, mjData* d, const Ownership& ownership, State& state,
                        const mjtNum* kick, Scratch& scratch);

// Whether the path of the contact is that of two points of bodies whose inertia stays as it is;
// otherwise its impact is found where the bodies are when it comes.
bool IsOnPath(const mjModel* m, const mjContact& contact);

// Asks MuJoCo's narrow phase where the contacts among `position` that are not on a path touch now.
// Points that are gone are relevant no more; new ones are appended. Returns the number of pairs
// asked.
int FindPointsAgain(const mjModel* m, mjData* d, const int* position, int count,
                    Gathered& gathered);

// The anchor of contact k, made while the bodies are still where MuJoCo found the contacts.
const ContactAnchor& Anchor(const mjModel* m, const mjData* d, Gathered& gathered, int k);

// Marks the contacts whose gap is at most `reach` at some time of the rest of the step: the others
// cannot close before the impact at hand is over, so they and what lies behind them are not part of
// it.
void FindNear(const mjModel* m, const mjData* d, const Outlook& outlook, mjtNum reach,
              Gathered& gathered);

// Finds out which relevant contacts close in the rest of the step; true if any does. `busy` [s]
// says until when each kinematic tree is taken by an impact that is already resolved, from the
// start of the step (ntree).
bool FindDue(const mjModel* m, mjData* d, const Outlook& outlook, mjtNum touch, const mjtNum* busy,
             Gathered& gathered);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_FORESEE_GATHER_H_
