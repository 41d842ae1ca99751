// SPDX-License-Identifier: GPL-3.0-or-later
#include "left_out.hpp"

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/power_cells.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/contact/prestress/prestress_choice.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/load_bearing.hpp"

#include "prestressed.hpp"

namespace equidem {
namespace {

/// The sides and corners of a free assembly that were measured: those that its file does not give.
std::set<std::string> names_of_measured_sides(const Assembly& assembly) {
  std::set<std::string> names;
  if (assembly.periodic()) return names;
  for (const auto& [name, side] : measured_sides(assembly)) {
    const auto found = assembly.groups.find(name);
    if (found != assembly.groups.end() && found->second.discs == side.discs &&
        found->second.tributary_lengths == side.tributary_lengths)
      names.insert(name);
  }
  return names;
}

/// Holds bodies whose forces at rest do not balance: something outside loads them, which the case need not give.
void hold_loaded_at_rest(const Assembly& assembly, std::vector<std::uint8_t>& held) {
  const RestSums sums = sums_at_rest(assembly);
  for (std::size_t d = 0; d < held.size(); ++d)
    if (norm(sums.forces[d]) > largest_imbalance * sums.mean_force) held[d] = 1;
}

/// 1 for the bodies with a support or load of their own; on a measured side for those with two contacts or more where
/// it is supported, with three where it is loaded, since fewer may roll.
/// \param all those on measured sides too, whatever contacts they have
std::vector<std::uint8_t> held_by_the_case(const Problem& problem, bool all = false) {
  const Assembly& assembly = problem.assembly;
  std::vector<int> contacts(assembly.size(), 0);
  for (const Contact& c : assembly.contacts)
    ++contacts[static_cast<std::size_t>(c.i)], ++contacts[static_cast<std::size_t>(c.j)];
  // Sides are measured only where one could matter.
  const bool dangling = !all && std::ranges::any_of(contacts, [](int count) { return count <= 2; });
  const std::set<std::string> sides = dangling ? names_of_measured_sides(assembly) : std::set<std::string>{};
  std::vector<std::uint8_t> held(assembly.size(), 0);
  const auto hold = [&](const std::string& name, int enough) {
    const auto found = assembly.groups.find(name);
    if (found == assembly.groups.end()) return;
    for (const std::int32_t disc : found->second.discs) {
      const auto k = static_cast<std::size_t>(disc);
      if (contacts[k] >= enough || !sides.contains(name)) held[k] = 1;
    }
  };
  for (const Support& support : problem.resolved.supports) hold(support.group, 2);
  for (const NamedLoads& loads : problem.resolved.load_cases)
    for (const Load& load : loads.loads) hold(load.group, 3);
  if (prestress_counts(problem)) hold_loaded_at_rest(assembly, held);
  return held;
}

}  // namespace

void leave_out_loose(Problem& problem) {
  const AssemblyKind kind = problem.resolved.assembly.kind;
  if (kind != AssemblyKind::packing && kind != AssemblyKind::file) return;
  Assembly& assembly = problem.assembly;
  const Effects effects = derive_effects(assembly, problem.springs.springs, problem.resolved.rotation);
  LoadBearingNetwork network =
      load_bearing_network(assembly, problem.springs.springs, effects, held_by_the_case(problem), LeaveOut::loose);
  const auto none_left = [&] { return network.part && network.part->discs.empty(); };
  if (none_left()) {  // a row: its ends are what the case holds and loads
    network = load_bearing_network(assembly, problem.springs.springs, effects, held_by_the_case(problem, true),
                                   LeaveOut::loose);
  }
  if (!network.part) return;
  if (none_left())
    bad_input_at(problem.resolved.where("assembly"), "no body is held in place by the others and by supports",
                 joined(network.sentences, "; "),
                 "Hold or load bodies by a [[group]] of their own, take a larger gap_tolerance, or pack them denser");
  std::vector<std::uint8_t> kept(assembly.size(), 0);
  for (const std::int32_t disc : network.part->discs) kept[static_cast<std::size_t>(disc)] = 1;
  for (std::size_t disc = 0; disc < kept.size(); ++disc)
    if (!kept[disc]) problem.left_out.bodies.push_back(static_cast<std::int64_t>(disc));
  problem.left_out.sentences = std::move(network.sentences);
  if (Case& resolved = problem.resolved; resolved.material && resolved.assembly.body == Body::disc) {
    // The solid fraction, by which the density of the continuum gives that of the discs, is that of all of them.
    resolved.assembly.density = disc_density(resolved, assembly);
    resolved.material->given.density.reset();
  }
  const std::set<std::string> sides = names_of_measured_sides(assembly);
  Assembly rest = std::move(network.part->assembly);
  std::erase_if(rest.groups, [&](const auto& group) { return sides.contains(group.first); });
  measure_cells(rest);
  problem.springs.springs = std::move(network.part->springs);
  assembly = std::move(rest);
}

}  // namespace equidem
