// SPDX-License-Identifier: Apache-2.0
// A fixed workload of the law with friction, for counting instructions.
//
//   friction_workload SCENE MU    SCENE: rack, face, edge, corner; MU: 0 without tangential rows
//
// Solves one impact and prints the number of steps. Count only the law:
//
//   valgrind --tool=callgrind --toggle-collect='*SolveImpact*' friction_workload rack 0.06

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "tests/islands.h"

namespace law = mujoco_impact::law;

namespace {

constexpr double kRadius = 0.028575, kMass = 0.17;

void TouchAll(const std::vector<law::FreeBody>& balls, double mu,
              std::vector<law::Touch>& touches) {
  const int n = static_cast<int>(balls.size());
  for (int a = 0; a < n; ++a) {
    for (int b = a + 1; b < n; ++b) {
      law::Vec3 between, middle;
      for (int i = 0; i < 3; ++i) {
        between[i] = balls[b].position[i] - balls[a].position[i];
        middle[i] = 0.5 * (balls[b].position[i] + balls[a].position[i]);
      }
      const double length = std::hypot(between[0], between[1]);
      if (length > 2 * kRadius + 1e-9) continue;
      const law::Vec3 normal{between[0] / length, between[1] / length, 0};
      touches.push_back({a, b, middle, normal, {0, 0, 1}, mu});
    }
  }
}

// A cue ball of 8 m/s on a rack of fifteen, a tenth of a ball off the middle.
law::FreeIsland Rack(double mu) {
  std::vector<law::FreeBody> balls{law::Ball(
      kMass, kRadius, {-2 * kRadius * std::sqrt(0.99), 2 * kRadius * 0.1, 0}, {8, 0, 0, 0, 0, 0})};
  for (int row = 0; row < 5; ++row) {
    for (int i = 0; i <= row; ++i) {
      balls.push_back(
          law::Ball(kMass, kRadius, {row * std::sqrt(3) * kRadius, (2 * i - row) * kRadius, 0}));
    }
  }
  std::vector<law::Touch> touches;
  TouchAll(balls, mu, touches);
  return law::FreeIsland(balls, touches);
}

// A box that slides and turns, on so many of the corners of its face.
law::FreeIsland Box(int corners, double mu) {
  const law::Vec3 half{0.05, 0.07, 0.04};
  const law::Vec3 inertia{(half[1] * half[1] + half[2] * half[2]) / 3,
                          (half[0] * half[0] + half[2] * half[2]) / 3,
                          (half[0] * half[0] + half[1] * half[1]) / 3};
  const law::FreeBody box{1, inertia, {0, 0, half[2]}, {0.8, -0.5, -1, 2, 1, 3}};
  const double sign[4][2] = {{1, 1}, {1, -1}, {-1, 1}, {-1, -1}};
  std::vector<law::Touch> touches;
  for (int i = 0; i < corners; ++i) {
    const law::Vec3 point{sign[i][0] * half[0], sign[i][1] * half[1], 0};
    touches.push_back({-1, 0, point, {0, 0, 1}, {1, 0, 0}, mu});
  }
  return law::FreeIsland({box}, touches);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string scene = argc > 1 ? argv[1] : "";
  const double mu = argc > 2 ? std::atof(argv[2]) : -1;
  const int corners = scene == "face" ? 4 : scene == "edge" ? 2 : scene == "corner" ? 1 : 0;
  if ((scene != "rack" && corners == 0) || mu < 0) {
    std::fprintf(stderr, "usage: friction_workload SCENE MU; rack, face, edge, corner; MU >= 0\n");
    return 2;
  }
  law::FreeIsland island = corners > 0 ? Box(corners, mu) : Rack(mu);
  const double e = argc > 3 ? std::atof(argv[3]) : 1;
  const auto result = island.Solve({.restitution = e, .friction = mu > 0});
  std::printf("steps %d\n", result.report.steps);
  return result.report.converged ? 0 : 1;
}
