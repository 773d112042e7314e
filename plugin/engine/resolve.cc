// SPDX-License-Identifier: Apache-2.0

#include "engine/resolve.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "law/hertz_contact.h"
#include "law/impact_law.h"
#include "law/passivity.h"
#include "law/waveform.h"

namespace mujoco_impact::engine {

namespace {

// Curvature of the geom at a contact [1/m]: exact for spheres and planes, of the order of the size
// for other shapes, where it only sets how long a contact lasts and how it shares an impulse.
mjtNum Curvature(const mjModel* m, int geom) {
  const mjtNum* size = m->geom_size + 3 * geom;
  switch (m->geom_type[geom]) {
    case mjGEOM_PLANE:
    case mjGEOM_HFIELD:
    case mjGEOM_BOX:
      return 0;
    case mjGEOM_SPHERE:
    case mjGEOM_CAPSULE:
    case mjGEOM_CYLINDER:
      return 1 / size[0];
    case mjGEOM_ELLIPSOID:
      return 1 / std::cbrt(size[0] * size[1] * size[2]);
    default:
      return 1 / m->geom_rbound[geom];
  }
}

mjtNum ContactStiffness(const mjModel* m, const Config& config, const mjContact& contact) {
  mjtNum curvature = Curvature(m, contact.geom[0]) + Curvature(m, contact.geom[1]);
  if (curvature <= 0) {
    // flat on flat: as stiff as a sphere of the size of the smaller body
    curvature = 1 / std::max(m->geom_rbound[contact.geom[0]], m->geom_rbound[contact.geom[1]]);
  }
  return law::HertzStiffness(config.effective_modulus, curvature);
}

// What an island looks like to the laws.
struct Problem {
  int size;
  mjtNum *closing_speed, *gap, *stiffness;
  mjtNum *impulse, *moment, *onset, *after;  // the solution
  law::Workspace work;
};

Problem MakeProblem(const mjModel* m, const Config& config, const IslandSystem& system,
                    const mjtNum* velocity, Scratch& scratch) {
  const int n = system.size;
  Problem problem{
      n,
      scratch.Take<mjtNum>(n),
      scratch.Take<mjtNum>(n),
      scratch.Take<mjtNum>(n),
      scratch.Zeros(n),
      scratch.Zeros(n),
      scratch.Zeros(n),
      scratch.Take<mjtNum>(n),
      {scratch.Take<mjtNum>(law::ImpactNumbers(n)), scratch.Take<int>(law::ImpactIndices(n))}};
  for (int k = 0; k < n; ++k) {
    const ContactRow& row = system.row[k];
    problem.closing_speed[k] = -RowTimes(m, row, velocity);
    problem.gap[k] = row.gap <= config.touch ? 0 : row.gap;
    problem.stiffness[k] = ContactStiffness(m, config, *row.contact);
  }
  return problem;
}

void SolveHertz(const Config& config, const IslandSystem& system, const ImpactTime& time,
                Problem& problem) {
  const law::ImpactProblem impact{system.delassus,
                                  problem.closing_speed,
                                  problem.gap,
                                  problem.stiffness,
                                  config.restitution,
                                  config.dissipation,
                                  time.timestep - time.start - time.tau,
                                  time.flight,
                                  config.tolerance};
  law::ImpactSolution solution{problem.impulse, problem.moment, problem.onset, problem.after};
  law::SolveImpact(impact, config.passive, &solution, problem.work);
}

// P_k = α_k P on every contact that touches (10)-(12), made passive.
void SolveCalibrated(const Config& config, const Ownership& ownership, const IslandSystem& system,
                     int first, mjtNum momentum, Problem& problem, mjtNum* alpha,
                     Scratch& scratch) {
  const int pairs = ownership.size() - 1;
  mjtNum* alphas = scratch.Take<mjtNum>(pairs);
  ReadList(config.alpha, alphas, pairs);
  const mjtNum common = law::CalibratedImpulse(config.calibrated, momentum);
  for (int k = 0; k < problem.size; ++k) {
    const mjContact& contact = *system.row[k].contact;
    const int i = ownership.Index(contact.geom[0]), j = ownership.Index(contact.geom[1]);
    const bool neighbours = i >= 0 && j >= 0 && std::abs(i - j) == 1;
    alpha[k] = neighbours ? alphas[std::min(i, j)] : 1;
    const bool touches = k == first || problem.gap[k] == 0;
    problem.impulse[k] = touches ? alpha[k] * common : 0;
  }
  if (!config.passive) return;
  const mjtNum scale = law::PassiveScale(system.delassus, problem.closing_speed, problem.impulse,
                                         problem.work.numbers);
  if (scale < 1) mju_scl(problem.impulse, problem.impulse, scale, problem.size);
}

// W for the contact, from the first moment of its force about the onset: the waveform then has the
// same centre of impulse. A push that is rounding has its moment off by more than it lasts.
mjtNum DurationFromMoment(mjtNum impulse, mjtNum moment, mjtNum onset, mjtNum restitution) {
  constexpr mjtNum kShortest = 1e-12;  // [s]
  return std::max(kShortest, (moment / impulse - onset) / law::WaveformMoment(1, restitution));
}

}  // namespace

mjtNum IncomingMass(const mjModel* m, const IslandSystem& system, int k, const mjtNum* velocity) {
  mjtNum inverse_mass = system.delassus.diagonal[k], fastest = 0;
  for (const RowSegment& segment : system.row[k].segment) {
    if (segment.tree < 0) continue;
    const int dofs = m->tree_dofnum[segment.tree];
    const mjtNum towards =
        -mju_dot(segment.jacobian, velocity + m->tree_dofadr[segment.tree], dofs);
    if (towards <= fastest) continue;
    fastest = towards;
    inverse_mass = mju_dot(segment.jacobian, segment.inverse_inertia, dofs);
  }
  return 1 / inverse_mass;
}

mjtNum EstimateContactTime(const mjModel* m, const Config& config, const mjContact& contact,
                           mjtNum speed) {
  mjtNum mass = std::numeric_limits<mjtNum>::infinity();
  for (const int geom : contact.geom) {
    const int body = m->geom_bodyid[geom];
    if (m->body_treeid[body] >= 0) mass = std::min(mass, m->body_mass[body]);
  }
  return law::ContactTime(ContactStiffness(m, config, contact), mass, speed);
}

void ResolveIsland(const mjModel* m, const Config& config, const Ownership& ownership,
                   const IslandSystem& system, const ImpactTime& time, const mjtNum* velocity,
                   Impact* impacts, Scratch& scratch) {
  Problem problem = MakeProblem(m, config, system, velocity, scratch);
  const int first = time.first;
  const mjtNum speed = problem.closing_speed[first];
  std::fill_n(impacts, system.size, Impact{});
  if (speed <= 0) return;

  // the law: impulses
  const mjtNum reduced_mass = 1 / system.delassus.diagonal[first];
  // p = m u of the body that brings the momentum into the contact that closes first
  const mjtNum momentum = IncomingMass(m, system, first, velocity) * speed;
  const mjtNum e = config.waveform_restitution;
  const bool hertz = config.law == Law::kHertz;
  mjtNum* alpha = scratch.Zeros(system.size);
  if (hertz) {
    SolveHertz(config, system, time, problem);
    // α_k = P_k / P_ref, P_ref = (1 + e) μ u of the contact that closes first
    mju_scl(alpha, problem.impulse, 1 / ((1 + e) * reduced_mass * speed), system.size);
  } else {
    SolveCalibrated(config, ownership, system, first, momentum, problem, alpha, scratch);
  }

  // the waveform: when they come
  const bool timed = InstantRule(config);
  const mjtNum tau = time.start + time.tau;
  mjtNum common = config.duration;
  if (config.duration_rule == DurationRule::kPaper) {
    common = law::CalibratedDuration(config.calibrated, momentum);
  } else if (config.duration_rule == DurationRule::kHertz) {
    common = (1 + e) / 2 * law::ContactTime(problem.stiffness[first], reduced_mass, speed);
  }
  for (int k = 0; k < system.size; ++k) {
    const mjtNum P = problem.impulse[k];
    if (P <= 0) continue;
    const mjtNum onset = timed ? problem.onset[k] : 0;
    const mjtNum W = timed ? DurationFromMoment(P, problem.moment[k], onset, e) : common;
    const bool at_once = timed && W <= time.timestep;
    impacts[k] = {P, alpha[k], tau + onset, W, problem.moment[k] + tau * P, at_once, {}};
  }
}

}  // namespace mujoco_impact::engine
