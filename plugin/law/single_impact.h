// SPDX-License-Identifier: Apache-2.0
// Closed form of one contact of reduced mass μ that closes with speed u (bi-stiffness):
//
//   P = (1 + e) μ u        W = (1 + e) T/2        M = W P − μ (u W − (1 − e²) y_max)
//
// M from the relative displacement u W − ∫ (W − s) F ds/μ, which a loss leaves at (1 − e²) y_max.

#ifndef MUJOCO_IMPACT_LAW_SINGLE_IMPACT_H_
#define MUJOCO_IMPACT_LAW_SINGLE_IMPACT_H_

namespace mujoco_impact::law {

struct SingleImpact {
  double impulse;   // P [N s]
  double duration;  // W [s]
  double moment;    // M about the onset [N s²]
  double peak;      // K y_max^(3/2) [N]
};
SingleImpact SolveSingleImpact(double reduced_mass, double speed, double stiffness,
                               double restitution);

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_SINGLE_IMPACT_H_
