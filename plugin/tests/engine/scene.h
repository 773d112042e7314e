// SPDX-License-Identifier: Apache-2.0
// A compiled scene in some state, for the tests of the engine layer.

#ifndef MUJOCO_IMPACT_TESTS_ENGINE_SCENE_H_
#define MUJOCO_IMPACT_TESTS_ENGINE_SCENE_H_

#include <mujoco/mujoco.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/plugin.h"

namespace mujoco_impact::engine {

using Numbers = std::vector<mjtNum>;

// `count` numbers of mixed signs between −1 and 1, the same in every run.
inline Numbers Mixed(int count, double seed) {
  Numbers numbers;
  for (int i = 0; i < count; ++i) numbers.push_back(std::sin(seed + 2.7 * i * i + 1.3 * i));
  return numbers;
}

class Scene {
 public:
  // At qpos0, forward computed. Throws what MuJoCo says of a scene that does not compile.
  explicit Scene(const std::string& xml) {
    static const bool registered = (RegisterPlugin(), true);
    (void)registered;
    char error[1000] = "";
    mjSpec* spec = mj_parseXMLString(xml.c_str(), nullptr, error, sizeof(error));
    if (!spec) throw std::runtime_error(error);
    model_ = mj_compile(spec, nullptr);
    if (!model_) throw std::runtime_error(mjs_getError(spec));
    mj_deleteSpec(spec);
    data_ = mj_makeData(model_);
    mj_forward(model_, data_);
  }

  ~Scene() {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }

  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  mjModel* m() { return model_; }
  mjData* d() { return data_; }

  // qpos ⊕ s u, without computing anything.
  void Displace(const mjtNum* u, mjtNum s) { mj_integratePos(model_, data_->qpos, u, s); }

  // Away from qpos0, where much is zero, and in motion.
  void Disturb() {
    Displace(Mixed(Dofs(), 0.3).data(), 0.4);
    mju_copy(data_->qvel, Mixed(Dofs(), 1.1).data(), Dofs());
    mj_forward(model_, data_);
  }

  int Dofs() const { return static_cast<int>(model_->nv); }

 private:
  mjModel* model_;
  mjData* data_;
};

}  // namespace mujoco_impact::engine

#endif  // MUJOCO_IMPACT_TESTS_ENGINE_SCENE_H_
