// SPDX-License-Identifier: Apache-2.0
// Two numbers at a time: the vector type that every x86-64 and arm64 processor has.
//
// Element by element the arithmetic is that of double, so results do not depend on it.

#ifndef MUJOCO_IMPACT_LAW_PAIR_H_
#define MUJOCO_IMPACT_LAW_PAIR_H_

#include <cmath>

namespace mujoco_impact::law {

using Pair = double __attribute__((vector_size(16)));

// The pair of numbers that begins at x, wherever that is.
inline Pair At(const double* x) { return Pair{x[0], x[1]}; }

inline void Put(double* x, Pair pair) {
  x[0] = pair[0];
  x[1] = pair[1];
}

inline Pair Max(Pair a, Pair b) { return a > b ? a : b; }
inline Pair Abs(Pair a) { return Max(a, -a); }
inline Pair Sqrt(Pair a) { return Pair{std::sqrt(a[0]), std::sqrt(a[1])}; }
inline double Larger(Pair a) { return a[0] > a[1] ? a[0] : a[1]; }

}  // namespace mujoco_impact::law

#endif  // MUJOCO_IMPACT_LAW_PAIR_H_
