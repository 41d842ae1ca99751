// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A million discs, against answers that are known exactly. By default the same bodies run with 3e4 discs.
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"

#include "hard_cases/ledger.hpp"
#include "hard_cases/oracle.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

const HardCase::Words many_discs{.name = "1e6 discs", .why = "three million unknowns; sums of millions of terms"};

/// A square lattice of unit discs, kN = 1, kT = 1/2, whose motions are small integers beside a uniform stretch: all
/// motions, deformations and forces are exact in doubles, and so is the load that belongs to them.
void solve_integers(HardCase& table, int n) {
  Problem problem{square_lattice({.columns = n, .rows = n, .radius = 0.5}),
                  ContactSprings(SpringConstants{1, 0.5}),
                  {{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = 0.0}},
                  {}};
  Assembly& assembly = problem.assembly;
  Random random(1);
  std::vector<double> exact(3 * assembly.size(), 0.0), force(exact.size(), 0.0);
  std::vector<char> held(assembly.size(), 0);
  for (const std::int32_t d : group(assembly, "left").discs) held[d] = 1;
  const auto draw = [&] { return static_cast<double>(random.below(5)) - 2; };
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    if (held[d] != 0) continue;
    exact[3 * d] = draw() + static_cast<double>(d % n);
    exact[3 * d + 1] = draw();
    exact[3 * d + 2] = draw();  // a theta, a = 1/2
  }
  for (const Contact& c : assembly.contacts) {
    const double *i = &exact[3 * c.i], *j = &exact[3 * c.j];
    const bool across = assembly.branch(c).x != 0;  // n = (1, 0), s = (0, 1); else n = (0, 1), s = (-1, 0)
    const double x = j[0] - i[0], y = j[1] - i[1], turn = i[2] + j[2];
    const double normal = across ? x : y, tangential = 0.5 * ((across ? y : -x) - turn);
    const double fx = across ? normal : -tangential, fy = across ? tangential : normal;
    force[3 * c.i] -= fx, force[3 * c.i + 1] -= fy, force[3 * c.i + 2] -= tangential;
    force[3 * c.j] += fx, force[3 * c.j + 1] += fy, force[3 * c.j + 2] -= tangential;
  }
  for (std::size_t k = 0; k < force.size(); ++k) {
    if (held[k / 3] != 0 || force[k] == 0) continue;
    const double value = k % 3 == 2 ? 0.5 * force[k] : force[k];  // moments over a
    const std::string name = fmt::format("{} {}", k % 3, value);
    DiscGroup& discs = assembly.groups[name];
    if (discs.discs.empty()) {
      problem.loads.push_back({.group = name,
                               .kind = LoadKind::per_disc,
                               .force = {k % 3 == 0 ? value : 0, k % 3 == 1 ? value : 0},
                               .moment = k % 3 == 2 ? value : 0});
    }
    discs.discs.push_back(static_cast<std::int32_t>(k / 3));
  }
  table.right(fmt::format("solve {} discs", assembly.size()), solve(problem, exact), 1e-11);
}

/// The cell, its coordinates rounded to a grid on which all images are exact, m times along x and y.
Assembly repeated(const Assembly& cell, int m) {
  Assembly result;
  result.period = Vec2{m * cell.period->x, m * cell.period->y};
  const auto count = static_cast<std::int32_t>(cell.size());
  const auto place = [&](int x, int y) { return (y * m + x) * count; };
  const auto floor_of = [m](int k) { return (k >= 0 ? k : k - m + 1) / m; };
  for (int y = 0; y < m; ++y) {
    for (int x = 0; x < m; ++x) {
      for (std::int32_t d = 0; d < count; ++d) {
        result.centres.push_back(cell.centres[d] + Vec2{x * cell.period->x, y * cell.period->y});
        result.radii.push_back(cell.radii[d]);
      }
      for (Contact c : cell.contacts) {
        const int to_x = x + c.shift_x, to_y = y + c.shift_y;
        c.shift_x = floor_of(to_x), c.shift_y = floor_of(to_y);
        c.i += place(x, y), c.j += place(to_x - m * c.shift_x, to_y - m * c.shift_y);
        result.contacts.push_back(c);
      }
    }
  }
  return result;
}

void homogenize_repeated(HardCase& table, int m) {
  Assembly cell = delaunay_assembly({.discs = 25, .periodic = true});
  const auto snap = [](double& x) { x = std::round(x * 0x1.0p26) * 0x1.0p-26; };
  for (Vec2& x : cell.centres) snap(x.x), snap(x.y);
  snap(cell.period->x), snap(cell.period->y);
  for (Contact& c : cell.contacts) c.lever_i = c.lever_j = 0.5 * norm(cell.branch(c));
  const ContactSprings springs(SpringConstants{1e9, 0.3e9});
  const Assembly large = repeated(cell, m);
  table.right(fmt::format("homogenize {} discs", large.size()),
              homogenize(large, springs, Rotation::from_scene, exact_stiffness(cell, springs, Rotation::from_scene)),
              1e-12);
}

}  // namespace

TEST_CASE("many_discs_are_right") {
  HardCase table(many_discs);
  solve_integers(table, 173);
  homogenize_repeated(table, 36);
}

TEST_CASE("a_million_discs_are_right", "[.large]") {
  HardCase table(many_discs);
  solve_integers(table, 1000);
  homogenize_repeated(table, 209);
}
