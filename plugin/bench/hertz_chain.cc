// SPDX-License-Identifier: Apache-2.0
// A row of pendulum balls with Hertz contacts, integrated by DOPRI5 with error control.
//
// The least that resolving every impact in time can cost: nothing but the equations of motion
//
//   I_i a_i'' = -m_i g L sin a_i + sum over the pairs of ball i of K delta^1.5 dG/da_i
//
// with delta = max(-G, 0), G the gap of a pair as a function of its two angles.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace {

struct Chain {
  int count;
  double length;                // pivot to centre [m]
  const double* weight_torque;  // (count) m g L [N m]
  const double* inertia;        // (count) [kg m^2]
  const double* stiffness;      // (count - 1) K [N/m^1.5]
  const double* gap;            // (count - 1) between hanging neighbours [m]
  const double* spacing;        // (count - 1) between pivots [m]
};

// Adds the contact torques. The gap is a difference from the spacing, so that compressions of
// 1e-5 m keep their digits.
void AddContacts(const Chain& chain, const double* angle, double* torque) {
  for (int k = 0; k + 1 < chain.count; ++k) {
    const double half = 0.5 * (angle[k + 1] - angle[k]);
    const double mean = 0.5 * (angle[k + 1] + angle[k]);
    const double space = chain.spacing[k];
    const double chord = 2 * chain.length * std::sin(half);
    const double lever = space * std::cos(mean);
    const double excess = chord * (2 * lever + chord);
    const double distance = std::sqrt(space * space + excess);
    const double gap = chain.gap[k] + excess / (distance + space);
    if (gap >= 0) continue;
    const double force = chain.stiffness[k] * -gap * std::sqrt(-gap);
    const double by_difference = chain.length * std::cos(half) * (lever + chord) / distance;
    const double by_mean = -space * chord * std::sin(mean) / distance;
    torque[k] += force * (0.5 * by_mean - by_difference);
    torque[k + 1] += force * (0.5 * by_mean + by_difference);
  }
}

// state: angles, then angular velocities
void Rates(const Chain& chain, const double* state, double* rate) {
  const int n = chain.count;
  for (int i = 0; i < n; ++i) {
    rate[i] = state[n + i];
    rate[n + i] = -chain.weight_torque[i] * std::sin(state[i]);
  }
  AddContacts(chain, state, rate + n);
  for (int i = 0; i < n; ++i) rate[n + i] /= chain.inertia[i];
}

// The pair of Dormand and Prince (1980), order 5(4), first same as last.
constexpr int kStages = 7;
constexpr double kA[kStages][kStages - 1] = {
    {},
    {1. / 5},
    {3. / 40, 9. / 40},
    {44. / 45, -56. / 15, 32. / 9},
    {19372. / 6561, -25360. / 2187, 64448. / 6561, -212. / 729},
    {9017. / 3168, -355. / 33, 46732. / 5247, 49. / 176, -5103. / 18656},
    {35. / 384, 0, 500. / 1113, 125. / 192, -2187. / 6784, 11. / 84}};
constexpr double kError[kStages] = {71. / 57600,      0,         -71. / 16695, 71. / 1920,
                                    -17253. / 339200, 22. / 525, -1. / 40};

class Integrator {
 public:
  Integrator(const Chain& chain, double tolerance, double longest)
      : chain_(chain),
        size_(2 * static_cast<std::size_t>(chain.count)),
        tolerance_(tolerance),
        longest_(longest),
        step_(longest),
        work_(size_ * (kStages + 1)) {}

  // Goes to `until`; false: the step became too small.
  bool Advance(double* state, double* now, double until) {
    if (!started_) Rates(chain_, state, Stage(0));
    started_ = true;
    while (*now < until) {
      const double h = std::min(step_, until - *now);
      const double error = Try(state, h);
      ++steps_;
      const double factor = std::clamp(0.9 * std::pow(error, -0.2), 0.2, 5.0);
      if (error <= 1) {
        std::copy_n(Next(), size_, state);
        std::copy_n(Stage(kStages - 1), size_, Stage(0));
        *now = h == until - *now ? until : *now + h;
        // a step cut short by a sample says nothing against the step before
        step_ = std::min(longest_, std::max(h * factor, h < step_ ? step_ : 0.0));
      } else {
        step_ = h * factor;
      }
      if (step_ < 1e-15) return false;
    }
    return true;
  }

  long steps() const { return steps_; }

 private:
  double* Stage(int s) { return work_.data() + size_ * static_cast<std::size_t>(s); }
  double* Next() { return Stage(kStages); }

  // Fills Next() with the state after h, of which the last stage is the rate; returns the error in
  // units of what is allowed.
  double Try(const double* state, double h) {
    for (int s = 1; s < kStages; ++s) {
      for (std::size_t i = 0; i < size_; ++i) {
        double sum = 0;
        for (int r = 0; r < s; ++r) sum += kA[s][r] * Stage(r)[i];
        Next()[i] = state[i] + h * sum;
      }
      Rates(chain_, Next(), Stage(s));
    }
    double square = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      double sum = 0;
      for (int s = 0; s < kStages; ++s) sum += kError[s] * Stage(s)[i];
      // angles count as what they move within a contact time of 0.1 ms
      const double scale = i < size_ / 2 ? kAngle : kVelocity;
      const double ratio = h * sum / (tolerance_ * scale);
      square += ratio * ratio;
    }
    return std::max(1e-10, std::sqrt(square / static_cast<double>(size_)));
  }

  static constexpr double kVelocity = 3;  // [rad/s] of a ball let go at 30 degrees
  static constexpr double kAngle = 3e-4;  // [rad]

  const Chain& chain_;
  std::size_t size_;
  double tolerance_, longest_, step_;
  bool started_ = false;
  long steps_ = 0;
  std::vector<double> work_;
};

}  // namespace

// Fills rows 1 to samples - 1 of `angle` and `velocity`, (samples x count), at equidistant times up
// to `duration`, from row 0. Returns the number of steps tried, negative if it gave up.
extern "C" __attribute__((visibility("default"))) long hertz_chain_swing(
    int count, double length, const double* weight_torque, const double* inertia,
    const double* stiffness, const double* gap, const double* spacing, double duration,
    double tolerance, double longest, int samples, double* angle, double* velocity) {
  const Chain chain{count, length, weight_torque, inertia, stiffness, gap, spacing};
  Integrator integrator(chain, tolerance, longest);
  std::vector<double> state(2 * static_cast<std::size_t>(count));
  std::copy_n(angle, count, state.data());
  std::copy_n(velocity, count, state.data() + count);
  double now = 0;
  for (int sample = 1; sample < samples; ++sample) {
    const double until = duration * sample / (samples - 1);
    if (!integrator.Advance(state.data(), &now, until)) return -integrator.steps();
    std::copy_n(state.data(), count, angle + static_cast<std::ptrdiff_t>(sample) * count);
    std::copy_n(state.data() + count, count,
                velocity + static_cast<std::ptrdiff_t>(sample) * count);
  }
  return integrator.steps();
}
