// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Small assemblies of every kind, for tests with one body over all of them, and scenes in which they are held.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/statics/equilibrium.hpp"
#include "equidem/statics/loads.hpp"

namespace equidem::test {

/// Every kind has facet lengths, contacts whose levers add up to their branch, and the groups "anchor" (disc 0), "a"
/// and "b" (every third disc, from the second and the third on; disc 0 where there is none).
struct AssemblyKind {
  std::string name;
  Assembly assembly;
  bool triangulated = false;  ///< stands without tangential springs, held as a beam is
  bool chain = false;         ///< discs roll on one another unless rotation is restrained
  bool loose = false;         ///< some disc has too few contacts to be held: no scene
};

const std::vector<AssemblyKind>& assembly_kinds();
/// \throws std::out_of_range where there is none of that name
const AssemblyKind& assembly_kind(const std::string& name);

/// Discs of equal radius in a row along x, the first at the origin, each touching the next; groups "first", "last".
Assembly chain_of_discs(int count, double radius);

/// An assembly, its springs, and supports that leave K regular: "anchor" held, and where free "guide" along y.
struct HeldScene {
  std::string name;
  const AssemblyKind& kind;
  ContactSprings springs;
  EquilibriumOptions options;
  std::vector<Support> supports;

  [[nodiscard]] const Assembly& assembly() const { return kind.assembly; }
};

/// Every kind with free and with restrained rotation, kT/kN = 0.5, 0 (triangulated kinds) and -0.05, springs uniform
/// and weighted; kN = 1e9 Pa.
std::vector<HeldScene> held_scenes();

}  // namespace equidem::test
