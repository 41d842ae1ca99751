// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/material/spring_relations.hpp"
#include "equidem/statics/critical_ratio.hpp"

#include "abe1996/abe1996.hpp"

namespace equidem::abe1996 {
namespace {

constexpr double sqrt3 = std::numbers::sqrt3;

Assembly block_of(const Block& block, int columns, int rows) {
  return hexagonal_lattice({.columns = columns, .rows = rows, .radius = block.radius});
}

struct TestRun {
  Equilibrium equilibrium;
  TensionResult result;
};

TestRun run_test(const Assembly& assembly, const Block& block, double ratio, Rotation rotation) {
  const ContactSprings springs(SpringConstants{block.kN, ratio * block.kN});
  const TensionSetup setup = tension_setup(assembly, block.test);
  TestRun run;
  run.equilibrium =
      solve_equilibrium(assembly, springs, setup.supports, setup.loads, {.rotation = rotation, .solver = {}});
  run.result = evaluate_tension(assembly, springs, block.test, setup, run.equilibrium);
  return run;
}

std::vector<RatioPoint> test_ratios(const Block& block, Progress& progress) {
  const Assembly assembly = block_of(block, block.columns, block.rows);
  std::vector<RatioPoint> points;
  constexpr int first = -18, last = 20;  // in steps of 0.05: -0.9 to 1
  for (int step = first; step <= last; ++step) {
    const double ratio = step / 20.0;
    const TestRun run = run_test(assembly, block, ratio, Rotation::from_scene);
    points.push_back({ratio, run.result.poisson_ratio, run.result.stiffness_ratio, run.equilibrium.negative_pivots,
                      run.equilibrium.unstable_modes, run.equilibrium.relative_residual});
    progress.update(0.4 * (step - first + 1.0) / (last - first + 1.0));
  }
  return points;
}

std::vector<Convergence> test_sizes(const Block& block, Progress& progress) {
  std::vector<Convergence> all;
  for (const double ratio : {0.0, 0.1, 0.5, 1.0}) {
    Convergence convergence{ratio, {}};
    for (const int rows : {9, 17, 33, 65, 129}) {
      const TestRun run = run_test(block_of(block, rows, rows), block, ratio, Rotation::from_scene);
      convergence.points.push_back({rows, std::abs(run.result.poisson_ratio - poisson_ratio_of_ratio(ratio)),
                                    std::abs(run.result.stiffness_ratio / hexagonal_stiffness_ratio(ratio) - 1)});
    }
    all.push_back(std::move(convergence));
    progress.update(0.4 + 0.5 * static_cast<double>(all.size()) / 4);
  }
  return all;
}

/// Eq. (52) with G and nu of eq. (34).
Tensor2 stress_of_continuum(const SpringConstants& springs, const Tensor2& h) {
  const ElasticModuli moduli = moduli_of(springs, lattices::hexagonal.relation);
  const double g = moduli.shear_modulus, lambda = moduli.lame_lambda(), volume = lambda * (h.xx + h.yy);
  const double shear = g * (h.xy + h.yx);
  return {volume + 2 * g * h.xx, shear, shear, volume + 2 * g * h.yy};
}

/// Eq. (55) over the cell 2 sqrt3 a², its first bracket completed by d_2i d_2j (u_1,1 + 3 u_2,2): (sqrt3/4) [(kN -
/// kT) d_ij e_mm + 2 (kN + kT) e_ij] + (sqrt3/2) kT e_ji W with W = u_2,1 - u_1,2.
Tensor2 restrained_stress(const SpringConstants& k, const Tensor2& h) {
  const double volume = (k.kN - k.kT) * (h.xx + h.yy), sum = k.kN + k.kT, shear = sum * (h.xy + h.yx);
  const double spin = 0.5 * sqrt3 * k.kT * (h.yx - h.xy);
  const double c = sqrt3 / 4;
  return {c * (volume + 2 * sum * h.xx), c * shear - spin, c * shear + spin, c * (volume + 2 * sum * h.yy)};
}

double deviation(const std::vector<Tensor2>& stresses, const Tensor2& expected) {
  const double size =
      std::max({std::abs(expected.xx), std::abs(expected.yy), std::abs(expected.xy), std::abs(expected.yx)});
  double worst = 0;
  for (const Tensor2& s : stresses) {
    worst = std::max({worst, std::abs(s.xx - expected.xx), std::abs(s.yy - expected.yy), std::abs(s.xy - expected.xy),
                      std::abs(s.yx - expected.yx)});
  }
  return worst / size;
}

StressCheck check_stress(const Block& block) {
  StressCheck check;
  const Assembly cell = hexagonal_lattice({.columns = 8, .rows = 8, .radius = block.radius, .periodic = true});
  const Tensor2 gradients[] = {
      {1e-3, 0, 0, 0}, {0, 0, 0, 1e-3}, {0, 1e-3, 0, 0}, {0, 0, 1e-3, 0}, {7e-4, -3e-4, 9e-4, 2e-4}};
  for (const double ratio : {-0.3, -0.1, 0.0, 0.25, 0.5, 1.0}) {
    const SpringConstants k{block.kN, ratio * block.kN};
    for (const Tensor2& h : gradients) {
      const auto turned = affine_contact_forces(cell, ContactSprings(k), h, mean_rotation(h));
      check.free_rotation =
          std::max(check.free_rotation, deviation(disc_stresses(cell, turned), stress_of_continuum(k, h)));
      const auto held = affine_contact_forces(cell, ContactSprings(k), h, 0);
      check.restrained_rotation =
          std::max(check.restrained_rotation, deviation(disc_stresses(cell, held), restrained_stress(k, h)));
    }
  }
  check.ratio = 0.5;
  const SpringConstants k{block.kN, check.ratio * block.kN};
  const Tensor2 shear{0, 0, 1e-3, 0};
  check.spin = shear.yx - shear.xy;
  const auto forces = affine_contact_forces(cell, ContactSprings(k), shear, 0);
  std::vector<double> moments(cell.size(), 0.0);
  for (std::size_t c = 0; c < cell.contacts.size(); ++c) {
    moments[cell.contacts[c].i] -= cell.contacts[c].lever_i * forces[c].tangential;
    moments[cell.contacts[c].j] -= cell.contacts[c].lever_j * forces[c].tangential;
  }
  const StressAsymmetry found = stress_asymmetry(cell, forces, moments);
  check.asymmetry = found.difference;
  check.moment_density = found.moment_density;
  check.expected_asymmetry = -sqrt3 * k.kT * check.spin;
  const Assembly free = block_of(block, block.columns, block.rows);
  check.restrained_poisson_ratio = run_test(free, block, check.ratio, Rotation::restrained).result.poisson_ratio;
  return check;
}

}  // namespace

Reproduction reproduce(const Block& block) {
  Reproduction result;
  result.block = block;
  Progress progress("reproducing Abe 1996");
  Stopwatch watch;
  const Assembly assembly = block_of(block, block.columns, block.rows);
  const TensionSetup setup = tension_setup(assembly, block.test);
  result.height = setup.height;
  result.gauge_length = norm(assembly.centres[setup.horizontal.second] - assembly.centres[setup.horizontal.first]);
  result.gauge_height = norm(assembly.centres[setup.vertical.second] - assembly.centres[setup.vertical.first]);
  result.points = test_ratios(block, progress);
  result.times.add("figures 7 and 8", watch.lap());
  result.convergence = test_sizes(block, progress);
  result.times.add("error against size", watch.lap());
  result.lattice_limit = -1.0 / 3;
  result.block_limit = critical_ratio(assembly, setup.supports);
  result.times.add("critical ratio", watch.lap());
  result.stress = check_stress(block);
  result.times.add("macroscopic stress", watch.lap());
  return result;
}

}  // namespace equidem::abe1996
