// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/lattices.hpp"

#include <algorithm>

#include "equidem/assembly/lattices/row_lattice.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr Lattice known_lattices[] = {
    lattices::square,
    lattices::hexagonal,
};

}  // namespace

std::span<const Lattice> all_lattices() {
  return known_lattices;
}

const Lattice* find_lattice(std::string_view name) {
  const auto* found = std::find_if(std::begin(known_lattices), std::end(known_lattices),
                                   [&](const Lattice& l) { return name == l.name; });
  return found == std::end(known_lattices) ? nullptr : found;
}

const Lattice* lattice_of(const Assembly& assembly) {
  if (const Lattice* made = find_lattice(assembly.kind)) return made;
  if (assembly.size() == 0) return nullptr;
  const auto* found = std::ranges::find_if(known_lattices, [&](const Lattice& lattice) {
    return lattice.rows != nullptr && is_row_lattice(assembly, lattice.rows(assembly.radii.front()));
  });
  return found == std::end(known_lattices) ? nullptr : found;
}

std::string lattice_counts() {
  std::vector<std::string> sentences;
  for (const Lattice& lattice : known_lattices) {
    if (*lattice.counts != '\0') sentences.push_back(fmt::format("{}, {}", lattice.name, lattice.counts));
  }
  return joined(sentences, ". ");
}

}  // namespace equidem
