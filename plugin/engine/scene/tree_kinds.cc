// SPDX-License-Identifier: Apache-2.0

#include "engine/scene/tree_kinds.h"

#include <cmath>

#include "engine/common/vector3.h"

namespace mujoco_impact::engine {

ContactTrees TreesOf(const mjModel* m, const mjContact& contact) {
  return {{m->body_treeid[m->geom_bodyid[contact.geom[0]]],
           m->body_treeid[m->geom_bodyid[contact.geom[1]]]}};
}

bool IsFreeBody(const mjModel* m, int tree) {
  const int begin = m->tree_dofadr[tree];
  return m->tree_dofnum[tree] == 6 && m->jnt_type[m->dof_jntid[begin]] == mjJNT_FREE;
}

bool IsBall(const mjModel* m, int tree) {
  constexpr mjtNum kSame = 1e-9;
  if (!IsFreeBody(m, tree) || m->tree_bodynum[tree] != 1) return false;
  const int body = m->dof_bodyid[m->tree_dofadr[tree]];
  const mjtNum* inertia = m->body_inertia + 3 * body;
  // as wide as the inertia tells: the body may have no geom
  const mjtNum size = std::sqrt(inertia[0] / m->body_mass[body]);
  return std::abs(inertia[0] - inertia[1]) <= kSame * inertia[0] &&
         std::abs(inertia[0] - inertia[2]) <= kSame * inertia[0] &&
         Norm(Load(m->body_ipos + 3 * body)) <= kSame * size;
}

bool KeepsInertia(const mjModel* m, int tree) {
  if (tree < 0 || m->tree_dofnum[tree] == 1) return true;
  const int first = m->tree_dofadr[tree];
  if (IsBall(m, tree)) return true;
  for (int dof = first; dof < first + m->tree_dofnum[tree]; ++dof) {
    if (m->jnt_type[m->dof_jntid[dof]] != mjJNT_SLIDE) return false;
  }
  return true;
}

int FirstPosition(const mjModel* m, int tree) {
  return m->jnt_qposadr[m->dof_jntid[m->tree_dofadr[tree]]];
}

int PositionNumber(const mjModel* m, int tree) {
  const int last = m->dof_jntid[m->tree_dofadr[tree] + m->tree_dofnum[tree] - 1];
  const int end = last + 1 < m->njnt ? m->jnt_qposadr[last + 1] : static_cast<int>(m->nq);
  return end - FirstPosition(m, tree);
}

}  // namespace mujoco_impact::engine
