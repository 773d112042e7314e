// SPDX-License-Identifier: Apache-2.0

#include "engine/scene/softness.h"

#include <algorithm>
#include <cmath>

namespace mujoco_impact::engine {

namespace {

// The impedance d by solimp, at the violation of the constraint.
mjtNum Impedance(const mjtNum* solimp, mjtNum violation) {
  const mjtNum x = std::min<mjtNum>(1, std::abs(violation) / std::max(mjMINVAL, solimp[2]));
  const mjtNum midpoint = solimp[3], power = solimp[4];
  // y = x^p / m^(p−1) up to the midpoint m, and the same turned by half a circle above
  const mjtNum y = x <= midpoint ? std::pow(x, power) / std::pow(midpoint, power - 1)
                                 : 1 - std::pow(1 - x, power) / std::pow(1 - midpoint, power - 1);
  return std::clamp<mjtNum>(solimp[0] + y * (solimp[1] - solimp[0]), mjMINIMP, mjMAXIMP);
}

bool HasRowsTogether(const mjModel* m, int id) {
  return m->eq_type[id] == mjEQ_CONNECT || m->eq_type[id] == mjEQ_WELD;
}

// Row i among those of its constraint.
int Place(const mjData* d, int i) {
  int place = 0;
  while (place < i && d->efc_id[i - place - 1] == d->efc_id[i]) ++place;
  return place;
}

// How far the constraint of row i is violated: all rows of a `connect` or `weld` together.
mjtNum Violation(const mjModel* m, const mjData* d, int i) {
  if (!HasRowsTogether(m, d->efc_id[i])) return d->efc_pos[i] - d->efc_margin[i];
  mjtNum sum = 0;
  for (int j = i - Place(d, i); j < d->ne && d->efc_id[j] == d->efc_id[i]; ++j) {
    const mjtNum violation = d->efc_pos[j] - d->efc_margin[j];
    sum += violation * violation;
  }
  return std::sqrt(sum);
}

// A_ii as MuJoCo estimates it, from the inertia in qpos0; `exact` where it does not.
mjtNum Estimate(const mjModel* m, const mjData* d, int i, mjtNum exact) {
  if (m->opt.enableflags & mjENBL_DIAGEXACT) return exact;
  const int id = d->efc_id[i], first = m->eq_obj1id[id], second = m->eq_obj2id[id];
  const auto both = [](const mjtNum* weight, int a, int b) {
    return weight[a] + (b >= 0 ? weight[b] : 0);
  };
  if (HasRowsTogether(m, id)) {
    const bool sites = m->eq_objtype[id] == mjOBJ_SITE;
    const int rotation = Place(d, i) < 3 ? 0 : 1;
    return both(m->body_invweight0 + rotation, 2 * (sites ? m->site_bodyid[first] : first),
                2 * (sites ? m->site_bodyid[second] : second));
  }
  if (m->eq_type[id] == mjEQ_JOINT) {
    return both(m->dof_invweight0, m->jnt_dofadr[first], second < 0 ? -1 : m->jnt_dofadr[second]);
  }
  return m->eq_type[id] == mjEQ_TENDON ? both(m->tendon_invweight0, first, second) : exact;
}

// k/d, b and d of a row, as MuJoCo keeps them, and R, for the integrator `discrete`.
void MakeRow(const mjModel* m, mjData* d, int i, mjtNum exact) {
  const mjtNum* solimp = m->eq_solimp + mjNIMP * d->efc_id[i];
  const mjtNum* solref = m->eq_solref + mjNREF * d->efc_id[i];
  const mjtNum impedance = Impedance(solimp, Violation(m, d, i));
  const mjtNum most = std::clamp<mjtNum>(solimp[1], mjMINIMP, mjMAXIMP);
  mjtNum* KBI = d->efc_KBIP + 4 * i;
  if (solref[0] > 0) {
    const mjtNum time = solref[0], ratio = solref[1];
    KBI[0] = 1 / std::max<mjtNum>(mjMINVAL, most * most * time * time * ratio * ratio);
    KBI[1] = 2 / std::max<mjtNum>(mjMINVAL, most * time);
  } else {
    KBI[0] = -solref[0] / (most * most);
    KBI[1] = -solref[1] / most;
  }
  KBI[2] = impedance;
  const mjtNum h = m->opt.timestep, s = 1 + h * KBI[1] + h * h * KBI[0] * impedance;
  // not 0 for a row without effect, of which A_ii = 0
  const mjtNum A = std::max<mjtNum>(mjMINVAL, Estimate(m, d, i, exact));
  d->efc_R[i] = std::max<mjtNum>(mjMINVAL, (1 - impedance) / impedance * A / s);
}

}  // namespace

void MakeReferences(const mjModel* m, mjData* d, const mjtNum* A) {
  if (m->opt.integrator == mjINT_DISCRETE) {
    for (int i = 0; i < d->ne; ++i) MakeRow(m, d, i, A[i * (d->ne + 1)]);
  }
  // equality constraints come first: of the rows behind them `discrete` has not made anything yet
  const auto rows = d->nefc;
  d->nefc = d->ne;
  mj_referenceConstraint(m, d);
  d->nefc = rows;
}

}  // namespace mujoco_impact::engine
