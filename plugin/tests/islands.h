// SPDX-License-Identifier: Apache-2.0
// Impacts of free bodies in space, with their tangential rows, for the tests of friction.

#ifndef MUJOCO_IMPACT_TESTS_ISLANDS_H_
#define MUJOCO_IMPACT_TESTS_ISLANDS_H_

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "law/impact_law.h"

namespace mujoco_impact::law {

using Vec3 = std::array<double, 3>;

inline Vec3 Cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// A free body; its inertia is that of a ball or, by axis, of a box that is not turned.
struct FreeBody {
  double mass;
  Vec3 inertia, position;
  std::array<double, 6> velocity;  // of the centre of mass, then angular
};

// From body `first` (−1: the ground) to body `second`, with the normal that way.
struct Touch {
  int first, second;
  Vec3 point, normal, tangent;
  double mu, gap = 0;
};

// The rows of an island in both forms of the Delassus matrix.
class FreeIsland {
 public:
  static constexpr int kDofs = 6, kRows = 3;

  FreeIsland(std::vector<FreeBody> bodies, std::vector<Touch> touches)
      : bodies_(std::move(bodies)), touches_(std::move(touches)), n_(touches_.size()) {
    for (const Touch& touch : touches_) {
      const Vec3 axes[kRows] = {touch.normal, touch.tangent, Cross(touch.normal, touch.tangent)};
      for (const Vec3& axis : axes) AddRow(touch, axis);
    }
    BuildCompressed();
    BuildByBody();
  }

  struct Result {
    std::vector<double> impulse, moment, onset, after, friction, friction_moment, slip;
    ImpactReport report;
  };

  struct Options {
    double restitution = 1;
    Dissipation dissipation = Dissipation::kBistiffness;
    double tolerance = kDefaultTolerance;
    bool by_body = false;
    bool friction = true;
  };

  Result Solve(const Options& options) {
    const double poison = std::numeric_limits<double>::quiet_NaN();
    Result result;
    for (auto* one : {&result.impulse, &result.moment, &result.onset, &result.after}) {
      one->assign(n_, poison);
    }
    for (auto* two : {&result.friction, &result.friction_moment, &result.slip}) {
      two->assign(2 * n_, poison);
    }
    const int n = static_cast<int>(n_);
    const DelassusMatrix W =
        options.by_body
            ? DelassusMatrix{n, nullptr, nullptr, nullptr, diagonal_.data(), &rows_}
            : DelassusMatrix{n, row_start_.data(), column_.data(), value_.data(), diagonal_.data()};
    CoulombFriction friction{mu_.data(), slip_.data(), nullptr, nullptr, nullptr};
    if (options.by_body) {
      friction.part = tangent_part_.data();
    } else {
      friction.block = block_.data();
      friction.work = work_.data();
    }
    const double infinity = std::numeric_limits<double>::infinity();
    ImpactProblem problem{W,
                          closing_.data(),
                          gap_.data(),
                          stiffness_.data(),
                          options.restitution,
                          options.dissipation,
                          infinity,
                          infinity,
                          options.tolerance};
    if (options.friction) problem.friction = &friction;
    std::vector<double> numbers(ImpactNumbers(n, true));
    std::vector<int> indices(ImpactIndices(n));
    ImpactSolution solution{result.impulse.data(),
                            result.moment.data(),
                            result.onset.data(),
                            result.after.data(),
                            nullptr,
                            result.friction.data(),
                            result.friction_moment.data(),
                            result.slip.data()};
    result.report = SolveImpact(problem, true, &solution, {numbers.data(), indices.data()});
    return result;
  }

  // Velocities of a body after the impact.
  std::array<double, kDofs> After(const Result& result, int body) const {
    std::array<double, kDofs> v = bodies_[body].velocity;
    for (std::size_t k = 0; k < n_; ++k) {
      const double impulse[kRows] = {result.impulse[k], result.friction[2 * k],
                                     result.friction[2 * k + 1]};
      for (int row = 0; row < kRows; ++row) {
        for (int i = 0; i < kDofs; ++i) v[i] += Answer(kRows * k + row, body, i) * impulse[row];
      }
    }
    return v;
  }

  double Energy(int body, const std::array<double, kDofs>& v) const {
    double sum = 0;
    for (int i = 0; i < kDofs; ++i) sum += v[i] * v[i] / InverseInertia(body, i) / 2;
    return sum;
  }

  double EnergyBefore() const {
    double sum = 0;
    for (std::size_t b = 0; b < bodies_.size(); ++b) sum += Energy(b, bodies_[b].velocity);
    return sum;
  }

  double EnergyAfter(const Result& result) const {
    double sum = 0;
    for (std::size_t b = 0; b < bodies_.size(); ++b) sum += Energy(b, After(result, b));
    return sum;
  }

 private:
  double InverseInertia(int body, int i) const {
    return 1 / (i < 3 ? bodies_[body].mass : bodies_[body].inertia[i - 3]);
  }
  double Row(std::size_t row, int body, int i) const {
    return jacobian_[(row * bodies_.size() + body) * kDofs + i];
  }
  double Answer(std::size_t row, int body, int i) const {
    return Row(row, body, i) * InverseInertia(body, i);
  }

  void AddRow(const Touch& touch, const Vec3& axis) {
    std::vector<double> row(kDofs * bodies_.size(), 0.0);
    for (const auto& [body, sign] : {std::pair{touch.first, -1.0}, {touch.second, 1.0}}) {
      if (body < 0) continue;
      Vec3 arm;
      for (int i = 0; i < 3; ++i) arm[i] = touch.point[i] - bodies_[body].position[i];
      const Vec3 turn = Cross(arm, axis);
      for (int i = 0; i < 3; ++i) {
        row[kDofs * body + i] = sign * axis[i];
        row[kDofs * body + 3 + i] = sign * turn[i];
      }
    }
    jacobian_.insert(jacobian_.end(), row.begin(), row.end());
  }

  double Velocity(std::size_t row) const {
    double sum = 0;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      for (int i = 0; i < kDofs; ++i) sum += Row(row, b, i) * bodies_[b].velocity[i];
    }
    return sum;
  }

  double Couple(std::size_t a, std::size_t b) const {
    double sum = 0;
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
      for (int i = 0; i < kDofs; ++i) sum += Row(a, body, i) * Answer(b, body, i);
    }
    return sum;
  }

  bool Share(const Touch& a, const Touch& b) const {
    for (const int i : {a.first, a.second}) {
      if (i >= 0 && (i == b.first || i == b.second)) return true;
    }
    return false;
  }

  void BuildCompressed() {
    row_start_.push_back(0);
    for (std::size_t k = 0; k < n_; ++k) {
      for (std::size_t l = 0; l < n_; ++l) {
        if (!Share(touches_[k], touches_[l])) continue;
        const std::size_t a = kRows * k, b = kRows * l;
        column_.push_back(static_cast<int>(l));
        value_.push_back(Couple(a, b));
        TangentBlock block;
        for (int i = 0; i < 2; ++i) {
          block.nt[i] = Couple(a, b + 1 + i);
          block.tn[i] = Couple(a + 1 + i, b);
          for (int j = 0; j < 2; ++j) block.tt[i][j] = Couple(a + 1 + i, b + 1 + j);
        }
        block_.push_back(block);
        if (k == l) diagonal_.push_back(value_.back());
      }
      row_start_.push_back(static_cast<int>(column_.size()));
      closing_.push_back(-Velocity(kRows * k));
      for (int i = 1; i < kRows; ++i) slip_.push_back(Velocity(kRows * k + i));
      mu_.push_back(touches_[k].mu);
      gap_.push_back(touches_[k].gap);
      stiffness_.push_back(1e10);
    }
    work_.resize(column_.size());
  }

  void BuildByBody() {
    const int bodies = static_cast<int>(bodies_.size());
    answers_.resize(jacobian_.size());
    for (std::size_t row = 0; row < kRows * n_; ++row) {
      for (int b = 0; b < bodies; ++b) {
        for (int i = 0; i < kDofs; ++i) {
          answers_[(row * bodies + b) * kDofs + i] = Answer(row, b, i);
        }
      }
    }
    const auto parts = [&](std::size_t row, std::vector<BodyRow>& to) {
      const Touch& touch = touches_[row / kRows];
      for (const int b : {touch.first, touch.second}) {
        if (b < 0) {
          to.push_back({-1, nullptr, nullptr});
          continue;
        }
        const std::size_t at = (row * bodies + b) * kDofs;
        to.push_back({b, jacobian_.data() + at, answers_.data() + at});
      }
    };
    for (std::size_t k = 0; k < n_; ++k) {
      parts(kRows * k, part_);
      parts(kRows * k + 1, tangent_part_);
      parts(kRows * k + 2, tangent_part_);
    }
    dof_start_.push_back(0);
    contact_start_.push_back(0);
    for (int b = 0; b < bodies; ++b) {
      dof_start_.push_back(kDofs * (b + 1));
      for (std::size_t k = 0; k < n_; ++k) {
        if (touches_[k].first == b || touches_[k].second == b) {
          contact_.push_back(static_cast<int>(k));
        }
      }
      contact_start_.push_back(static_cast<int>(contact_.size()));
    }
    body_work_.resize(3 * kDofs * bodies);
    mark_.resize(bodies);
    rows_ = {bodies,          dof_start_.data(), part_.data(), contact_start_.data(),
             contact_.data(), body_work_.data(), mark_.data()};
  }

  std::vector<FreeBody> bodies_;
  std::vector<Touch> touches_;
  std::size_t n_;
  std::vector<double> jacobian_, answers_;
  std::vector<int> row_start_, column_;
  std::vector<double> value_, diagonal_, closing_, slip_, mu_, gap_, stiffness_, work_;
  std::vector<TangentBlock> block_;
  std::vector<BodyRow> part_, tangent_part_;
  std::vector<int> dof_start_, contact_start_, contact_, mark_;
  std::vector<double> body_work_;
  BodyRows rows_{};
};

inline FreeBody Ball(double mass, double radius, const Vec3& position,
                     const std::array<double, 6>& velocity = {}) {
  const double inertia = 0.4 * mass * radius * radius;
  return {mass, {inertia, inertia, inertia}, position, velocity};
}

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_TESTS_ISLANDS_H_
