// SPDX-License-Identifier: Apache-2.0

#include "engine/scene/contact_stiffness.h"

#include <gtest/gtest.h>

#include "engine/common/vector3.h"
#include "tests/engine/scene.h"

namespace mujoco_impact::engine {
namespace {

// Geoms in some orientation, none where another is.
constexpr char kShapes[] = R"(
<mujoco>
  <asset>
    <mesh name="brick" vertex="-1 -2 -3  1 -2 -3  -1 2 -3  1 2 -3  -1 -2 3  1 -2 3  -1 2 3  1 2 3"/>
  </asset>
  <worldbody>
    <geom name="plane" type="plane" size="9 9 .1" euler="20 30 40"/>
    <body euler="10 50 -70">
      <freejoint/>
      <geom name="sphere" size=".2" mass="1"/>
      <geom name="capsule" type="capsule" size=".2 .5" mass="1" euler="3 4 5"/>
      <geom name="cylinder" type="cylinder" size=".2 .5" mass="1" euler="-30 4 5"/>
      <geom name="ellipsoid" type="ellipsoid" size=".2 .3 .5" mass="1" euler="40 4 5"/>
      <geom name="box" type="box" size=".2 .3 .5" mass="1" euler="3 80 5"/>
      <geom name="small" type="box" size=".02 .03 .05" mass="1" euler="3 80 5"/>
      <geom name="mesh" type="mesh" mesh="brick" mass="1" euler="15 25 35"/>
    </body>
  </worldbody>
</mujoco>)";

class Shapes : public testing::Test {
 protected:
  Shapes() : scene_(kShapes) { scene_.Disturb(); }

  int Id(const char* name) { return mj_name2id(scene_.m(), mjOBJ_GEOM, name); }

  // Of the geom on a plane that it touches with `local` outward, in the frame of the geom.
  mjtNum OnPlane(const char* name, const Vector3& local) {
    const Vector3 unit = 1 / Norm(local) * local;
    return Between(name, "plane", Rotate(scene_.d()->geom_xmat + 9 * Id(name), unit));
  }

  mjtNum Between(const char* first, const char* second, const Vector3& normal) {
    mjContact contact{};
    contact.geom[0] = Id(first);
    contact.geom[1] = Id(second);
    Store(normal, contact.frame);
    return ContactCurvature(scene_.m(), scene_.d(), contact);
  }

  mjtNum Bound(const char* name) { return scene_.m()->geom_rbound[Id(name)]; }

  Scene scene_;
};

constexpr mjtNum kRounding = 1e-9;

TEST_F(Shapes, RoundOnesHaveTheirRadius) {
  for (const Vector3& n : {Vector3{0, 0, 1}, {1, 0, 0}, {0.3, -0.5, 0.7}}) {
    EXPECT_NEAR(OnPlane("sphere", n), 5, kRounding);
    EXPECT_NEAR(OnPlane("capsule", n), 5, kRounding);
  }
  EXPECT_NEAR(OnPlane("cylinder", {0.6, -0.8, 0}), 5, kRounding);
}

TEST_F(Shapes, CurvaturesOfBothSidesAdd) {
  EXPECT_NEAR(Between("sphere", "capsule", {0, 0, 1}), 10, kRounding);
}

// The principal radii at the end of the axis c are a²/c and b²/c.
TEST_F(Shapes, AnEllipsoidHasItsPrincipalRadiiAtItsPoles) {
  EXPECT_NEAR(OnPlane("ellipsoid", {1, 0, 0}), .2 / (.3 * .5), kRounding);
  EXPECT_NEAR(OnPlane("ellipsoid", {0, -1, 0}), .3 / (.2 * .5), kRounding);
  EXPECT_NEAR(OnPlane("ellipsoid", {0, 0, 1}), .5 / (.2 * .3), kRounding);
}

// R′R″ is how much larger the piece of surface is than the piece of the unit sphere that its
// normals cover.
TEST_F(Shapes, AnEllipsoidHasItsPrincipalRadiiAnywhere) {
  const auto point = [](const Vector3& n) {  // where the normal is n
    const Vector3 a2n{.04 * n.x, .09 * n.y, .25 * n.z};
    return 1 / std::sqrt(Dot(a2n, n)) * a2n;
  };
  const Vector3 n{0.48, -0.6, 0.64}, t1 = UnitOr(Cross(n, {1, 0, 0}), n), t2 = Cross(n, t1);
  const mjtNum s = 1e-5;
  const Vector3 along1 = 1 / (2 * s) * (point(n + s * t1) - point(n - s * t1));
  const Vector3 along2 = 1 / (2 * s) * (point(n + s * t2) - point(n - s * t2));
  const mjtNum radii = Norm(Cross(along1, along2));
  EXPECT_NEAR(OnPlane("ellipsoid", n) * std::sqrt(radii), 1, 1e-8);
}

TEST_F(Shapes, FacesAreFlatAndEdgesAreRounded) {
  // flat on flat: as a sphere of the size of the body
  EXPECT_NEAR(OnPlane("box", {0, -1, 0}), 1 / Bound("box"), kRounding);
  EXPECT_NEAR(OnPlane("cylinder", {0, 0, -1}), 1 / Bound("cylinder"), kRounding);
  // a twentieth of the smallest half-size
  EXPECT_NEAR(OnPlane("box", {0, 1, 1}), 100, kRounding);
  EXPECT_NEAR(OnPlane("box", {1, -1, 1}), 100, kRounding);
  EXPECT_NEAR(OnPlane("cylinder", {1, 0, 1}), 100, kRounding);
}

TEST_F(Shapes, AMeshHasTheFacesOfItsHull) {
  // the frame of a mesh geom is that of its inertia: longest axis first or last, never skew
  int flat = 0;
  for (const Vector3& n : {Vector3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}}) {
    flat += std::abs(OnPlane("mesh", n) - 1 / Bound("mesh")) < kRounding;
  }
  EXPECT_EQ(flat, 4);
  EXPECT_NEAR(OnPlane("mesh", {0, 1, 1}), 20, kRounding);
  EXPECT_NEAR(OnPlane("mesh", {1, 1, 1}), 20, kRounding);
}

TEST_F(Shapes, FlatOnFlatIsOfTheSizeOfTheSmaller) {
  const Vector3 face = Rotate(scene_.d()->geom_xmat + 9 * Id("box"), {0, 0, 1});
  EXPECT_NEAR(Between("box", "small", face), 1 / Bound("small"), kRounding);
  EXPECT_NEAR(Between("small", "box", face), 1 / Bound("small"), kRounding);
  // a corner on a face
  const Vector3 corner = Rotate(scene_.d()->geom_xmat + 9 * Id("box"), UnitOr({1, 1, 1}, {}));
  EXPECT_NEAR(Between("box", "plane", corner), 100, kRounding);
}

}  // namespace
}  // namespace mujoco_impact::engine
