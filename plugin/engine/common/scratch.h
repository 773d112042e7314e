// SPDX-License-Identifier: Apache-2.0
// Memory for one step, from the stack of mjData: no heap in the hot path.

#ifndef MUJOCO_IMPACT_ENGINE_COMMON_SCRATCH_H_
#define MUJOCO_IMPACT_ENGINE_COMMON_SCRATCH_H_

#include <mujoco/mujoco.h>

#include <cstddef>

namespace mujoco_impact::engine {

class Scratch {
 public:
  explicit Scratch(mjData* d) : d_(d) { mj_markStack(d_); }
  ~Scratch() { mj_freeStack(d_); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  template <typename T>
  T* Take(size_t count) {
    return static_cast<T*>(mj_stackAllocByte(d_, (count ? count : 1) * sizeof(T), alignof(T)));
  }

  // Zeroed.
  mjtNum* Zeros(int count) {
    mjtNum* numbers = Take<mjtNum>(count);
    mju_zero(numbers, count);
    return numbers;
  }

  // MuJoCo ends the process when its stack overflows, so big requests ask first.
  bool Fits(size_t bytes) const {
    constexpr size_t kReserve = 1 << 14;
    return d_->pstack + d_->parena + bytes + kReserve < static_cast<size_t>(d_->narena);
  }

 private:
  mjData* d_;
};

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_COMMON_SCRATCH_H_
