// SPDX-License-Identifier: Apache-2.0
// The impact of one island of contacts, as a problem in contact space.
//
// Contact k has a closing speed c_k = −J_k v [m/s] (positive: approaching) and a virtual
// compression y_k [m] (negative: minus the gap that is still open). With the Delassus matrix W = J
// M⁻¹ Jᵀ [1/kg] and normal contact forces F_k ≥ 0 [N],
//
//   dc/dt = −W F          dy_k/dt = c_k  (the dissipation law may change the rate of expansion)
//
// and what the bodies feel is the impulse P_k = ∫ F_k dt [N s] and when it came, M_k = ∫ t F_k dt
// [N s²]. Time t starts when the first contact of the island closes. Coulomb friction adds
// tangential rows (coulomb.h); without it nothing has any.
//
// Nothing here knows about bodies or MuJoCo: the engine builds the problem, a law solves it.

#ifndef MUJOCO_IMPACT_LAW_IMPACT_PROBLEM_H_
#define MUJOCO_IMPACT_LAW_IMPACT_PROBLEM_H_

#include <limits>

#include "law/coulomb.h"
#include "law/delassus.h"

namespace mujoco_impact::law {

// How energy is lost in a contact.
enum class Dissipation {
  kBistiffness,  // expansion against the stiffness K/e²: energetic restitution, any speed
  kViscous,      // Hunt-Crossley: F = K y^1.5 (1 + x c/c_ref), x such that a pair restitutes e
};

struct ImpactProblem {
  DelassusMatrix delassus;
  const double* closing_speed;  // (size) c_k(0) [m/s]
  const double* gap;            // (size) [m] ≥ 0; 0 also for contacts that overlap
  const double* stiffness;      // (size) K_k [N/m^1.5]
  double restitution;           // e in [0, 1]
  Dissipation dissipation;
  // [s] a contact that would close later, all others open, or after a longer flight, is left alone,
  // but for what belongs to the same impact (impact_clock.h)
  double horizon, flight;
  double tolerance;  // error allowed per step, relative to the speed and compression of the impact
  // multiplications after which the impact is ended (short_end.h), and those that the end may
  // take: any known impact takes less
  double work = 1e8, work_of_end = 1e7;
  // [s] the longest flight that may belong to the same impact however long its contacts last
  double longest_flight = std::numeric_limits<double>::infinity();
  const CoulombFriction* friction = nullptr;  // null: none
};

// Arrays of `size`, owned by the caller.
struct ImpactSolution {
  double* impulse;         // P_k [N s] ≥ 0
  double* moment;          // M_k [N s²]
  double* onset;           // first time with force [s]
  double* closing_speed;   // c_k after the impact [m/s], ≤ 0 up to the tolerance
  double* peak = nullptr;  // largest F_k at the steps of the integration [N]; null: not wanted
  // arrays of 2 `size`, in the order of CoulombFriction::slip; needed if the problem has friction
  double* friction = nullptr;         // ∫ F_t dt [N s], |·| ≤ μ P_k
  double* friction_moment = nullptr;  // ∫ t F_t dt [N s²]
  double* slip = nullptr;             // v after the impact [m/s]
};

// Memory of an integration, owned by the caller.
struct Workspace {
  double* numbers;
  int* indices;
};

struct ImpactReport {
  int steps;        // accepted integration steps
  bool converged;   // false: the work allowed was done before all contacts had opened
  double work = 0;  // done, in multiplications: a nanosecond each, about
  double time = 0;  // when the integration ended [s]
};

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_IMPACT_PROBLEM_H_
