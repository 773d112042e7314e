// SPDX-License-Identifier: Apache-2.0
// Fuzz target: the law layer on random islands.
//
// The input is read as an island of bodies on a line or in the plane, any of them joined by
// contacts, with every number drawn from the range that attributes and models allow. Whatever the
// island, impulses must be finite pushes that do not add energy.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "law/impact_law.h"
#include "law/passivity.h"
#include "law/viscous.h"

namespace law = mujoco_impact::law;

namespace {

constexpr int kMaxBodies = 8;
constexpr int kMaxContacts = 12;
constexpr int kAxes = 2;

// Rounding of sums of some ten terms, in parts of the energy that comes in.
constexpr double kRounding = 1e-9;

// The bytes of the input, one number after the other; zeros when they are used up.
class Bytes {
 public:
  Bytes(const uint8_t* data, size_t size) : data_(data), size_(size) {}

  int Integer(int low, int high) { return low + static_cast<int>(Next() % (high - low + 1)); }

  // In [0, 1], both ends included.
  double Part() { return (Next() * 256.0 + Next()) / 65535.0; }

  double Logarithmic(double low, double high) { return low * std::pow(high / low, Part()); }

 private:
  uint32_t Next() { return at_ < size_ ? data_[at_++] : 0; }

  const uint8_t* data_;
  size_t size_, at_ = 0;
};

struct Island {
  int size = 0;
  std::vector<double> delassus;  // dense, for the making
  std::vector<int> row_start, column;
  std::vector<double> value, diagonal;
  std::vector<double> closing_speed, gap, stiffness;
  double energy = 0;  // kinetic energy of all bodies [J]
};

Island ReadIsland(Bytes& bytes) {
  const int bodies = bytes.Integer(2, kMaxBodies);
  Island island;
  const int n = island.size = bytes.Integer(1, kMaxContacts);
  std::vector<double> inverse_mass(bodies), velocity(kAxes * bodies);
  const double speed = bytes.Logarithmic(1e-6, 1e3);
  for (int i = 0; i < bodies; ++i) {
    inverse_mass[i] = 1 / bytes.Logarithmic(1e-3, 1e3);
    for (int axis = 0; axis < kAxes; ++axis) {
      const double v = velocity[kAxes * i + axis] = speed * (2 * bytes.Part() - 1);
      island.energy += v * v / inverse_mass[i] / 2;
    }
  }
  // one material, radii from 1e-4 to 1e2 m: K = 4/3 E* √R
  const double modulus = bytes.Logarithmic(1e5, 1e12);
  // J: contact k parts its two bodies along its normal
  std::vector<double> jacobian(n * kAxes * bodies, 0.0);
  for (int k = 0; k < n; ++k) {
    const int first = bytes.Integer(0, bodies - 1);
    const int second = (first + bytes.Integer(1, bodies - 1)) % bodies;
    const double angle = 6.283185307179586 * bytes.Part();
    const double normal[kAxes] = {std::cos(angle), std::sin(angle)};
    for (int axis = 0; axis < kAxes; ++axis) {
      jacobian[(k * bodies + first) * kAxes + axis] = -normal[axis];
      jacobian[(k * bodies + second) * kAxes + axis] = normal[axis];
    }
    island.gap.push_back(bytes.Integer(0, 1) ? 0 : bytes.Logarithmic(1e-9, 1e-2));
    island.stiffness.push_back(modulus * bytes.Logarithmic(1e-2, 10));
    double closing = 0;
    for (int i = 0; i < kAxes * bodies; ++i) {
      closing -= jacobian[k * kAxes * bodies + i] * velocity[i];
    }
    island.closing_speed.push_back(closing);
  }
  // W = J M⁻¹ Jᵀ
  island.row_start.push_back(0);
  for (int k = 0; k < n; ++k) {
    for (int l = 0; l < n; ++l) {
      double w = 0;
      for (int i = 0; i < kAxes * bodies; ++i) {
        w += jacobian[k * kAxes * bodies + i] * inverse_mass[i / kAxes] *
             jacobian[l * kAxes * bodies + i];
      }
      if (k == l) island.diagonal.push_back(w);
      if (w == 0 && k != l) continue;
      island.column.push_back(l);
      island.value.push_back(w);
    }
    island.row_start.push_back(static_cast<int>(island.column.size()));
  }
  return island;
}

[[noreturn]] void Fail(const char* promise, double value) {
  std::fprintf(stderr, "broken promise: %s (%.17g)\n", promise, value);
  std::abort();
}

void CheckSolution(const law::ImpactProblem& problem, const law::ImpactSolution& solution,
                   double energy, bool passive) {
  const int n = problem.delassus.size;
  for (int k = 0; k < n; ++k) {
    if (!std::isfinite(solution.impulse[k])) Fail("impulses are finite", solution.impulse[k]);
    if (!std::isfinite(solution.moment[k])) Fail("moments are finite", solution.moment[k]);
    if (!std::isfinite(solution.onset[k])) Fail("onsets are finite", solution.onset[k]);
    if (solution.impulse[k] < 0) Fail("impulses push", solution.impulse[k]);
  }
  std::vector<double> work(n);
  const double change = law::KineticEnergyChange(problem.delassus, problem.closing_speed,
                                                 solution.impulse, work.data());
  if (passive && change > kRounding * energy) Fail("no energy is added", change / energy);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Bytes bytes(data, size);
  const bool viscous = bytes.Integer(0, 1) == 1;
  const double restitutions[] = {1, 0, bytes.Part(), bytes.Logarithmic(1e-6, 1)};
  const double horizon = bytes.Logarithmic(1e-5, 2e-2);
  const bool last = bytes.Integer(0, 1) == 1;
  const Island island = ReadIsland(bytes);
  const int n = island.size;
  // most impacts have one restitution
  const bool mixed = bytes.Integer(0, 3) == 0;
  std::vector<double> restitution(n, restitutions[bytes.Integer(0, 3)]);
  for (double& e : restitution) {
    if (mixed) e = restitutions[bytes.Integer(0, 3)];
    if (viscous) e = std::max(e, law::kViscousMinimum);
  }
  const law::ImpactProblem problem{
      {n, island.row_start.data(), island.column.data(), island.value.data(),
       island.diagonal.data()},
      island.closing_speed.data(),
      island.gap.data(),
      island.stiffness.data(),
      restitution.data(),
      viscous ? law::Dissipation::kViscous : law::Dissipation::kBistiffness,
      horizon,
      last ? horizon : 0.1 * horizon,
      law::kDefaultTolerance};
  std::vector<double> impulse(n), moment(n), onset(n), after(n);
  std::vector<double> numbers(law::ImpactNumbers(n));
  std::vector<int> indices(law::ImpactIndices(n));
  law::ImpactSolution solution{impulse.data(), moment.data(), onset.data(), after.data()};
  law::SolveImpact(problem, true, &solution, {numbers.data(), indices.data()});
  CheckSolution(problem, solution, island.energy, true);
  return 0;
}
