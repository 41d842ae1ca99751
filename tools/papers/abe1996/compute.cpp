// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
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

RatioPoint test_ratio(const Assembly& assembly, const Block& block, double ratio) {
  const TestRun run = run_test(assembly, block, ratio, Rotation::from_scene);
  return {ratio,
          run.result.poisson_ratio,
          run.result.stiffness_ratio,
          run.equilibrium.negative_pivots,
          run.equilibrium.unstable_modes,
          run.equilibrium.relative_residual};
}

std::vector<RatioPoint> test_ratios(const Block& block, Progress& progress) {
  const Assembly assembly = block_of(block, block.columns, block.rows);
  std::vector<RatioPoint> points;
  constexpr int first = -18, last = 20;  // in steps of 0.05: -0.9 to 1
  for (int step = first; step <= last; ++step) {
    points.push_back(test_ratio(assembly, block, step / 20.0));
    progress.update(0.2 * (step - first + 1.0) / (last - first + 1.0));
  }
  return points;
}

std::vector<RatioPoint> test_large_block(const Block& block, Progress& progress) {
  const Assembly assembly = block_of(block, large_rows, large_rows);
  std::vector<RatioPoint> points;
  for (int step = -2; step <= 10; ++step) {
    points.push_back(test_ratio(assembly, block, step / 10.0));
    progress.update(0.2 + 0.2 * (step + 3) / 13.0);
  }
  return points;
}

/// Forces and moments that the contact forces of the uniform state leave unbalanced at the rim of a free block: its
/// loads. One group for each loaded disc is added to the assembly.
LoadCase loads_of_uniform_state(Assembly& assembly, const ContactSprings& springs, const Tensor2& gradient) {
  const auto forces = affine_contact_forces(assembly, springs, gradient, mean_rotation(gradient));
  std::vector<Load> missing(assembly.size());
  double largest = 0;
  for (std::size_t c = 0; c < forces.size(); ++c) {
    const ContactFrame frame = frame_of(assembly, c);
    const Contact& contact = assembly.contacts[c];
    const Vec2 on_i = force_on_i(frame, forces[c]);
    missing[contact.i].force -= on_i;
    missing[contact.j].force += on_i;
    missing[contact.i].moment -= moment_on_i(frame, forces[c]);
    missing[contact.j].moment -= moment_on_j(frame, forces[c]);
    largest = std::max(largest, norm(on_i));
  }
  LoadCase loads;
  for (std::size_t disc = 0; disc < missing.size(); ++disc) {
    Load& load = missing[disc];
    if (norm(load.force) < 1e-9 * largest && std::abs(load.moment) < 1e-9 * largest * assembly.radii[disc]) continue;
    load.group = fmt::format("loaded {}", disc);
    assembly.groups[load.group] = {.discs = {static_cast<std::int32_t>(disc)}, .tributary_lengths = {}};
    loads.push_back(load);
  }
  return loads;
}

/// nu of the test with the loads of the uniform state in place of equal ones; sets those loads in `edges`.
double test_with_exact_loads(const Block& block, EdgeEffect& edges) {
  Assembly assembly = block_of(block, block.columns, block.rows);
  const ContactSprings springs(SpringConstants{block.kN, edges.ratio * block.kN});
  TensionSetup setup = tension_setup(assembly, block.test);
  const double e11 = block.test.stress / (block.kN * hexagonal_stiffness_ratio(edges.ratio));
  const double e22 = -in_plane_stress(poisson_ratio_of_ratio(edges.ratio)) * e11;
  setup.loads = loads_of_uniform_state(assembly, springs, {e11, 0, 0, e22});
  const auto load_on = [&](std::int32_t disc) {
    for (const Load& load : setup.loads)
      if (assembly.groups[load.group].discs.front() == disc) return load.force.x;
    return 0.0;
  };
  const std::vector<std::int32_t>& right = group(assembly, "right").discs;
  const double mean = block.test.stress * setup.height / block.rows;
  edges.rows = block.rows;
  for (const std::int32_t disc : right) edges.total += load_on(disc) / mean;
  edges.corner = load_on(right[0]) / mean;
  edges.short_row = load_on(right[1]) / mean;
  edges.long_row = load_on(right[2]) / mean;
  const Equilibrium rest = solve_equilibrium(assembly, springs, setup.supports, setup.loads);
  return evaluate_tension(assembly, springs, block.test, setup, rest).poisson_ratio;
}

EdgeEffect explain_error(const Block& block) {
  EdgeEffect edges;
  const auto add = [&](const std::string& name, double nu) { edges.variations.push_back({name, nu}); };
  const auto size = [&](int columns, int rows) { return fmt::format("{} rows of {} discs", rows, columns); };
  const auto nu_of = [&](int columns, int rows) {
    return test_ratio(block_of(block, columns, rows), block, edges.ratio).poisson_ratio;
  };
  add(size(block.columns, block.rows) + ", equal loads (Fig. 6)", nu_of(block.columns, block.rows));
  for (const int times : {2, 4, 8})
    add(size(times * block.columns, block.rows), nu_of(times * block.columns, block.rows));
  add(size(large_rows, large_rows), nu_of(large_rows, large_rows));
  add(size(block.columns, block.rows) + ", loads of the uniform state", test_with_exact_loads(block, edges));
  const Assembly cell = hexagonal_lattice({.columns = 8, .rows = 8, .radius = block.radius, .periodic = true});
  const ContactSprings springs(SpringConstants{1, edges.ratio});
  add("periodic cell, homogenized", effective_moduli(effective_stiffness(cell, springs).stiffness).poisson_strain);
  return edges;
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
    progress.update(0.4 + 0.3 * static_cast<double>(all.size()) / 4);
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
  result.large_points = test_large_block(block, progress);
  result.times.add("figures 7 and 8", watch.lap());
  result.convergence = test_sizes(block, progress);
  result.edges = explain_error(block);
  result.times.add("error against size", watch.lap());
  result.lattice_limit = -1.0 / 3;
  result.block_limit = critical_ratio(assembly, setup.supports);
  result.times.add("critical ratio", watch.lap());
  result.stress = check_stress(block);
  progress.update(0.75);
  result.square = measure_square_lattice(block);
  result.waves = measure_restrained_waves(block);
  result.times.add("macroscopic stress, waves", watch.lap());
  result.unequal = measure_unequal_radii(block);
  result.times.add("unequal radii", watch.lap());
  return result;
}

}  // namespace equidem::abe1996
