// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/load_vector.hpp"

#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

void check_load(const Load& load) {
  for (const double value : {load.force.x, load.force.y, load.moment}) {
    if (!std::isfinite(value)) {
      bad_input(fmt::format("the load on '{}' has the value {}", load.group, value), "a load must be finite",
                "Give a number");
    }
  }
}

}  // namespace

std::vector<double> assemble_loads(const Assembly& assembly, const DegreesOfFreedom& unknowns, const LoadCase& loads) {
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  std::vector<double> f(assembly.size() * b, 0.0);
  for (const Load& load : loads) {
    check_load(load);
    const DiscGroup& discs = group(assembly, load.group);
    if (discs.discs.empty()) {
      bad_input(fmt::format("a load acts on the group '{}', which is empty", load.group),
                "there is no disc to carry it", "Choose a group with discs or mend its definition");
    }
    if (load.kind == LoadKind::traction && discs.tributary_lengths.empty()) {
      bad_input(fmt::format("a traction acts on the group '{}'", load.group),
                "it is no side of the assembly and has no length",
                "Use kind = \"per_disc\" or \"total\", or one of the groups left, right, bottom, top");
    }
    if (load.moment != 0 && b != 3) {
      bad_input(fmt::format("a moment acts on the group '{}'", load.group), "rotations are no unknowns of this scene",
                "Remove the moment, or let rotation = \"free\" with tangential springs");
    }
    const double share = load.kind == LoadKind::total ? 1.0 / static_cast<double>(discs.discs.size()) : 1.0;
    for (std::size_t k = 0; k < discs.discs.size(); ++k) {
      const double weight = load.kind == LoadKind::traction ? discs.tributary_lengths[k] : share;
      const std::size_t disc = discs.discs[k];
      f[disc * b] += weight * load.force.x;
      f[disc * b + 1] += weight * load.force.y;
      if (b == 3) f[disc * b + 2] += share * load.moment / unknowns.rotation_scale;
    }
  }
  return f;
}

std::vector<double> assemble_loads(const DegreesOfFreedom& unknowns, std::span<const DiscForce> loads) {
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  std::vector<double> f(loads.size() * b, 0.0);
  for (std::size_t d = 0; d < loads.size(); ++d) {
    const auto& [force, moment] = loads[d];
    if (!std::isfinite(force.x) || !std::isfinite(force.y) || !std::isfinite(moment))
      bad_input(fmt::format("the load on disc {} is not finite", d), "no motion could balance it", "Give a number");
    if (moment != 0 && b != 3)
      bad_input(fmt::format("a moment acts on disc {}", d), "rotations are no unknowns of this scene",
                "Remove the moment, or let rotation = \"free\" with tangential springs");
    f[d * b] = force.x;
    f[d * b + 1] = force.y;
    if (b == 3) f[d * b + 2] = moment / unknowns.rotation_scale;
  }
  return f;
}

void check_inert_loads(const Assembly& assembly, const DegreesOfFreedom& unknowns, std::span<const double> f) {
  if (unknowns.per_disc != 3 || unknowns.rotations_without_stiffness == 0) return;
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    if (f[3 * d + 2] == 0 || unknowns.held[3 * d + 2] != DegreesOfFreedom::without_stiffness) continue;
    bad_input(
        fmt::format("a moment acts on disc {}", d),
        "none of its contacts has a tangential spring and a lever arm, or lies off the line of centres, to resist it",
        "Remove the moment, hold the rotation of the disc, or give a contact of it kT != 0");
  }
}

}  // namespace equidem
