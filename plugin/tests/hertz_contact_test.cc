// SPDX-License-Identifier: Apache-2.0

#include "law/hertz_contact.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mujoco_impact::law {
namespace {

constexpr double kMass = 0.0575, kStiffness = 1.269e10, kSpeed = 0.5;

TEST(HertzContact, CompressionStoresTheKineticEnergy) {
  const double y = MaximumCompression(kStiffness, kMass, kSpeed);
  // 2/5 K y^2.5 = 1/2 mu u^2, to rounding of pow
  EXPECT_NEAR(0.4 * kStiffness * std::pow(y, 2.5) / (0.5 * kMass * kSpeed * kSpeed), 1, 1e-13);
}

TEST(HertzContact, ContactTimeIsTheQuadratureOfTheEnergyEquation) {
  // T = 2 y/u int_0^1 dx / sqrt(1 - x^2.5); x = 1 - s^2 takes the pole away, then midpoints,
  // whose error with 1e5 cells is of the order 1e-10
  const int cells = 100000;
  double sum = 0;
  for (int i = 0; i < cells; ++i) {
    const double s = (i + 0.5) / cells;
    sum += 2 * s / std::sqrt(1 - std::pow(1 - s * s, 2.5)) / cells;
  }
  const double y = MaximumCompression(kStiffness, kMass, kSpeed);
  EXPECT_NEAR(ContactTime(kStiffness, kMass, kSpeed) / (2 * y / kSpeed * sum), 1, 1e-9);
}

TEST(HertzContact, StiffnessOfTwoSteelBallsOfThirtyMillimetres) {
  // K = 4/3 E* sqrt(R*) with E* = E / (2 (1 - nu^2)) and R* = r/2
  const double modulus = EffectiveModulus(2e11, 0.3);
  const double expected = 4.0 / 3 * (2e11 / (2 * 0.91)) * std::sqrt(0.0075);
  EXPECT_NEAR(HertzStiffness(modulus, 2 / 0.015) / expected, 1, 1e-14);
}

TEST(HertzContact, OfTwoMaterialsTheSofterDecides) {
  const double steel = Compliance(2e11, 0.3), rubber = Compliance(2e6, 0.5);
  // a part of 1e-5 of the work goes into the steel
  EXPECT_NEAR(CompositeRestitution(0.9, steel, 0.5, rubber), 0.5, 1e-5);
  EXPECT_EQ(CompositeRestitution(0.9, steel, 0.5, rubber),
            CompositeRestitution(0.5, rubber, 0.9, steel));
}

TEST(HertzContact, EachBodyGivesBackItsPartOfTheWork) {
  // of three quarters of the work .64 comes back, of a quarter .16: to rounding
  EXPECT_NEAR(CompositeRestitution(0.8, 3e-11, 0.4, 1e-11), std::sqrt(0.75 * 0.64 + 0.25 * 0.16),
              1e-15);
}

TEST(HertzContact, TwoOfOneMaterialAreThatMaterial) {
  EXPECT_NEAR(2 * Compliance(2e11, 0.3) * EffectiveModulus(2e11, 0.3), 1, 1e-15);
  EXPECT_EQ(CompositeRestitution(0.7, 1e-11, 0.7, 3e-11), 0.7);
}

}  // namespace
}  // namespace mujoco_impact::law
