// SPDX-License-Identifier: Apache-2.0
// Vectors of three numbers by value: inlined, where MuJoCo's functions would each cost a call.

#ifndef MUJOCO_IMPACT_ENGINE_COMMON_VECTOR3_H_
#define MUJOCO_IMPACT_ENGINE_COMMON_VECTOR3_H_

#include <mujoco/mujoco.h>

#include <cmath>

namespace mujoco_impact::engine {

struct Vector3 {
  mjtNum x, y, z;
};

inline Vector3 Load(const mjtNum* v) { return {v[0], v[1], v[2]}; }

inline void Store(const Vector3& v, mjtNum* to) {
  to[0] = v.x;
  to[1] = v.y;
  to[2] = v.z;
}

inline Vector3 operator+(const Vector3& a, const Vector3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

inline Vector3 operator-(const Vector3& a, const Vector3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

inline Vector3 operator*(mjtNum s, const Vector3& a) { return {s * a.x, s * a.y, s * a.z}; }

inline Vector3& operator+=(Vector3& a, const Vector3& b) { return a = a + b; }

inline mjtNum Dot(const Vector3& a, const Vector3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

inline Vector3 Cross(const Vector3& a, const Vector3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline mjtNum Norm(const Vector3& a) { return std::sqrt(Dot(a, a)); }

// a / |a|, or `otherwise` for a vector without a direction.
inline Vector3 UnitOr(const Vector3& a, const Vector3& otherwise) {
  const mjtNum length = Norm(a);
  return length < mjMINVAL ? otherwise : 1 / length * a;
}

// R v and Rᵀ v of a rotation matrix in rows.
inline Vector3 Rotate(const mjtNum* R, const Vector3& v) {
  return {Dot(Load(R), v), Dot(Load(R + 3), v), Dot(Load(R + 6), v)};
}

inline Vector3 RotateBack(const mjtNum* R, const Vector3& v) {
  return v.x * Load(R) + v.y * Load(R + 3) + v.z * Load(R + 6);
}

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_COMMON_VECTOR3_H_
