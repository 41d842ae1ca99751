// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/assemblies.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/text.hpp"

namespace equidem::test {
namespace {

/// A contact whose point divides the branch as the radii do, seen from disc i.
void join(Assembly& assembly, std::int32_t i, std::int32_t j, std::int32_t shift_x = 0, std::int32_t shift_y = 0) {
  Contact contact{i, j, shift_x, shift_y, 0, 0};
  const double length = norm(assembly.branch(contact));
  const double share = assembly.radii[i] / (assembly.radii[i] + assembly.radii[j]);
  contact.lever_i = share * length;
  contact.lever_j = length - contact.lever_i;
  assembly.contacts.push_back(contact);
}

Assembly discs_in_cell(Vec2 period, std::vector<Vec2> centres, std::vector<double> radii) {
  Assembly assembly;
  assembly.kind = "hand-made";
  assembly.centres = std::move(centres);
  assembly.radii = std::move(radii);
  assembly.period = period;
  return assembly;
}

/// One disc that touches its own images along x, along y and along a diagonal.
Assembly cell_of_one() {
  Assembly cell = discs_in_cell({0.01, 0.012}, {{0.002, 0.003}}, {0.005});
  join(cell, 0, 0, 1, 0);
  join(cell, 0, 0, 0, 1);
  join(cell, 0, 0, 1, 1);
  return cell;
}

/// The hexagonal lattice in its smallest rectangular cell: the two discs touch four times, and each its own image.
Assembly cell_of_two() {
  const double h = std::numbers::sqrt3;
  Assembly cell = discs_in_cell({1, h}, {{0.1, 0.2}, {0.6, 0.2 + h / 2}}, {0.5, 0.5});
  join(cell, 0, 0, 1, 0);
  join(cell, 1, 1, -1, 0);
  join(cell, 0, 1, 0, 0);
  join(cell, 1, 0, 1, 0);
  join(cell, 0, 1, 0, -1);
  join(cell, 1, 0, 1, 1);
  return cell;
}

/// Three discs of different radii, some pairs of which touch inside the cell and through its period.
Assembly cell_of_three() {
  Assembly cell = discs_in_cell({3, 2.5}, {{0.4, 0.3}, {1.6, 0.7}, {1.1, 1.7}}, {0.7, 0.5, 0.9});
  join(cell, 0, 1);
  join(cell, 1, 2);
  join(cell, 2, 0);
  join(cell, 1, 0, 1, 0);
  join(cell, 2, 0, 0, 1);
  join(cell, 2, 1, 0, 1);
  join(cell, 0, 2, -1, 0);
  join(cell, 2, 0, 1, 1);
  join(cell, 1, 1, 1, 0);
  return cell;
}

/// Two discs in line that touch between them and through the period: two contacts of one pair.
Assembly pair_touching_twice() {
  Assembly cell = discs_in_cell({0.04, 0.03}, {{0.01, 0.01}, {0.03, 0.01}}, {0.01, 0.01});
  join(cell, 0, 1);
  join(cell, 1, 0, 1, 0);
  return cell;
}

Assembly random_assembly(PointProcess points, bool periodic, bool equal) {
  return delaunay_assembly({.discs = 48,
                            .points = points,
                            .disorder = 0.2,
                            .seed = 7,
                            .radii = {.smallest = 0.004, .largest = equal ? 0.004 : 0.006},
                            .aspect = 1.4,
                            .periodic = periodic});
}

void name_groups(Assembly& assembly) {
  auto& groups = assembly.groups;
  groups["anchor"].discs = {0};
  std::int32_t guide = 0;
  const auto distance = [&](std::int32_t disc) { return std::abs(assembly.centres[disc].x - assembly.centres[0].x); };
  for (std::int32_t disc = 0; disc < static_cast<std::int32_t>(assembly.size()); ++disc) {
    if (distance(disc) > distance(guide)) guide = disc;
    if (disc % 3 == 1) groups["a"].discs.push_back(disc);
    if (disc % 3 == 2) groups["b"].discs.push_back(disc);
  }
  groups["guide"].discs = {guide};
  for (const char* name : {"a", "b"}) {
    if (groups[name].discs.empty()) groups[name].discs = {0};
  }
  if (!assembly.facet_lengths.empty()) return;
  // Hand-made: any edge will do, as long as contacts differ.
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    assembly.facet_lengths.push_back(norm(assembly.branch(assembly.contacts[c])) * (0.3 + 0.1 * (c % 4)));
  }
}

std::vector<AssemblyKind> make_kinds() {
  std::vector<AssemblyKind> kinds;
  const auto add = [&](std::string name, Assembly assembly, bool triangulated, bool chain = false, bool loose = false) {
    name_groups(assembly);
    kinds.push_back({std::move(name), std::move(assembly), triangulated, chain, loose});
  };
  for (const bool periodic : {false, true}) {
    const std::string boundary = periodic ? ", periodic" : ", free";
    add("hexagonal" + boundary, hexagonal_lattice({.columns = 7, .rows = 6, .periodic = periodic}), true);
    add("square" + boundary, square_lattice({.columns = 7, .rows = 5, .periodic = periodic}), false);
    for (const PointProcess points :
         {PointProcess::poisson_disc, PointProcess::perturbed_hexagonal, PointProcess::uniform}) {
      for (const bool equal : {true, false}) {
        add("delaunay, " + to_string(points) + (equal ? ", equal radii" : ", radii 4 to 6 mm") + boundary,
            random_assembly(points, periodic, equal), true, false,
            points == PointProcess::uniform && !periodic);  // discs near a corner have a single contact
      }
    }
  }
  add("strip 2 x 200", hexagonal_lattice({.columns = 200, .rows = 2}), true);
  add("chain", chain_of_discs(12, 0.003), false, true);
  add("cell of one disc", cell_of_one(), true);
  add("cell of two discs", cell_of_two(), true);
  add("cell of three discs", cell_of_three(), true);
  add("pair touching twice", pair_touching_twice(), false, true);
  return kinds;
}

}  // namespace

Assembly chain_of_discs(int count, double radius) {
  Assembly chain;
  chain.kind = "chain";
  for (std::int32_t disc = 0; disc < count; ++disc) {
    chain.centres.push_back({2 * radius * disc, 0});
    chain.radii.push_back(radius);
    if (disc > 0) chain.contacts.push_back({disc - 1, disc, 0, 0, radius, radius});
  }
  chain.groups["first"].discs = {0};
  chain.groups["last"].discs = {count - 1};
  return chain;
}

const std::vector<AssemblyKind>& assembly_kinds() {
  static const std::vector<AssemblyKind> kinds = make_kinds();
  return kinds;
}

const AssemblyKind& assembly_kind(const std::string& name) {
  for (const AssemblyKind& kind : assembly_kinds()) {
    if (kind.name == name) return kind;
  }
  throw std::out_of_range("no assembly kind " + name);
}

std::vector<HeldScene> held_scenes() {
  std::vector<HeldScene> scenes;
  for (const AssemblyKind& kind : assembly_kinds()) {
    if (kind.loose) continue;
    for (const double ratio : {0.5, 0.0, -0.05}) {
      if (ratio == 0 && !kind.triangulated) continue;
      for (const Rotation rotation : {Rotation::free, Rotation::restrained}) {
        if (rotation == Rotation::free && kind.chain) continue;
        if (rotation == Rotation::restrained && ratio == 0) continue;
        for (const SpringWeighting weighting : {SpringWeighting::uniform, SpringWeighting::voronoi}) {
          scenes.push_back({fmt::format("{}, kT/kN = {}, rotation {}, {}", kind.name, ratio,
                                        rotation == Rotation::free ? "free" : "restrained", to_string(weighting)),
                            kind,
                            contact_springs(kind.assembly, {1e9, ratio * 1e9}, weighting),
                            {.rotation = rotation, .solver = {}},
                            {{.group = "anchor", .ux = 0.0, .uy = 0.0, .rotation = 0.0}}});
          if (kind.assembly.periodic()) continue;
          scenes.back().supports.push_back({.group = "guide", .ux = {}, .uy = 0.0, .rotation = {}});
        }
      }
    }
  }
  return scenes;
}

}  // namespace equidem::test
