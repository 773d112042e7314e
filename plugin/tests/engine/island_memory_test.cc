// SPDX-License-Identifier: Apache-2.0
// MuJoCo ends the process when its stack overflows, so what an impact takes of it must be known
// before.

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "engine/foresee/gather.h"
#include "engine/island/island_system.h"
#include "engine/island/tangents.h"
#include "engine/resolve/budget.h"
#include "engine/resolve/friction.h"
#include "engine/resolve/resolve.h"
#include "engine/state/state.h"
#include "tests/engine/scene.h"

namespace mujoco_impact::engine {
namespace {

// A block of a × b × c balls, a hair apart; the first is shot into it.
struct Block {
  std::string name;
  int a, b, c;
  std::string joint, config;
  mjtNum gap;  // within which contacts are seen [m]
  bool tied = false;
};

void PrintTo(const Block& block, std::ostream* out) { *out << block.name; }

constexpr char kSlide[] = "<joint type='slide' axis='1 0 0'/>", kFree[] = "<freejoint/>";

std::string Xml(const Block& block) {
  std::string bodies, ties;
  for (int i = 0; i < block.a * block.b * block.c; ++i) {
    const int x = i / (block.b * block.c), y = i / block.c % block.b, z = i % block.c;
    const auto at = [](int k) { return std::to_string(0.0201 * k); };
    bodies += "<body name='" + std::to_string(i) + "' pos='" + at(x) + " " + at(y) + " " + at(z) +
              "'>" + block.joint + "<geom size='.01' mass='.1'/></body>";
    if (block.tied && i % 3 == 2) {
      ties += "<weld body1='" + std::to_string(i) + "' body2='" + std::to_string(i - 1) + "'/>";
    }
  }
  return "<mujoco><size memory='64M'/><option timestep='.001' gravity='0 0 0'/><extension>"
         "<plugin plugin='mujoco_impact.waveform'><instance name='impact'>" +
         block.config + "</instance></plugin></extension><default><geom margin='-.0001' gap='" +
         std::to_string(block.gap) + "'/></default><worldbody>" + bodies +
         "</worldbody><equality>" + ties +
         "</equality><sensor><plugin name='impact' plugin='mujoco_impact.waveform'"
         " instance='impact'/></sensor></mujoco>";
}

class IslandMemory : public testing::TestWithParam<Block> {};

const std::string kNone,
    kFriction =
        "<config key='friction' value='paper'/><config key='mu_s' "
        "value='.2'/><config key='mu_d' value='.1'/>",
    kViscous =
        "<config key='restitution' value='.8'/><config key='dissipation' "
        "value='viscous'/>",
    kLong = "<config key='duration' value='.002'/>",
    kCalibrated =
        "<config key='law' value='calibrated'/><config key='sh' value='300'/>"
        "<config key='alpha' value='1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1'/>";

INSTANTIATE_TEST_SUITE_P(
    Blocks, IslandMemory,
    testing::Values(Block{"pair", 2, 1, 1, kSlide, kNone, .01},
                    Block{"row", 60, 1, 1, kSlide, kNone, .01},
                    Block{"row of free balls", 60, 1, 1, kFree, kNone, .01},
                    Block{"row with losses", 60, 1, 1, kSlide, kViscous, .01},
                    Block{"row with friction", 40, 1, 1, kFree, kFriction, .01},
                    Block{"long pulses", 5, 3, 3, kFree, kLong, .01},
                    Block{"crowd", 5, 4, 3, kFree, kNone, .02},
                    Block{"crowd with friction", 4, 3, 3, kFree, kFriction, .02},
                    Block{"calibrated", 20, 1, 1, kSlide, kCalibrated, .01},
                    Block{"tied", 5, 3, 3, kFree, kNone, .01, true}),
    [](const auto& test) {
      std::string name = test.param.name;
      for (char& c : name) c = c == ' ' ? '_' : c;
      return name;
    });

// All contacts of the scene, the first that closes at the front.
TEST_P(IslandMemory, AnIslandTakesNoMoreThanItAsksFor) {
  Scene scene(Xml(GetParam()));
  mjModel* m = scene.m();
  mjData* d = scene.d();
  d->qvel[0] = 3;
  mj_forward(m, d);
  // of the plugin itself, which has run, and nothing else
  mju_zero(d->qfrc_passive, scene.Dofs());

  Scratch scratch(d);
  const Mobility mobility(m, d, scratch);
  const Delivery delivery = MakeDelivery(m, scratch);
  const Ownership ownership(m, 0);
  const Config config = ReadConfig(m, 0, ownership.size(), nullptr);
  const Materials materials(m, 0, config, scratch);
  const Outlook outlook = LookAhead(m, d, mobility, delivery, nullptr, false, scratch);
  State state(m, d, 0);
  Gathered contacts = GatherContacts(m, d, ownership, state, nullptr, scratch);
  ASSERT_TRUE(
      FindDue(m, d, outlook, config.touch, scratch.Zeros(static_cast<int>(m->ntree)), contacts));
  int* position = scratch.Take<int>(contacts.count);
  const mjtNum h = m->opt.timestep, ever = std::numeric_limits<mjtNum>::infinity();
  ImpactTime time{0, ever, h, 0.1 * h, h, ever, -1, h, 0};
  for (int k = 0; k < contacts.count; ++k) {
    position[k] = k;
    Anchor(m, d, contacts, k);
    if (!contacts.due[k] || contacts.tau[k] >= time.tau) continue;
    time.tau = contacts.tau[k];
    time.first = k;
  }

  Scratch inside(d);
  size_t asked = IslandBytes(m, mobility, contacts, position, contacts.count,
                             HasFriction(materials, contacts), inside);
  if (config.friction == Friction::kPaper) asked += FrictionBytes(m, asked);
  const size_t before = d->pstack;
  d->maxuse_stack = 0;
  IslandSystem system = BuildIsland(m, d, mobility, contacts, position, contacts.count,
                                    outlook.motion, time.tau, time.tau, inside);
  const mjtNum* velocity = SettledVelocity(m, outlook, time.tau, inside);
  Impact* impacts = inside.Take<Impact>(contacts.count);
  const mjtNum* acceleration = inside.Zeros(static_cast<int>(m->nv));
  Budget budget(m, materials.IsElastic(), HasFriction(materials, contacts), contacts);
  mjtNum stiffer = 1;
  Tangents* tangents = nullptr;
  if (HasFriction(materials, contacts)) {
    tangents = BuildTangents(m, d, mobility, materials, system, outlook.motion, time.tau, velocity,
                             inside);
  }
  ResolveIsland(m, config, materials, ownership, system, time, velocity, acceleration, tangents,
                budget, &stiffer, impacts, inside);
  if (config.friction == Friction::kPaper) {
    AddFriction(m, d, config, outlook.motion, time.tau, velocity, system, impacts, inside);
  }
  EXPECT_GT(impacts[time.first].impulse, 0);
  const size_t used = static_cast<size_t>(d->maxuse_stack) - before;
  EXPECT_GE(asked, used) << contacts.count << " contacts";
  // nor so much that impacts wait for which there is room
  constexpr size_t kReserve = 1 << 14;
  const size_t most = config.friction == Friction::kPaper ? 3 * used : 3 * used / 2;
  EXPECT_LT(asked, most + kReserve) << contacts.count << " contacts";
  RecordProperty("asked", static_cast<int>(asked));
  RecordProperty("used", static_cast<int>(used));
}

}  // namespace
}  // namespace mujoco_impact::engine
