// SPDX-License-Identifier: Apache-2.0

#include "law/single_impact.h"

#include <cmath>

#include "law/hertz_contact.h"

namespace mujoco_impact::law {

SingleImpact SolveSingleImpact(double reduced_mass, double speed, double stiffness,
                               double restitution) {
  const double e = restitution;
  const double y_max = MaximumCompression(stiffness, reduced_mass, speed);
  SingleImpact single;
  single.impulse = (1 + e) * reduced_mass * speed;
  single.duration = (1 + e) / 2 * ContactTime(stiffness, reduced_mass, speed);
  single.moment = single.duration * single.impulse -
                  reduced_mass * (speed * single.duration - (1 - e * e) * y_max);
  single.peak = stiffness * y_max * std::sqrt(y_max);
  return single;
}

}  // namespace mujoco_impact::law
