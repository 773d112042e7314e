// SPDX-License-Identifier: Apache-2.0

#include "law/waveform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace mujoco_impact::law {
namespace {

class Waveform : public testing::TestWithParam<double> {};

// The shape as the header states it, of unit area and duration: H = pi/2.
double Force(double t, double e) {
  const double half_pi = std::numbers::pi / 2, rise = 1 / (1 + e), fall = e / (1 + e);
  if (t < rise) return half_pi * std::sin(half_pi * t / rise);
  return half_pi * std::cos(half_pi * (t - rise) / fall);
}

TEST_P(Waveform, CumulativeAndMomentAreTheIntegralsOfTheShape) {
  const double e = GetParam();
  const int cells = 20000;
  double area = 0, moment = 0;
  for (int i = 0; i < cells; ++i) {
    // midpoints: error of the order of the cell squared, at the kink of the cell
    const double t = (i + 0.5) / cells;
    area += Force(t, e) / cells;
    moment += t * Force(t, e) / cells;
    ASSERT_NEAR(WaveformForce(t, e), Force(t, e), 1e-14) << "at t = " << t;
    const double end = (i + 1.0) / cells;
    ASSERT_NEAR(WaveformCumulative(end, e), area, 1e-4) << "at t = " << end;
    ASSERT_NEAR(WaveformMoment(end, e), moment, 1e-4) << "at t = " << end;
  }
}

TEST_P(Waveform, ExpansionOverCompressionIsTheRestitution) {
  const double e = GetParam();
  const double compression = WaveformCumulative(1 / (1 + e), e);
  EXPECT_NEAR((1 - compression) / compression, e, 1e-14);
}

TEST_P(Waveform, DeliversNothingBeforeAndAllAfter) {
  const double e = GetParam();
  EXPECT_EQ(WaveformCumulative(-0.5, e), 0);
  EXPECT_EQ(WaveformCumulative(1, e), 1);
  EXPECT_EQ(WaveformCumulative(7, e), 1);
  EXPECT_EQ(WaveformForce(-0.5, e), 0);
  EXPECT_EQ(WaveformForce(1.5, e), 0);
  EXPECT_EQ(WaveformMoment(1, e), WaveformMoment(7, e));
}

TEST_P(Waveform, HeightAndImpulseAreInverse) {
  EXPECT_DOUBLE_EQ(WaveformHeight(WaveformImpulse(12.5, 7.5e-3), 7.5e-3), 12.5);
}

INSTANTIATE_TEST_SUITE_P(Restitution, Waveform, testing::Values(0.0, 0.1, 0.5, 0.9, 1.0));

TEST(WaveformLimits, ElasticPulseIsSymmetric) {
  for (double t = 0; t <= 0.5; t += 0.01) {
    EXPECT_NEAR(WaveformCumulative(t, 1), 1 - WaveformCumulative(1 - t, 1), 1e-15);
  }
  EXPECT_NEAR(WaveformMoment(1, 1), 0.5, 1e-15);
}

}  // namespace
}  // namespace mujoco_impact::law
