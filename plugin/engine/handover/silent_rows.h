// SPDX-License-Identifier: Apache-2.0
// Rows of MuJoCo's solver that are told that their bodies are apart.
//
// Passive forces are computed after the rows are made and before their references are, so a row can
// be told then.

#ifndef MUJOCO_IMPACT_ENGINE_HANDOVER_SILENT_ROWS_H_
#define MUJOCO_IMPACT_ENGINE_HANDOVER_SILENT_ROWS_H_

#include <mujoco/mujoco.h>

namespace mujoco_impact::engine {

// Makes the solver see the limits of a joint or a tendon as not reached.
void SilenceLimit(mjData* d, bool tendon, int id);

// Makes the solver see the contact with this index as open, however fast it closes.
void Silence(mjData* d, int contact);

// Whether that was done.
bool IsSilent(const mjData* d, const mjContact& contact);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_HANDOVER_SILENT_ROWS_H_
