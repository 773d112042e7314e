// SPDX-License-Identifier: Apache-2.0
// Coulomb friction in the steps of an integration.
//
// Within a step the friction of a contact keeps its ratio r to the normal force, F_t = r F with
// |r| ≤ μ, so that normal forces are those of the matrix W_nn + W_nt r: a function of the
// compression alone, as without friction. The ratios of the step before give the normal impulses ΔP
// of a step, these bound the friction of every contact (friction_on_disc.h), and sweeps over the
// contacts give it; what it changes is taken into the step. So a step is exact for contacts that
// slide straight on or stop, and of second order where a slip turns and where ratios change. It
// need not end where a contact stops or begins to slide, unless that does much. What sweeps leave
// of the slip of contacts that stick is taken up by the next step.

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

  static constexpr int kArrays = 24;   // numbers a lane
  static constexpr int kProducts = 4;  // what a step costs, in products by W

  // To be called whenever the lanes are other ones.
  void Load();

  // The coefficient of a lane; 0 where bodies cannot slip.
  double mu(int i) const { return grip_[i].mu; }

  // By lane, to be filled before Try: what the normal forces of the step give, ∫ F ds and
  // ∫ (h − s) F ds.
  double *dP, *lead;

  // Solves the friction of a step. Returns the error, in units of the tolerance. F and F_new are
  // the normal forces at both ends.
  double Try(const double* F, const double* F_new);

  // Factor for the next step after one with this error: to where a contact stops, if that is it.
  double Growth(double error) const;

  // For a step whose contacts stop as it begins: gives these the ratios that hold them, if they
  // change how hard it is to press them. Its normal forces were found with those of sliding, and
  // have to be found anew. Returns whether it gave any.
  bool StopAtOnce();

  // Takes what other ratios than before do into the compressions and closing speeds at the end of
  // the step tried; `rate` is dy/dt over c.
  void Finish(const double* rate, double* y_new, double* c_new);

  // Accepts the step, which ends at t. Returns whether it has changed the compressions or any
  // ratio.
  bool Accept(double t);

 private:
  // Of a lane. Ratios are in units of 1/ΔP, as in ContactStep.
  struct Grip {
    double mu;  // 0 where the bodies cannot slip
    Tangents A, inverse;
    double weight;  // the largest coupling of its friction with anything [1/kg]
    bool stuck;
    double theta;
    double p[2], lead[2], ratio[2];  // of the step tried
    double first_rate[2];            // of its slip, as in ContactStep
  };
  static constexpr int kGrip = (sizeof(Grip) + sizeof(double) - 1) / sizeof(double);
  static_assert(kGrip + 6 <= kArrays);

  template <typename Visit>
  void ForLanes(int k, Visit visit);
  void Begin(const double* F);
  void Spread(int i);
  double Sweep();
  void Change(int i, const StepFriction& friction);
  void FindSlip(int i);
  double Error(int i, const double* F, const double* F_new) const;

  const ImpactProblem& problem_;
  const CoulombFriction& friction_;
  Lanes& lanes_;
  const BodyRows tangents_;  // if W is by bodies
  const double enough_;      // a slip that is none [m/s]
  const double tolerance_;   // [m/s]
  double stop_ = 0;  // the part of the step after which the contact with the largest error stops
  double *slip_, *rate_;  // by lane (2): at the end of the step, as in ContactStep
  Grip* grip_;            // by lane
};

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_FRICTION_STEP_H_
