// SPDX-License-Identifier: GPL-3.0-or-later
#include "petsc/statics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/homogenize/sample_solver.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/statics/loads.hpp"
#include "equidem/statics/motion_description.hpp"

namespace equidem::petsc {
namespace {

std::vector<double> assemble(const Network& network, const LoadCase& loads) {
  std::vector<double> f(network.size(), 0.0);
  for (const Load& load : loads) {
    const auto found = network.whole.groups.find(load.group);
    const DiscGroup& discs = group(network.assembly, load.group);
    add_load(load, discs, found == network.whole.groups.end() ? 0 : found->second, network.unknowns, f);
  }
  check_inert_loads(network.assembly, network.unknowns, f);
  return f;
}

void describe(const Network& network, const LoadCase& loads, std::span<const double> f, const Refined& refined,
              PartEquilibrium& result) {
  const Ranks& ranks = network.ranks;
  const Assembly& assembly = network.assembly;
  const DegreesOfFreedom& unknowns = network.unknowns;
  const std::size_t b = network.block();
  Equilibrium& state = result.state;
  if (refined.scale > 0) {
    state.relative_residual = refined.residual / refined.scale;
    state.rounded_residual = refined.rounded_residual / refined.scale;
  }
  state.refinements = refined.refinements;
  state.iterations = refined.iterations;
  constexpr double margin = 10;
  state.error_bound = margin * refined.error;
  state.motions = disc_motions(unknowns, refined.motion.high);
  state.contact_forces.resize(assembly.contacts.size());
  contact_forces_of(assembly, network.springs, unknowns, refined.motion, state.contact_forces);
  if (network.effects.bending) state.bending_moments = bending_moments_of(network.local(), refined.motion);
  const std::vector<double> internal = network.internal(refined.motion);
  double sums[7] = {};  // energy, moments, stress and its scale
  for (std::size_t d = 0; d < static_cast<std::size_t>(network.part.owned); ++d) {
    const auto held = [&](std::size_t k) { return unknowns.held[d * b + k] != 0; };
    const auto reaction = [&](std::size_t k) { return held(k) ? internal[d * b + k] - f[d * b + k] : 0.0; };
    if (!held(0) && !held(1) && !(b == 3 && reaction(2) != 0)) continue;
    const double moment = b == 3 ? reaction(2) * unknowns.rotation_scale : 0.0;
    sums[1] += moment;
    state.reactions.push_back({static_cast<std::int32_t>(d), {reaction(0), reaction(1)}, moment});
  }
  const bool prestressed = network.springs.prestressed();
  if (prestressed) sums[0] = elastic_energy(assembly, network.springs, state.motions);
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const ContactFrame frame = frame_of(assembly, c);
    const ContactForce& force = state.contact_forces[c];
    const SpringConstants springs = network.springs[c];
    double stretch = springs.kN != 0 ? force.normal / springs.kN : 0;
    if (prestressed) {
      const ContactMotion motion = motion_of(network.local(), refined.motion, {}, c);
      const auto response = contact_response(network.springs, c, motion.deformation, motion.theta_i, motion.theta_j);
      if (network.effects.restrained) sums[1] -= response.moment_i + response.moment_j;
      stretch = motion.deformation.normal;
    } else {
      sums[0] += linear_spring_energy_of(springs, force);
    }
    const double kM = network.springs.bending(c);
    if (!prestressed && !state.bending_moments.empty() && kM > 0)
      sums[0] += 0.5 * state.bending_moments[c] * state.bending_moments[c] / kM;
    if (network.effects.restrained) sums[1] -= moment_on_i(frame, force) + moment_on_j(frame, force);
    const Tensor2 work = force_by_branch(frame, force);
    sums[2] += work.xx, sums[3] += work.xy, sums[4] += work.yx, sums[5] += work.yy, sums[6] += frobenius_norm(work);
    const Contact& contact = assembly.contacts[c];
    const double radii = assembly.radii[contact.i] + assembly.radii[contact.j];
    result.largest_deformation = std::max(result.largest_deformation, std::abs(stretch) / radii);
  }
  ranks.sum(sums);
  result.largest_deformation = ranks.largest(result.largest_deformation);
  state.energy = sums[0];
  const double area = network.whole.area;
  if (!(area > 0)) return;
  for (const Load& load : loads) {
    const double times = load.kind == LoadKind::total ? 1.0 : static_cast<double>(network.whole.groups.at(load.group));
    sums[1] += times * load.moment;
  }
  result.moment_per_area = sums[1] / area;
  result.stress_scale = sums[6] / area;
  result.stress = (1 / area) * Tensor2{sums[2], sums[3], sums[4], sums[5]};
}

}  // namespace

PartEquilibrium solve_loads(const Network& network, PetscSolver& solver, const LoadCase& loads) {
  PartEquilibrium result;
  Equilibrium& state = result.state;
  std::vector<double> f;
  network.ranks.together([&] { f = assemble(network, loads); });
  Stopwatch watch;
  const Refined refined = refine(network, solver, f, {});
  state.times.add("solve", watch.lap());
  describe(network, loads, f, refined, result);
  state.times.add("forces", watch.lap());
  state.solver = solver.name();
  state.factor_bytes = solver.grid_bytes();
  state.unknowns = network.free_count;
  if (network.may_be_indefinite) state.negative_pivots = state.unstable_modes = std::nullopt;
  return result;
}

namespace {

/// The disc nearest to a point; of discs equally near (to 1e-9 of a spacing) that with the smallest name.
std::int32_t nearest_of_all(const Ranks& ranks, const Part& part, Vec2 point, double spacing) {
  double least = std::numeric_limits<double>::infinity();
  const auto owned = static_cast<std::size_t>(part.owned);
  const auto distance = [&](std::size_t d) { return norm(part.assembly.centres[d] - point); };
  for (std::size_t d = 0; d < owned; ++d) least = std::min(least, distance(d));
  least = ranks.smallest(least) + 1e-9 * spacing;
  std::int64_t name = std::numeric_limits<std::int32_t>::max();
  for (std::size_t d = 0; d < owned; ++d) {
    if (distance(d) < least) name = std::min(name, part.names[d]);
  }
  return static_cast<std::int32_t>(ranks.smallest(static_cast<double>(name)));
}

double height_of(const Ranks& ranks, const Part& part, const char* side) {
  const auto found = part.assembly.groups.find(side);
  if (found == part.assembly.groups.end()) return ranks.sum(0.0);
  const std::vector<double>& lengths = found->second.tributary_lengths;
  return ranks.sum(std::accumulate(lengths.begin(), lengths.end(), 0.0));
}

double strain_of(const Network& network, const PartEquilibrium& equilibrium, const StrainGauge& gauge) {
  double ends[8] = {};  // place and displacement of the first disc, then of the second
  const Part& part = network.part;
  for (std::size_t d = 0; d < static_cast<std::size_t>(part.owned); ++d) {
    for (const std::size_t end : {std::size_t{0}, std::size_t{1}}) {
      if (part.names[d] != (end == 0 ? gauge.first : gauge.second)) continue;
      const Vec2 x = part.assembly.centres[d], u = equilibrium.state.motions[d].u;
      ends[4 * end] = x.x, ends[4 * end + 1] = x.y, ends[4 * end + 2] = u.x, ends[4 * end + 3] = u.y;
    }
  }
  network.ranks.sum(ends);
  const Vec2 l{ends[4] - ends[0], ends[5] - ends[1]}, du{ends[6] - ends[2], ends[7] - ends[3]};
  return dot(du, l) / dot(l, l);
}

}  // namespace

TensionSetup tension_setup(const Ranks& ranks, const Part& part, const Whole& whole, const TensionTest& test,
                           const RowLattice* lattice) {
  TensionSetup setup;
  if (lattice != nullptr) {
    ranks.together([&] {
      // The sides alone: gauges follow from the numbers of their discs.
      Assembly sides;
      sides.kind = part.assembly.kind;
      sides.period = part.assembly.period;
      sides.contacts.emplace_back();
      if (!sides.period) sides.groups = row_lattice_sides(*lattice);
      setup = equidem::tension_setup(sides, test);
    });
    return setup;
  }
  const double left = height_of(ranks, part, "left"), right = height_of(ranks, part, "right");
  ranks.together([&] {
    if (part.assembly.periodic()) {
      bad_input("the tension test is asked of a periodic cell", "a periodic cell has no sides to pull at",
                "Set periodic = false, or homogenize the cell");
    }
    setup = tension_loads(test, left, right);
  });
  const auto nearest = [&](Vec2 point) { return nearest_of_all(ranks, part, point, whole.mean_branch); };
  place_nearest_gauges(whole.extents, whole.mean_branch, test.gauge, nearest, setup);
  return setup;
}

TensionResult evaluate_tension(const Network& network, const TensionTest& test, const TensionSetup& setup,
                               const PartEquilibrium& equilibrium) {
  const Assembly& assembly = network.assembly;
  const Ranks& ranks = network.ranks;
  const Rectangle inner = inner_half(network.whole.extents, network.whole.mean_branch);
  const Vec2 middle = 0.5 * (inner.low + inner.high), half = 0.5 * (inner.high - inner.low);
  const auto owned = static_cast<std::size_t>(network.part.owned);
  const Tensor2 fitted = fitted_displacement_gradient(
      assembly, equilibrium.state.motions,
      [&](std::size_t disc) {
        const Vec2 d = assembly.centres[disc] - middle;
        return disc < owned && std::abs(d.x) <= half.x && std::abs(d.y) <= half.y;
      },
      [&](std::span<double> sums) { ranks.sum(sums); });
  double normal = 0;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) normal += network.springs[c].kN;
  const double mean = ranks.sum(normal) / static_cast<double>(network.whole.contacts);
  return tension_result(test, strain_of(network, equilibrium, setup.horizontal),
                        strain_of(network, equilibrium, setup.vertical),
                        network.springs.uniform() ? network.springs[0].kN : mean, fitted);
}

namespace {

/// Sums over the contacts of all ranks: energies of pairs of strains, and stresses of each case times the area.
struct Sums {
  PairEnergies energies;
  Matrix3 bending{}, prestress{};
  std::vector<Tensor2> stresses;
  Tensor2 at_rest;  ///< likewise, of the forces at rest
};

Sums sum_up(const Network& network, std::span<const Refined> cases) {
  const Assembly& assembly = network.assembly;
  const SpringNetwork local = network.local();
  constexpr std::size_t triangle = pair_sums / 2, first_prestress = pair_sums + triangle;
  constexpr std::size_t first_stress = first_prestress + triangle, at_rest = first_stress + 4 * strain_cases;
  const auto add_tensor = [](const Tensor2& t, double* sums) {
    sums[0] += t.xx, sums[1] += t.xy, sums[2] += t.yx, sums[3] += t.yy;
  };
  auto total = contact_sums<at_rest + 4>(assembly.contacts.size(), [&](std::size_t c, auto& sums) {
    const ContactFrame frame = frame_of(assembly, c);
    std::array<ContactDeformation, strain_cases> deformations;
    std::array<double, strain_cases> turns{};
    std::array<ContactMotion, strain_cases> motions;
    for (std::size_t k = 0; k < cases.size(); ++k) {
      motions[k] = motion_of(local, cases[k].motion, unit_gradients[k], c);
      deformations[k] = motions[k].deformation;
      turns[k] = motions[k].theta_j - motions[k].theta_i;
      add_tensor(force_by_branch(frame, force_of(network.springs, c, motions[k])), &sums[first_stress + 4 * k]);
    }
    if (const ContactPrestress* const prestress = network.springs.prestress(c)) {
      add_prestress_energies(*prestress, motions.data(), sums.data() + first_prestress);
      add_tensor(force_by_branch(frame, force_at_rest(assembly, c)), &sums[at_rest]);
    }
    add_pair_energies(network.springs[c], deformations.data(), sums.data());
    const double kM = network.springs.bending(c);
    add_triangle(sums.data() + pair_sums, [&](std::size_t a, std::size_t b) { return kM * turns[a] * turns[b]; });
  });
  network.ranks.sum(total);
  const auto tensor = [&](std::size_t first) {
    return Tensor2{total[first], total[first + 1], total[first + 2], total[first + 3]};
  };
  Sums sums{.energies = pair_energies(total.data()),
            .bending = symmetric(total.data() + pair_sums),
            .prestress = symmetric(total.data() + first_prestress),
            .stresses = {},
            .at_rest = tensor(at_rest)};
  for (std::size_t k = 0; k < cases.size(); ++k) sums.stresses.push_back(tensor(first_stress + 4 * k));
  return sums;
}

/// Whether all discs can counter-rotate: neighbours along rows and columns turn the other way.
bool is_even_square(const Part& part) {
  const Assembly& assembly = part.assembly;
  if (assembly.kind != "square" || assembly.radii.empty()) return false;
  const auto even = [&](double length) { return std::llround(length / (2 * assembly.radii.front())) % 2 == 0; };
  return even(assembly.period->x) && even(assembly.period->y);
}

}  // namespace

std::vector<std::int64_t> free_components(const Part& part, const Effects& effects) {
  std::vector<std::int64_t> components{0, 1};
  if (effects.rotation && !effects.bending && is_even_square(part)) components.push_back(2);
  return components;
}

EffectiveStiffness cell_stiffness(const Network& network, PetscSolver& solver) {
  if (!network.assembly.periodic()) {
    bad_input("the boundary is periodic but the assembly is not", "it has no images to be joined to",
              "Take a periodic assembly, or 'equidem homogenize' for other boundaries");
  }
  EffectiveStiffness result;
  result.effects = network.effects;
  result.area = network.whole.area;
  Stopwatch watch;
  std::vector<Refined> cases;
  double worst = 0;
  for (std::size_t k = 0; k < (result.effects.restrained ? 4U : 3U); ++k) {
    cases.push_back(refine(network, solver, {}, unit_gradients[k]));
    const Refined& one = cases.back();
    if (one.scale > 0 && one.iterations > 0)
      result.relative_residual = std::max(result.relative_residual, one.residual / one.scale);
    result.iterations += one.iterations;
    worst = std::max(worst, one.error);
  }
  result.times.add("solve", watch.lap());
  Sums sums = sum_up(network, cases);
  for (Tensor2& stress : sums.stresses) stress *= 1 / result.area;
  result.normal_part = (1 / result.area) * sums.energies.normal;
  result.tangential_part = (1 / result.area) * sums.energies.tangential;
  result.stiffness = result.normal_part + result.tangential_part;
  if (result.effects.bending) {
    result.bending_part = (1 / result.area) * sums.bending;
    result.stiffness = result.stiffness + result.bending_part;
  }
  if (result.effects.prestress) {
    result.prestress_part = (1 / result.area) * sums.prestress;
    result.stiffness = result.stiffness + result.prestress_part;
  }
  constexpr double rounding = 64 * std::numeric_limits<double>::epsilon();
  result.error_bound = (worst * worst + rounding) * largest_entry(result.stiffness);
  result.hill_mandel = power_difference(sums.stresses, result.stiffness);
  keep_gradient_stiffness(sums.stresses, result);
  result.cauchy = result.stiffness;
  if (result.effects.prestress) add_stress_at_rest((1 / result.area) * sums.at_rest, result);
  for (std::size_t k = 0; k < 3; ++k)
    result.fluctuations.push_back(disc_motions(network.unknowns, cases[k].motion.high));
  result.times.add("stiffness", watch.lap());
  result.unknowns = network.free_count;
  if (network.may_be_indefinite) result.negative_pivots = result.unstable_modes = std::nullopt;
  result.self_stresses = std::nullopt;
  result.solver = solver.name();
  result.factor_bytes = solver.grid_bytes();
  if (const auto weak = result.judge_strains(1e-12)) {
    bad_input("the network is floppy", *weak + " costs no energy beyond rounding",
              "It has no modulus. Add contacts, or give the contacts tangential springs (kT > 0)");
  }
  return result;
}

}  // namespace equidem::petsc
