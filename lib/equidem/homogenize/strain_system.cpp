// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/strain_system.hpp"

#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/homogenize/sample_solver.hpp"
#include "equidem/statics/load_bearing.hpp"
#include "equidem/statics/mechanisms.hpp"

namespace equidem {

LinearSystem strain_system(const Assembly& assembly, const ContactSprings& springs, Rotation rotation) {
  check(assembly);
  if (!assembly.periodic())
    bad_input("the assembly is not periodic", "a mean strain moves the images of a periodic cell",
              "Take a periodic assembly, or give supports and loads");
  const Effects effects = derive_effects(assembly, springs, rotation);
  const LoadBearingNetwork bearing = load_bearing_network(assembly, springs, effects);
  if (bearing.pieces == 0)
    bad_input("no piece of the network spans the cell", "nothing resists a mean strain", "Add contacts");
  const Assembly& network = bearing.part ? bearing.part->assembly : assembly;
  const ContactSprings& its_springs = bearing.part ? bearing.part->springs : springs;
  const ContactGraph graph(network);
  DegreesOfFreedom unknowns = number_unknowns(network, its_springs, effects, {});
  hold_free_motions(network, graph, its_springs, unknowns);
  std::vector<RightHandSide> cases(effects.restrained ? 4 : 3);
  for (std::size_t k = 0; k < cases.size(); ++k) cases[k].gradient = unit_gradients[k];
  LinearSystem system = linear_system({network, graph, its_springs, unknowns}, cases);
  if (bearing.part) system.discs = bearing.part->discs;
  system.names = {"strain xx", "strain yy", "strain xy", "rotation"};
  system.names.resize(cases.size());
  return system;
}

}  // namespace equidem
