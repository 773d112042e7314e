// SPDX-License-Identifier: Apache-2.0

#include "engine/path/inertia_there.h"

namespace mujoco_impact::engine {

InertiaThere::InertiaThere(const mjModel* m, mjData* d, Scratch& scratch)
    : m_(m),
      d_(d),
      crb_(scratch.Take<mjtNum>(10 * m->nbody)),
      M_(scratch.Take<mjtNum>(m->nC)),
      qLD_(scratch.Take<mjtNum>(m->nC)),
      qLDiagInv_(scratch.Take<mjtNum>(m->nv)) {
  mju_copy(crb_, d->crb, 10 * m->nbody);
  mju_copy(M_, d->M, m->nC);
  mju_copy(qLD_, d->qLD, m->nC);
  mju_copy(qLDiagInv_, d->qLDiagInv, m->nv);
  mj_makeM(m, d);
  mj_factorM(m, d);
}

InertiaThere::~InertiaThere() {
  mju_copy(d_->crb, crb_, 10 * m_->nbody);
  mju_copy(d_->M, M_, m_->nC);
  mju_copy(d_->qLD, qLD_, m_->nC);
  mju_copy(d_->qLDiagInv, qLDiagInv_, m_->nv);
}

}  // namespace mujoco_impact::engine
