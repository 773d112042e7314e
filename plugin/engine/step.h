// SPDX-License-Identifier: Apache-2.0
// One step of an instance, from contacts to forces: gather, islands, law, waveform, apply.

#ifndef MUJOCO_IMPACT_ENGINE_STEP_H_
#define MUJOCO_IMPACT_ENGINE_STEP_H_

#include <mujoco/mujoco.h>

namespace mujoco_impact::engine {

// Computes the forces of the step that starts at the state in `d`, adds them to qfrc_passive and
// leaves what `CommitStep` needs pending. Idempotent: a pure function of model and state.
void ComputeStep(const mjModel* m, mjData* d, int instance);

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_STEP_H_
