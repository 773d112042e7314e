// SPDX-License-Identifier: Apache-2.0
// A fixed workload of the law layer, for counting instructions.
//
//   law_workload BALLS REPEATS [GAP]
//
// Solves the first impact of a touching row of BALLS equal steel balls REPEATS times and prints the
// number of integration steps and the last velocity. Count only `MeasuredImpact`:
//
//   valgrind --tool=callgrind --toggle-collect='MeasuredImpact*' law_workload 5 100

#include <cstdio>
#include <cstdlib>
#include <vector>

#include "law/impact_law.h"
#include "tests/rows.h"

namespace law = mujoco_impact::law;

namespace {

constexpr double kMass = 0.115;         // [kg]
constexpr double kStiffness = 1.27e10;  // [N/m^1.5] two balls of 30 mm, steel
constexpr double kHorizon = 1e-3;       // [s] what one timestep may hold
constexpr double kSpeed = 0.89;         // [m/s]

}  // namespace

// What is counted: one solve, nothing around it.
extern "C" __attribute__((noinline)) law::ImpactReport MeasuredImpact(
    const law::ImpactProblem& problem, law::ImpactSolution* solution,
    const law::Workspace& workspace) {
  return law::SolveImpact(problem, true, solution, workspace);
}

int main(int argc, char** argv) {
  const int balls = argc > 1 ? std::atoi(argv[1]) : 0;
  const int repeats = argc > 2 ? std::atoi(argv[2]) : 0;
  const double opening = argc > 3 ? std::atof(argv[3]) : 0;
  if (balls < 2 || repeats < 1 || opening < 0) {
    std::fprintf(stderr, "usage: law_workload BALLS REPEATS [GAP]; at least 2 balls, 1 repeat\n");
    return 2;
  }
  const std::size_t contacts = static_cast<std::size_t>(balls) - 1;
  const law::RowMatrix matrix(std::vector<double>(contacts + 1, kMass));
  std::vector<double> closing(contacts, 0.0), gap(contacts, opening);
  const std::vector<double> stiffness(contacts, kStiffness), restitution(contacts, 1.0);
  closing[0] = kSpeed;
  gap[0] = 0;
  const law::ImpactProblem problem{
      matrix.View(),    closing.data(),     gap.data(),
      stiffness.data(), restitution.data(), law::Dissipation::kBistiffness,
      kHorizon,         kHorizon,           law::kDefaultTolerance};
  std::vector<double> impulse(contacts), moment(contacts), onset(contacts), after(contacts);
  std::vector<double> numbers(law::ImpactNumbers(static_cast<int>(contacts)));
  std::vector<int> indices(law::ImpactIndices(static_cast<int>(contacts)));
  law::ImpactSolution solution{impulse.data(), moment.data(), onset.data(), after.data()};
  law::ImpactReport report{};
  for (int repeat = 0; repeat < repeats; ++repeat) {
    report = MeasuredImpact(problem, &solution, {numbers.data(), indices.data()});
  }
  std::printf("steps %d last_velocity %.9f\n", report.steps, impulse.back() / kMass);
  return report.converged ? 0 : 1;
}
