// SPDX-License-Identifier: Apache-2.0

#include "engine/foresee/narrow_phase.h"

#include <algorithm>
#include <cmath>

#include "engine/common/vector3.h"
#include "engine/path/point.h"

namespace mujoco_impact::engine {

namespace {

mjfCollision FunctionOf(const mjModel* m, const mjContact& contact) {
  return mjCOLLISIONFUNC[m->geom_type[contact.geom[0]]][m->geom_type[contact.geom[1]]];
}

bool IsCentred(const mjModel* m, int geom) {
  return IsSphere(m, geom) || m->geom_type[geom] == mjGEOM_PLANE;
}

// How far geoms are moved apart to find their normal, over the size of the smaller one.
constexpr mjtNum kShift = 1e-2;

// What counts as one touch along a line or a face, over the size of the smaller geom: the gap at
// the points of it and their distance from each other, and by which angle the geoms are tilted to
// find them [rad].
constexpr mjtNum kTouching = 1e-3, kSameGap = 1e-5, kApart = 1e-2, kTilt = 1e-5;

// Whether the pair has no function of its own.
bool IsGeneral(const mjModel* m, const mjContact& contact) {
  bool general = false;
  for (const int geom : contact.geom) {
    const int type = m->geom_type[geom];
    general = general || type == mjGEOM_MESH || type == mjGEOM_CYLINDER;
    if (type <= mjGEOM_SPHERE || type == mjGEOM_SDF) return false;
  }
  return general;
}

// Whether the narrow phase tells one point where two geoms may touch along a line or a face.
bool MayTouchAlong(const mjModel* m, const mjContact& contact) {
  const auto is_straight = [m](int geom) {
    const int type = m->geom_type[geom];
    return type == mjGEOM_CYLINDER || type == mjGEOM_MESH || type == mjGEOM_BOX ||
           type == mjGEOM_CAPSULE;
  };
  return is_straight(contact.geom[0]) && is_straight(contact.geom[1]);
}

// Of a bounded geom; a plane has none.
mjtNum SizeOf(const mjModel* m, int geom) {
  return m->geom_type[geom] == mjGEOM_PLANE ? mjMAXVAL : m->geom_rbound[geom];
}

// Curved bodies take up to about a hundred to reach rounding; the rest is reserve.
int FineIterations(const mjModel* m) { return std::max(200, m->opt.ccd_iterations); }

// The same model for a narrow phase that goes on until rounding: a normal is as good as the root of
// the tolerance. A shallow copy; the model itself is everybody's.
mjModel WithFineTolerance(const mjModel* m) {
  mjModel fine = *m;
  fine.opt.ccd_tolerance = 1e-15;
  fine.opt.ccd_iterations = FineIterations(m);
  // its further points are those of a clipped face, with the normal of the first
  fine.opt.disableflags |= mjDSBL_MULTICCD;
  return fine;
}

// MuJoCo's general algorithm finds the normal of bodies that touch less well than of those that are
// apart. Moved apart along the normal, two convex bodies keep their nearest points: so the second
// geom is asked for at a distance from where it is.
int Ask(const mjModel* m, mjData* d, const mjContact& like, mjtNum margin,
        mjContact points[kMostPoints]) {
  mjPreContact found[kMostPoints];
  mjtNum* position = d->geom_xpos + 3 * like.geom[1];
  const Vector3 place = Load(position);
  const mjtNum size = std::min(SizeOf(m, like.geom[0]), SizeOf(m, like.geom[1]));
  // a height field is not convex
  const mjtNum away = m->geom_type[like.geom[0]] == mjGEOM_HFIELD ? 0 : kShift * size;
  const Vector3 shift = away * Load(like.frame);
  Store(place + shift, position);
  const int count = std::min(kMostPoints, FunctionOf(m, like)(m, d, found, like.geom[0],
                                                              like.geom[1], margin + Norm(shift)));
  Store(place, position);
  for (int i = 0; i < count; ++i) {
    points[i] = like;
    points[i].dist = found[i].dist - Dot(Load(found[i].normal), shift);
    Store(Load(found[i].pos) - 0.5 * shift, points[i].pos);
    mju_copy3(points[i].frame, found[i].normal);
  }
  return count;
}

// A geom turned about a point for as long as the object lives.
class TurnedGeom {
 public:
  TurnedGeom(mjData* d, int geom, const Vector3& about, const Vector3& angle)
      : position_(d->geom_xpos + 3 * geom), rotation_(d->geom_xmat + 9 * geom) {
    mju_copy3(old_position_, position_);
    mju_copy(old_rotation_, rotation_, 9);
    mjtNum turn[9];
    // I + [angle]× up to the square of the angle
    const mjtNum half = -0.5 * Dot(angle, angle);
    const mjtNum a[3] = {angle.x, angle.y, angle.z};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) turn[3 * i + j] = 0.5 * a[i] * a[j];
      turn[4 * i] += 1 + half;
    }
    turn[1] -= a[2], turn[2] += a[1], turn[3] += a[2];
    turn[5] -= a[0], turn[6] -= a[1], turn[7] += a[0];
    Store(about + Rotate(turn, Load(old_position_) - about), position_);
    mju_mulMatMat(rotation_, turn, old_rotation_, 3, 3, 3);
  }
  ~TurnedGeom() {
    mju_copy3(position_, old_position_);
    mju_copy(rotation_, old_rotation_, 9);
  }
  TurnedGeom(const TurnedGeom&) = delete;
  TurnedGeom& operator=(const TurnedGeom&) = delete;

 private:
  mjtNum *position_, *rotation_;
  mjtNum old_position_[3], old_rotation_[9];
};

// Adds the point that is touched first if the second geom is tilted by `angle` about the point
// `known`, if it touches as much when the geom is turned back.
int AddEnd(const mjModel* m, mjData* d, const mjContact& known, const Vector3& angle, mjtNum margin,
           mjtNum size, mjContact* ends, int count) {
  const Vector3 first = Load(known.pos), normal = Load(known.frame);
  mjContact tilted[kMostPoints];
  {
    const TurnedGeom turned(d, known.geom[1], first, angle);
    // tilted into each other they overlap by the angle times their size
    if (Ask(m, d, known, margin + kTilt * size, tilted) < 1) return count;
  }
  mjContact& point = tilted[0];
  const Vector3 place = Load(point.pos);
  // turned back, the side of the second geom moves by −angle × arm
  const mjtNum gap = point.dist - Dot(normal, Cross(angle, place - first));
  if (std::abs(gap - known.dist) > kSameGap * size) return count;
  for (int i = 0; i < count; ++i) {
    if (Norm(place - Load(ends[i].pos)) < kApart * size) return count;
  }
  ends[count] = known;
  ends[count].dist = gap;
  Store(place + Dot(normal, first - place) * normal, ends[count].pos);
  return count + 1;
}

// Copies the two points that are farthest from each other, and those that are not on the line
// between them: what lies between is carried by the ends. Returns their number.
int KeepOuter(const mjContact* ends, int number, mjtNum apart, mjContact* points) {
  int first = 0, second = 1;
  const auto between = [ends](int i, int j) { return Load(ends[j].pos) - Load(ends[i].pos); };
  for (int i = 0; i < number; ++i) {
    for (int j = i + 1; j < number; ++j) {
      if (Norm(between(i, j)) <= Norm(between(first, second))) continue;
      first = i;
      second = j;
    }
  }
  points[0] = ends[first];
  points[1] = ends[second];
  const Vector3 line = UnitOr(between(first, second), {});
  int count = 2;
  for (int i = 0; i < number; ++i) {
    if (i == first || i == second || Norm(Cross(line, between(first, i))) < apart) continue;
    points[count++] = ends[i];
  }
  return count;
}

}  // namespace

bool FollowsFromCentres(const mjModel* m, const mjContact& contact) {
  return IsCentred(m, contact.geom[0]) && IsCentred(m, contact.geom[1]);
}

bool CanBeAsked(const mjModel* m, const mjContact& contact) {
  for (const int geom : contact.geom) {
    const int type = m->geom_type[geom];
    if (type == mjGEOM_SDF) return false;
  }
  return FunctionOf(m, contact) != nullptr;
}

size_t NarrowPhaseBytes(const mjModel* m) {
  constexpr size_t kIteration = 512, kRest = 4096;
  return kMostPoints * sizeof(mjContact) + kIteration * FineIterations(m) + kRest;
}

bool AreOfFaces(const mjModel* m, const mjData* d, int i) {
  const mjContact& contact = d->contact[i];
  if (contact.geom[0] < 0 || contact.geom[1] < 0 || !IsGeneral(m, contact)) return false;
  if (i > 0 && SamePair(d->contact[i - 1], contact)) return false;
  for (int j = i; j < d->ncon && SamePair(d->contact[j], contact); ++j) {
    if (d->contact[j].dist <= 0) return false;
  }
  return true;
}

int FindPoints(const mjModel* model, mjData* d, const mjContact& like, mjtNum margin,
               mjContact points[kMostPoints]) {
  const mjModel fine = WithFineTolerance(model);
  const mjModel* m = &fine;
  int count = Ask(m, d, like, margin, points);
  if (count != 1 || !MayTouchAlong(m, like)) return count;
  const mjtNum size = std::min(SizeOf(m, like.geom[0]), SizeOf(m, like.geom[1]));
  if (std::abs(points[0].dist) > kTouching * size) return count;
  const Vector3 normal = Load(points[0].frame);
  const Vector3 across =
      UnitOr(Cross(normal, std::abs(normal.x) < 0.5 ? Vector3{1, 0, 0} : Vector3{0, 1, 0}), normal);
  mjContact ends[4];
  int number = 0;
  for (const Vector3& axis : {across, Cross(normal, across)}) {
    for (const mjtNum angle : {kTilt, -kTilt}) {
      number = AddEnd(m, d, points[0], angle * axis, margin, size, ends, number);
    }
  }
  if (number < 2) return count;
  return KeepOuter(ends, number, kApart * size, points);
}

}  // namespace mujoco_impact::engine
