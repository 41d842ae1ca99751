// SPDX-License-Identifier: GPL-3.0-or-later
#include "petsc/equilibrium.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/statics/loads.hpp"

namespace equidem::petsc {
PartSolver::PartSolver(const Ranks& ranks, const Part& part, const Whole& whole, const ContactSprings& springs,
                       const Effects& effects, std::span<const Support> supports, SolverMethod method,
                       bool known_to_be_held)
    : effects_(effects), network_(ranks, part, whole, springs, effects, supports) {
  Stopwatch watch;
  if (!known_to_be_held) check_held(network_, effects);
  times_.add("check", watch.lap());
  solver_.emplace(network_, method, times_);
}

std::vector<double> PartSolver::assemble(const LoadCase& loads) const {
  std::vector<double> f(network_.size(), 0.0);
  for (const Load& load : loads) {
    const auto found = network_.whole().groups.find(load.group);
    const DiscGroup& discs = group(network_.assembly(), load.group);
    add_load(load, discs, found == network_.whole().groups.end() ? 0 : found->second, network_.unknowns(), f);
  }
  check_inert_loads(network_.assembly(), network_.unknowns(), f);
  return f;
}

PartEquilibrium PartSolver::solve(const LoadCase& loads) {
  PartEquilibrium result;
  Equilibrium& state = result.state;
  std::vector<double> f;
  network_.ranks().together([&] { f = assemble(loads); });
  Stopwatch watch;
  const Refined refined = refine(network_, *solver_, f, {});
  state.times = times_;
  state.times.add("solve", watch.lap());
  describe(loads, f, refined, result);
  state.times.add("forces", watch.lap());
  state.solver = solver_->name();
  state.factor_bytes = solver_->grid_bytes();
  state.unknowns = network_.free_count();
  state.negative_pivots = state.unstable_modes = network_.any_negative() ? -1 : 0;
  return result;
}

void PartSolver::describe(const LoadCase& loads, std::span<const double> f, const Refined& refined,
                          PartEquilibrium& result) {
  const Ranks& ranks = network_.ranks();
  const Assembly& assembly = network_.assembly();
  const DegreesOfFreedom& unknowns = network_.unknowns();
  const std::size_t b = network_.block();
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
  contact_forces_of(assembly, network_.springs(), unknowns, refined.motion, state.contact_forces);
  const std::vector<double> internal = network_.internal(state.contact_forces);
  double sums[6] = {0, 0, 0, 0, 0, 0};  // energy, moments, stress
  for (std::size_t d = 0; d < static_cast<std::size_t>(network_.part().owned); ++d) {
    const auto held = [&](std::size_t k) { return unknowns.held[d * b + k] != 0; };
    const auto reaction = [&](std::size_t k) { return held(k) ? internal[d * b + k] - f[d * b + k] : 0.0; };
    if (!held(0) && !held(1) && !(b == 3 && reaction(2) != 0)) continue;
    const double moment = b == 3 ? reaction(2) * unknowns.rotation_scale : 0.0;
    sums[1] += moment;
    state.reactions.push_back({static_cast<std::int32_t>(d), {reaction(0), reaction(1)}, moment});
  }
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const ContactFrame frame = frame_of(assembly, c);
    const ContactForce& force = state.contact_forces[c];
    const SpringConstants springs = network_.springs()[c];
    sums[0] += linear_spring_energy_of(springs, force);
    if (effects_.restrained) sums[1] -= moment_on_i(frame, force) + moment_on_j(frame, force);
    const Tensor2 work = force_by_branch(frame, force);
    sums[2] += work.xx, sums[3] += work.xy, sums[4] += work.yx, sums[5] += work.yy;
    const Contact& contact = assembly.contacts[c];
    const double radii = assembly.radii[contact.i] + assembly.radii[contact.j];
    if (springs.kN != 0)
      result.largest_deformation = std::max(result.largest_deformation, std::abs(force.normal / springs.kN) / radii);
  }
  ranks.sum(sums);
  result.largest_deformation = ranks.largest(result.largest_deformation);
  state.energy = sums[0];
  const double area = network_.whole().area;
  if (!(area > 0)) return;
  for (const Load& load : loads) {
    const double times =
        load.kind == LoadKind::total ? 1.0 : static_cast<double>(network_.whole().groups.at(load.group));
    sums[1] += times * load.moment;
  }
  result.moment_per_area = sums[1] / area;
  result.stress = (1 / area) * Tensor2{sums[2], sums[3], sums[4], sums[5]};
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
  const Part& part = network.part();
  for (std::size_t d = 0; d < static_cast<std::size_t>(part.owned); ++d) {
    for (const std::size_t end : {std::size_t{0}, std::size_t{1}}) {
      if (part.names[d] != (end == 0 ? gauge.first : gauge.second)) continue;
      const Vec2 x = part.assembly.centres[d], u = equilibrium.state.motions[d].u;
      ends[4 * end] = x.x, ends[4 * end + 1] = x.y, ends[4 * end + 2] = u.x, ends[4 * end + 3] = u.y;
    }
  }
  network.ranks().sum(ends);
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
  const Assembly& assembly = network.assembly();
  const Ranks& ranks = network.ranks();
  const Rectangle inner = inner_half(network.whole().extents, network.whole().mean_branch);
  const Vec2 middle = 0.5 * (inner.low + inner.high), half = 0.5 * (inner.high - inner.low);
  const auto owned = static_cast<std::size_t>(network.part().owned);
  const Tensor2 fitted = fitted_displacement_gradient(
      assembly, equilibrium.state.motions,
      [&](std::size_t disc) {
        const Vec2 d = assembly.centres[disc] - middle;
        return disc < owned && std::abs(d.x) <= half.x && std::abs(d.y) <= half.y;
      },
      [&](std::span<double> sums) { ranks.sum(sums); });
  double normal = 0;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) normal += network.springs()[c].kN;
  const double mean = ranks.sum(normal) / static_cast<double>(network.whole().contacts);
  return tension_result(test, strain_of(network, equilibrium, setup.horizontal),
                        strain_of(network, equilibrium, setup.vertical),
                        network.springs().uniform() ? network.springs()[0].kN : mean, fitted);
}

}  // namespace equidem::petsc
