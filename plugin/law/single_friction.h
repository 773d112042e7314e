// SPDX-License-Identifier: Apache-2.0
// The impact of one contact with friction, by its impulse instead of its time.
//
// With the normal impulse P as the variable the compliance drops out,
//
//   dc/dP = −(W_nn + W_nt r)    dv/dP = W_tn + W_tt r    dE/dP = c, or c/e² while c < 0
//
// r = F_t / F, E the energy that is stored: the impact is over when E is zero again. While r is
// constant c is a straight line and E a parabola, so that every contact is a few pieces in closed
// form whose slip stays on a line (spheres on anything, all that moves in a plane: Keller, J. Appl.
// Mech. 53, 1986), and steps (friction_on_disc.h) are needed only where a slip turns. Time is
//
//   t = ∫ dP / F,  F = K (5 E / (2 K))³ᐟ⁵
//
// by Gauss quadrature.

#ifndef MUJOCO_IMPACT_LAW_SINGLE_FRICTION_H_
#define MUJOCO_IMPACT_LAW_SINGLE_FRICTION_H_

#include "law/coulomb.h"

namespace mujoco_impact::law {

struct FrictionContact {
  double W;            // of its normal row [1/kg]
  TangentBlock block;  // of the contact with itself
  double closing_speed;
  double slip[2];
  double mu, stiffness, restitution;
};

struct SingleFriction {
  double impulse;             // P [N s]
  double moment;              // ∫ t F dt about the onset [N s²]
  double duration;            // [s]
  double peak;                // [N]
  double friction[2];         // ∫ F_t dt [N s]
  double friction_moment[2];  // [N s²]
  int steps;
  bool ended;  // false: it was left after too many steps
};

// `tolerance` is that of the steps, in parts of the closing speed.
SingleFriction SolveSingleFriction(const FrictionContact& contact, double tolerance);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_SINGLE_FRICTION_H_
