// SPDX-License-Identifier: Apache-2.0
// The law layer as C functions, for Python (src/mujoco_impact/law.py) and other languages.
//
// Arrays are of `size` doubles unless said otherwise; units and signs as in the headers.

#include <cstring>
#include <vector>

#include "law/calibrated.h"
#include "law/friction.h"
#include "law/hertz_contact.h"
#include "law/impact_law.h"
#include "law/passivity.h"
#include "law/viscous.h"
#include "law/waveform.h"

#define MUJOCO_IMPACT_API extern "C" __attribute__((visibility("default")))

namespace law = mujoco_impact::law;

namespace {

// The diagonal of a matrix in compressed rows.
std::vector<double> Diagonal(int size, const int* row_start, const int* column,
                             const double* value) {
  std::vector<double> diagonal(size, 0.0);
  for (int k = 0; k < size; ++k) {
    for (int a = row_start[k]; a < row_start[k + 1]; ++a) {
      if (column[a] == k) diagonal[k] = value[a];
    }
  }
  return diagonal;
}

}  // namespace

MUJOCO_IMPACT_API double mujoco_impact_effective_modulus(double young, double poisson) {
  return law::EffectiveModulus(young, poisson);
}

MUJOCO_IMPACT_API double mujoco_impact_hertz_stiffness(double modulus, double curvature) {
  return law::HertzStiffness(modulus, curvature);
}

MUJOCO_IMPACT_API double mujoco_impact_contact_time(double stiffness, double reduced_mass,
                                                    double speed) {
  return law::ContactTime(stiffness, reduced_mass, speed);
}

MUJOCO_IMPACT_API double mujoco_impact_maximum_compression(double stiffness, double reduced_mass,
                                                           double speed) {
  return law::MaximumCompression(stiffness, reduced_mass, speed);
}

MUJOCO_IMPACT_API double mujoco_impact_viscous_damping(double restitution) {
  return law::ViscousDamping(restitution);
}

MUJOCO_IMPACT_API double mujoco_impact_waveform_force(double t, double restitution) {
  return law::WaveformForce(t, restitution);
}

MUJOCO_IMPACT_API double mujoco_impact_waveform_cumulative(double t, double restitution) {
  return law::WaveformCumulative(t, restitution);
}

MUJOCO_IMPACT_API double mujoco_impact_waveform_moment(double t, double restitution) {
  return law::WaveformMoment(t, restitution);
}

MUJOCO_IMPACT_API double mujoco_impact_waveform_height(double impulse, double duration) {
  return law::WaveformHeight(impulse, duration);
}

MUJOCO_IMPACT_API double mujoco_impact_calibrated_duration(double sw, double w0, double kappa,
                                                           double momentum) {
  return law::CalibratedDuration({0, sw, w0, kappa}, momentum);
}

MUJOCO_IMPACT_API double mujoco_impact_calibrated_impulse(double sh, double sw, double w0,
                                                          double kappa, double momentum) {
  return law::CalibratedImpulse({sh, sw, w0, kappa}, momentum);
}

// Q of friction.h for `size` contacts.
MUJOCO_IMPACT_API void mujoco_impact_friction_impulse(int size, const double* static_factor,
                                                      const double* dynamic_factor,
                                                      const double* normal_momentum,
                                                      const double* slip_momentum,
                                                      const double* impulse, double* friction) {
  for (int k = 0; k < size; ++k) {
    friction[k] = law::FrictionImpulse({static_factor[k], dynamic_factor[k]}, normal_momentum[k],
                                       slip_momentum[k], impulse[k]);
  }
}

// min(1, s*) of passivity.h.
MUJOCO_IMPACT_API double mujoco_impact_passive_scale(int size, const int* row_start,
                                                     const int* column, const double* value,
                                                     const double* closing_speed,
                                                     const double* impulse) {
  std::vector<double> work(size);
  const law::DelassusMatrix delassus{size, row_start, column, value, nullptr};
  return law::PassiveScale(delassus, closing_speed, impulse, work.data());
}

// Solves the impact of an island; returns the number of steps, negative if it did not end.
// dissipation: 0 bistiffness, 1 viscous. `impulse`, `moment`, `onset`, `after` are written.
MUJOCO_IMPACT_API int mujoco_impact_solve(int size, const int* row_start, const int* column,
                                          const double* value, const double* closing_speed,
                                          const double* gap, const double* stiffness,
                                          const double* restitution, int dissipation,
                                          double horizon, double tolerance, int passive,
                                          double* impulse, double* moment, double* onset,
                                          double* after) {
  const std::vector<double> diagonal = Diagonal(size, row_start, column, value);
  std::vector<double> numbers(law::ImpactNumbers(size));
  std::vector<int> indices(law::ImpactIndices(size));
  const law::ImpactProblem problem{{size, row_start, column, value, diagonal.data()},
                                   closing_speed,
                                   gap,
                                   stiffness,
                                   restitution,
                                   static_cast<law::Dissipation>(dissipation),
                                   horizon,
                                   horizon,
                                   tolerance};
  law::ImpactSolution solution{impulse, moment, onset, after};
  const law::ImpactReport report =
      law::SolveImpact(problem, passive != 0, &solution, {numbers.data(), indices.data()});
  return report.converged ? report.steps : -report.steps;
}

// The same with Coulomb friction (coulomb.h). `mu` (size); `slip` (2 size) before the impact;
// `block` (8 times the entries of the compressed rows): the TangentBlock of every entry.
// `friction`, `friction_moment`, `slip_after` (2 size each) are written as well.
MUJOCO_IMPACT_API int mujoco_impact_solve_with_friction(
    int size, const int* row_start, const int* column, const double* value, const double* block,
    const double* closing_speed, const double* slip, const double* gap, const double* stiffness,
    const double* mu, const double* restitution, int dissipation, double horizon, double tolerance,
    int passive, double* impulse, double* moment, double* onset, double* after, double* friction,
    double* friction_moment, double* slip_after) {
  const std::vector<double> diagonal = Diagonal(size, row_start, column, value);
  std::vector<double> numbers(law::ImpactNumbers(size, true)), work(row_start[size]);
  std::vector<int> indices(law::ImpactIndices(size));
  std::vector<law::TangentBlock> blocks(row_start[size]);
  std::memcpy(blocks.data(), block, blocks.size() * sizeof(law::TangentBlock));
  const law::CoulombFriction coulomb{mu, slip, blocks.data(), work.data(), nullptr};
  law::ImpactProblem problem{{size, row_start, column, value, diagonal.data()},
                             closing_speed,
                             gap,
                             stiffness,
                             restitution,
                             static_cast<law::Dissipation>(dissipation),
                             horizon,
                             horizon,
                             tolerance};
  problem.friction = &coulomb;
  law::ImpactSolution solution{impulse, moment,   onset,           after,
                               nullptr, friction, friction_moment, slip_after};
  const law::ImpactReport report =
      law::SolveImpact(problem, passive != 0, &solution, {numbers.data(), indices.data()});
  return report.converged ? report.steps : -report.steps;
}
