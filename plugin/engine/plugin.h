// SPDX-License-Identifier: Apache-2.0
// The plugin `mujoco_impact.waveform` as MuJoCo sees it.
//
// Passive forces and a sensor. plugin_data stays null: everything that evolves is in plugin_state,
// so copies, pickles, restored states and threads need no care.

#ifndef MUJOCO_IMPACT_ENGINE_PLUGIN_H_
#define MUJOCO_IMPACT_ENGINE_PLUGIN_H_

namespace mujoco_impact::engine {

constexpr char kPluginName[] = "mujoco_impact.waveform";

void RegisterPlugin();

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_ENGINE_PLUGIN_H_
