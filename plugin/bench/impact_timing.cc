// SPDX-License-Identifier: Apache-2.0
// The impact of a straight row of touching equal balls, timed: by the law, and by a plain loop.
//
// The first ball comes in, the others rest. Both functions solve the same impact `repeats` times,
// write the velocities it leaves, (balls) [m/s], and the seconds that one solve takes, and return
// its number of steps, negative if it did not end.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <vector>

#include "law/impact_law.h"
#include "tests/rows.h"

namespace law = mujoco_impact::law;

namespace {

// Everything that both ways of solving are told.
struct Impact {
  int balls;
  double mass;       // [kg] of each ball
  double stiffness;  // K of each contact [N/m^1.5]
  double speed;      // of the first ball [m/s]
};

// Calls `solve` `repeats` times; returns the seconds of one call.
template <typename Solve>
double SecondsOf(int repeats, const Solve& solve) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  for (int repeat = 0; repeat < repeats; ++repeat) solve();
  return std::chrono::duration<double>(Clock::now() - begin).count() / repeats;
}

// The equations of the row as they stand, by velocity Verlet with a fixed step:
//
//   m v_i' = F_(i-1) - F_i,   F_k = K y_k^1.5 (y_k > 0),   y_k' = v_k - v_(k+1)
//
// All balls, all the time: what a programmer writes down first.
class Loop {
 public:
  Loop(const Impact& impact, double step)
      : impact_(impact),
        step_(step),
        velocity_(static_cast<std::size_t>(impact.balls)),
        compression_(velocity_.size() - 1),
        force_(velocity_.size() + 1) {}

  // Returns the number of steps, negative: contacts still press after `most`.
  long Run(long most) {
    std::fill(velocity_.begin(), velocity_.end(), 0.0);
    std::fill(compression_.begin(), compression_.end(), 0.0);
    std::fill(force_.begin(), force_.end(), 0.0);
    velocity_[0] = impact_.speed;
    for (long step = 1; step <= most; ++step) {
      Kick();
      if (!Drift()) return step;
      Kick();
    }
    return -most;
  }

  const std::vector<double>& velocity() const { return velocity_; }

 private:
  // Half a step of the velocities.
  void Kick() {
    const double scale = 0.5 * step_ / impact_.mass;
    for (std::size_t i = 0; i < velocity_.size(); ++i) {
      velocity_[i] += scale * (force_[i] - force_[i + 1]);
    }
  }

  // A step of the compressions, and their forces; false: all contacts are open and none closes.
  bool Drift() {
    bool pressed = false;
    for (std::size_t k = 0; k < compression_.size(); ++k) {
      const double closing = velocity_[k] - velocity_[k + 1];
      const double y = compression_[k] += step_ * closing;
      force_[k + 1] = y > 0 ? impact_.stiffness * y * std::sqrt(y) : 0;
      // rounding leaves contacts that close by nothing
      pressed = pressed || y > 0 || closing > kNothing * impact_.speed;
    }
    return pressed;
  }

  static constexpr double kNothing = 1e-9;

  const Impact impact_;
  const double step_;
  std::vector<double> velocity_, compression_;
  std::vector<double> force_;  // force_[k + 1] is that of contact k; the ends stay 0
};

// Fills the velocities that the impulses of a solution leave.
void Leave(const Impact& impact, const std::vector<double>& impulse, double* velocity) {
  std::fill_n(velocity, impact.balls, 0.0);
  velocity[0] = impact.speed;
  for (std::size_t k = 0; k < impulse.size(); ++k) {
    velocity[k] -= impulse[k] / impact.mass;
    velocity[k + 1] += impulse[k] / impact.mass;
  }
}

constexpr double kHorizon = 1e-3;  // [s] what one timestep may hold

}  // namespace

extern "C" __attribute__((visibility("default"))) long impact_timing_law(
    int balls, double mass, double stiffness, double speed, double tolerance, int repeats,
    double* velocity, double* seconds) {
  const Impact impact{balls, mass, stiffness, speed};
  const std::size_t contacts = static_cast<std::size_t>(balls) - 1;
  const law::RowMatrix matrix(std::vector<double>(contacts + 1, mass));
  std::vector<double> closing(contacts, 0.0);
  closing[0] = speed;
  const std::vector<double> gap(contacts, 0.0), stiffnesses(contacts, stiffness),
      restitution(contacts, 1.0);
  const law::ImpactProblem problem{
      matrix.View(),      closing.data(),     gap.data(),
      stiffnesses.data(), restitution.data(), law::Dissipation::kBistiffness,
      kHorizon,           kHorizon,           tolerance};
  std::vector<double> impulse(contacts), moment(contacts), onset(contacts), after(contacts);
  std::vector<double> numbers(law::ImpactNumbers(static_cast<int>(contacts)));
  std::vector<int> indices(law::ImpactIndices(static_cast<int>(contacts)));
  law::ImpactSolution solution{impulse.data(), moment.data(), onset.data(), after.data()};
  law::ImpactReport report{};
  *seconds = SecondsOf(repeats, [&] {
    report = law::SolveImpact(problem, true, &solution, {numbers.data(), indices.data()});
  });
  Leave(impact, impulse, velocity);
  return report.converged ? report.steps : -report.steps;
}

extern "C" __attribute__((visibility("default"))) long impact_timing_loop(
    int balls, double mass, double stiffness, double speed, double step, long most, int repeats,
    double* velocity, double* seconds) {
  Loop loop({balls, mass, stiffness, speed}, step);
  long steps = 0;
  *seconds = SecondsOf(repeats, [&] { steps = loop.Run(most); });
  std::copy(loop.velocity().begin(), loop.velocity().end(), velocity);
  return steps;
}
