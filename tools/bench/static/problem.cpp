// SPDX-License-Identifier: GPL-3.0-or-later
#include "problem.hpp"

#include <cmath>
#include <utility>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/supports.hpp"

namespace equidem::bench {
namespace {

Assembly hexagonal(std::int64_t discs) {
  const auto rows = static_cast<int>(std::lround(std::sqrt(static_cast<double>(discs))));
  // Every other row is one disc short.
  const auto columns = static_cast<int>(std::lround(static_cast<double>(discs) / rows + 0.5));
  return hexagonal_lattice({.columns = columns, .rows = rows});
}

Assembly delaunay(std::int64_t discs) {
  return delaunay_assembly({.discs = discs});
}

struct Kind {
  const char* name;
  Assembly (*build)(std::int64_t discs);
};
constexpr Kind kinds[] = {{"hexagonal", hexagonal}, {"delaunay", delaunay}};

}  // namespace

std::vector<std::string> problem_kinds() {
  std::vector<std::string> names;
  for (const Kind& kind : kinds) names.emplace_back(kind.name);
  return names;
}

Problem build_problem(const std::string& kind, std::int64_t discs) {
  for (const Kind& known : kinds) {
    if (kind != known.name) continue;
    Problem problem{known.build(discs), ContactSprings(SpringConstants{.kN = 1e9, .kT = 0.5e9}), {}, {}};
    const Support left{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = 0.0};
    const Effects effects = derive_effects(problem.springs, Rotation::free);
    problem.unknowns = number_unknowns(problem.assembly, problem.springs, effects, {&left, 1});
    problem.load.assign(problem.unknowns.held.size(), 0.0);
    for (const std::int32_t disc : group(problem.assembly, "right").discs) {
      const double force[] = {1.0, -0.25};
      for (std::size_t k = 0; k < 2; ++k) {
        const std::size_t component = 3 * static_cast<std::size_t>(disc) + k;
        if (problem.unknowns.held[component] == 0) problem.load[component] = force[k];
      }
    }
    return problem;
  }
  bad_input(fmt::format("there is no kind '{}'", kind), "the kinds are hexagonal and delaunay", "Choose one");
}

}  // namespace equidem::bench
