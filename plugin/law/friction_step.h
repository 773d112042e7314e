// SPDX-License-Identifier: Apache-2.0
// Coulomb friction in the steps of an integration.
//
// Within a step the friction of a contact keeps its ratio r to the normal force, F_t = r F with
// |r| ≤ μ, so that normal forces are those of the matrix W_nn + W_nt r: a function of the
// compression alone, as without friction. The ratios of the step before give the normal impulses ΔP
// of a step, these bound the friction of every contact (friction_on_disc.h), and a sweep over the
// contacts gives the ratios of this one. That is exact for contacts that stick at a constant ratio
// or slide straight on, and of second order where a slip turns. What a sweep leaves of the slip of
// contacts that stick is taken up by the next step.

#ifndef MUJOCO_IMPACT_LAW_FRICTION_STEP_H_
#define MUJOCO_IMPACT_LAW_FRICTION_STEP_H_

#include "law/friction_on_disc.h"
#include "law/impact_problem.h"
#include "law/impact_scale.h"
#include "law/lanes.h"

namespace mujoco_impact::law {

class FrictionStep {
 public:
  FrictionStep(const ImpactProblem& problem, const ImpactScale& scale, Lanes& lanes);

  static constexpr int kArrays = 11;  // numbers a lane

  // To be called whenever the lanes are other ones.
  void Load();

  // By lane, to be filled before Try and Accept: the impulses of the normal forces in the step, and
  // their moments about t = 0.
  double *dP, *dM;

  // Solves the friction of a step, and takes what other ratios than before do to the closing speeds
  // into c_new. Returns the error, in units of the tolerance. F and F_new are the normal forces at
  // both ends.
  double Try(const double* F, const double* F_new, double* c_new);

  // Accepts the step tried. Returns whether any ratio has changed.
  bool Accept();

  // Factor for the next step after one with this error.
  static double Growth(double error);

 private:
  void Begin();
  void Spread(int i, Pair p);
  double Sweep(double* c_new);
  void Change(int i, Pair by, double* c_new);
  Pair SlipOf(int i) const;
  void Finish(double* c_new);
  double Error(const double* F, const double* F_new) const;

  const ImpactProblem& problem_;
  const CoulombFriction& friction_;
  const ImpactScale& scale_;
  Lanes& lanes_;
  const BodyRows tangents_;  // if W is by bodies

  // by lane
  double* mu_;         // 0 where the bodies cannot slip
  double* stiffness_;  // (3) W_tt of the contact
  double* coupling_;   // the largest coupling of its friction with anything [1/kg]
  double* p_;          // (2) friction of the step tried [N s]
  double* slip_;       // (2) slip at its end [m/s]
};

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_FRICTION_STEP_H_
