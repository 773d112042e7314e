// SPDX-License-Identifier: Apache-2.0
// Where two geoms touch, asked of MuJoCo's narrow phase wherever their bodies are now.
//
// The contact of two spheres, or of a sphere and a plane, follows from their centres all along the
// path of the bodies (contact_path.h). The points and normals of other shapes turn and jump: those
// are found again at the time of the impact.

#ifndef MUJOCO_IMPACT_ENGINE_FORESEE_NARROW_PHASE_H_
#define MUJOCO_IMPACT_ENGINE_FORESEE_NARROW_PHASE_H_

#include <mujoco/mujoco.h>

#include <cstddef>

namespace mujoco_impact::engine {

// Whether the contact of the two geoms follows from two points fixed to their bodies.
bool FollowsFromCentres(const mjModel* m, const mjContact& contact);

// Whether MuJoCo's narrow phase can be asked for the pair alone: not for height fields and signed
// distance fields, whose functions need what the middle phase knows. Their contact points stay
// those of the start of the step.
bool CanBeAsked(const mjModel* m, const mjContact& contact);

inline bool SamePair(const mjContact& a, const mjContact& b) {
  return a.geom[0] == b.geom[0] && a.geom[1] == b.geom[1];
}

// Whether the distances that MuJoCo found for contact i and those that follow it of the same pair
// are those of faces that are apart.
bool AreOfFaces(const mjModel* m, const mjData* d, int i);

// Whether the distances that MuJoCo found for the pair of contact i, the first of it, are in doubt.
// Of two geoms that are apart but near, its general algorithm may tell several points: those of
// their nearest faces, clipped, with distances that can be twice the true one. Most pairs have one.
inline bool IsDoubtful(const mjModel* m, const mjData* d, int i) {
  return i + 1 < d->ncon && SamePair(d->contact[i], d->contact[i + 1]) && d->contact[i].dist > 0 &&
         AreOfFaces(m, d, i);
}

// The most points that a pair may touch in.
constexpr int kMostPoints = mjMAXCONPAIR;

// Bytes of mjData's stack for FindPoints and the points: those of MuJoCo's general algorithm grow
// by half a kilobyte with each of its iterations.
size_t NarrowPhaseBytes(const mjModel* m);

// Finds the points in which the geoms of `like` touch or are up to `margin` [m] apart. Each is a
// copy of `like` with the distance, the place and the normal of its own. Returns their number.
//
// Of two geoms that touch along a line or a face MuJoCo's general algorithm tells one point, at one
// end of it: a push there would turn bodies that only bounce. So where it tells one, the second
// geom is tilted a little to four sides, and what is then touched first are the other ends.
int FindPoints(const mjModel* m, mjData* d, const mjContact& like, mjtNum margin,
               mjContact points[kMostPoints]);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_FORESEE_NARROW_PHASE_H_
