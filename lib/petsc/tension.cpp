// SPDX-License-Identifier: GPL-3.0-or-later
#include "petsc/tension.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "equidem/core/error.hpp"

namespace equidem::petsc {
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
