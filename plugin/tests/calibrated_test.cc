// SPDX-License-Identifier: Apache-2.0

#include "law/calibrated.h"

#include <gtest/gtest.h>

#include <numbers>

namespace mujoco_impact::law {
namespace {

TEST(Calibrated, ImpulseIsEquationSixByHand) {
  // row A-A-A of table 3: S_h = 191.5, S_w = .487; p = .115 kg * .49 m/s
  const double p = 0.05635;
  const double W = 7.5e-3 + 0.083 * 0.487 / 0.05635 * 1e-3;
  const CalibratedWaveform waveform{191.5, 0.487, 7.5e-3, 0.083};
  EXPECT_NEAR(CalibratedDuration(waveform, p), W, 1e-17);
  EXPECT_NEAR(CalibratedImpulse(waveform, p), 2 / std::numbers::pi * 191.5 * p * W, 1e-16);
}

TEST(Calibrated, TouchAtNoSpeedStillGivesAnImpulse) {
  // P(p -> 0) = (2/pi) S_h kappa S_w 1e-3: the energy that equation (6) injects
  const CalibratedWaveform waveform{191.5, 0.487, 7.5e-3, 1};
  EXPECT_NEAR(CalibratedImpulse(waveform, 1e-9), 2 / std::numbers::pi * 191.5 * 0.487e-3, 1e-8);
}

}  // namespace
}  // namespace mujoco_impact::law
