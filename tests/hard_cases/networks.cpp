// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Networks that are singular, or nearly, for the way in which their discs are joined: few discs, few contacts, points
/// of which four and more lie on every circle.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/mechanisms.hpp"

#include "hard_cases/ledger.hpp"
#include "support/assemblies.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

Problem pulled_block(Assembly block) {
  return {std::move(block),
          usual_springs,
          {{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = {}}},
          {{.group = "right", .kind = LoadKind::per_disc, .force = {1000, 300}, .moment = 0.1}}};
}

/// A diagonal contact across one square.
void close_odd_ring(Assembly& assembly, int columns) {
  const double length = norm(assembly.centres[columns + 1] - assembly.centres[0]);
  assembly.contacts.push_back({0, columns + 1, 0, 0, 0.5 * length, 0.5 * length});
  assembly.facet_lengths.clear();
}

}  // namespace

TEST_CASE("one_odd_ring_decides_whether_the_discs_of_a_square_lattice_turn_like_gears") {
  HardCase table(
      {.name = "a bipartite network, and the same with one odd ring",
       .why = "without odd rings all discs counter-rotate at no cost; a single one holds hundreds of discs"});
  const int n = 24;
  Assembly block = square_lattice({.columns = n, .rows = n});
  const Answer geared = solve(pulled_block(block));
  table.refused("solve without", geared, {"counter-rotate like gears", "bipartite", "odd ring"});
  Problem held = pulled_block(block);
  held.supports.push_back({.group = "bottom_left", .ux = {}, .uy = {}, .rotation = 0.0});
  table.right("solve without, one rotation held", solve(held), 1e-12);
  close_odd_ring(block, n);
  table.right("solve with", solve(pulled_block(block)), 1e-12);

  Assembly cell = square_lattice({.columns = 6, .rows = 6, .periodic = true});
  table.right("homogenize without",
              homogenize(cell, usual_springs, Rotation::from_scene, {{{1e9, 0, 0}, {0, 1e9, 0}, {0, 0, 0.2e9}}}),
              1e-13);
  close_odd_ring(cell, 6);
  table.right("homogenize with", homogenize(cell, usual_springs), 1e-12);
}

TEST_CASE("a_single_chain_is_right_where_it_is_held_and_has_no_modulus") {
  HardCase table(
      {.name = "a single chain", .why = "a tree of contacts: discs roll on one another, and nothing is redundant"});
  const Assembly chain = chain_of_discs(50, 0.01);
  const LoadCase pull{{.group = "last", .kind = LoadKind::total, .force = {1000, 100}}};
  const auto hold = [](std::optional<double> rotation) {
    return std::vector<Support>{{.group = "first", .ux = 0.0, .uy = 0.0, .rotation = rotation}};
  };
  table.refused("solve, rotations free", solve({chain, usual_springs, hold({}), pull}), {"rotation about", "Hold"});
  table.refused("solve, one rotation held", solve({chain, usual_springs, hold(0.0), pull}), {"rotation about", "Hold"});
  table.right("solve, rotations restrained", solve({chain, usual_springs, hold({}), pull, Rotation::restrained}),
              1e-12);
  Assembly periodic = square_lattice({.columns = 8, .rows = 1, .periodic = true});
  std::erase_if(periodic.contacts, [](const Contact& c) { return c.shift_y != 0; });
  periodic.facet_lengths.clear();
  table.refused("homogenize", homogenize(periodic, usual_springs), {"one direction only", "Add contacts"});
}

TEST_CASE("a_rattler_inside_a_ring_is_named_or_left_out") {
  HardCase table({.name = "a rattler inside a ring", .why = "a disc that touches nothing leaves rows of zeros in K"});
  Assembly cell = hexagonal_lattice({.columns = 6, .rows = 6, .periodic = true});
  const std::int32_t loose = 14;
  const auto remove = [&](Assembly& assembly) {
    std::erase_if(assembly.contacts, [&](const Contact& c) { return c.i == loose || c.j == loose; });
    assembly.facet_lengths.clear();
  };
  remove(cell);
  table.right("homogenize", homogenize(cell, usual_springs), 1e-12);
  const EffectiveStiffness result = effective_stiffness(cell, usual_springs);
  CHECK(result.rattlers == 1);
  REQUIRE(result.removed.size() == 1);
  CHECK(result.removed[0].find("disc 14") != std::string::npos);
  Assembly block = hexagonal_lattice({.columns = 6, .rows = 6});
  remove(block);
  table.refused("solve", solve(pulled_block(block)), {"disc 14", "no contacts", "Hold it, remove it"});
}

TEST_CASE("contacts_at_the_centre_of_a_disc_are_right") {
  HardCase table({.name = "lever arms of zero",
                  .why = "a contact at the centre of a disc does not turn it: some rotations have no stiffness, others "
                         "have only one side's"});
  for (const std::int32_t every : {1, 2, 3}) {  // discs whose contacts all lie at their centre
    CAPTURE(every);
    // Between two such discs the levers are both zero, or the contact lies in the middle.
    const auto without_levers = [&](Assembly assembly, bool both) {
      for (Contact& c : assembly.contacts) {
        const double length = norm(assembly.branch(c));
        const bool at_i = c.i % every == 0, at_j = c.j % every == 0;
        if (at_i && at_j) c.lever_i = c.lever_j = both ? 0 : 0.5 * length;
        if (at_i != at_j) c.lever_i = at_i ? 0 : length, c.lever_j = at_i ? length : 0;
      }
      return assembly;
    };
    Problem problem = pulled_block(without_levers(hexagonal_lattice({.columns = 5, .rows = 6}), true));
    problem.loads[0].moment = 0;
    table.right("solve", solve(problem), 1e-12);
    const Assembly cell = delaunay_assembly({.discs = 40, .periodic = true});
    table.right("homogenize", homogenize(without_levers(cell, false), usual_springs), 1e-12);
    table.refused("homogenize, levers that do not add up", homogenize(without_levers(cell, true), usual_springs),
                  {"has the lever arms 0 and 0 m", "Correct the levers"});
  }
}

TEST_CASE("a_train_of_gears_of_a_million_to_one_is_right") {
  HardCase table(
      {.name = "a gear train of ratio 1e6",
       .why = "one motion turns the last disc a million times as far as the first, whose rotation holds it"});
  Assembly train;
  double x = 0;
  for (int d = 0; d < 13; ++d) {
    const double radius = std::pow(10.0, -0.5 * d);
    if (d > 0) x += train.radii.back() + radius;
    train.centres.push_back({x, 0});
    train.radii.push_back(radius);
    if (d > 0) train.contacts.push_back({d - 1, d, 0, 0, train.radii[d - 1], radius});
    train.groups["all"].discs.push_back(d);
  }
  train.groups["first"].discs = {0};
  train.groups["last"].discs = {12};
  const LoadCase twist{{.group = "last", .kind = LoadKind::total, .force = {}, .moment = 1e-3}};
  const Support pinned{.group = "all", .ux = 0.0, .uy = 0.0, .rotation = {}};
  const Support locked{.group = "first", .ux = {}, .uy = {}, .rotation = 0.0};
  table.right("solve", solve({train, usual_springs, {pinned, locked}, twist}), 1e-11);
  table.refused("solve, none locked", solve({train, usual_springs, {pinned}, twist}),
                {"gears", "Hold the rotation of one"});
}

namespace {

double difference(const Matrix3& a, const Matrix3& b) {
  return largest_entry(a + (-1.0) * b) / largest_entry(b);
}

void check_small_cells(HardCase& table, double ratio, Rotation rotation) {
  const ContactSprings k(SpringConstants{1e9, ratio * 1e9});
  for (int discs = 1; discs <= 3; ++discs) {
    if (ratio < 0 && discs == 1) continue;  // two contacts around one disc: the square network, unstable for kT < 0
    for (const std::uint64_t seed : {1, 2, 3}) {
      const Assembly cell =
          delaunay_assembly({.discs = discs, .points = PointProcess::uniform, .seed = seed, .periodic = true});
      CAPTURE(discs, seed, cell.size(), cell.contacts.size());
      table.right("homogenize", homogenize(cell, k, rotation), 1e-12);
    }
  }
  for (const int columns : {1, 3}) {
    if (ratio < 0) continue;
    const Assembly square = square_lattice({.columns = columns, .rows = 1, .periodic = true});
    const Matrix3 exact{{{1e9, 0, 0}, {0, 1e9, 0}, {0, 0, ratio * 0.5e9}}};  // F2
    table.right("homogenize", homogenize(square, k, rotation, exact), 1e-13);
  }
  const Assembly hexagonal = hexagonal_lattice({.columns = 1, .rows = 2, .periodic = true});
  const double root = 0.86602540378443865;
  const Matrix3 exact = isotropic_stiffness(root * 1e9, root / 2 * (1 + ratio) * 1e9);  // F1
  table.right("homogenize", homogenize(hexagonal, k, rotation, exact), 1e-13);
}

}  // namespace

TEST_CASE("cells_of_one_two_and_three_discs_are_right") {
  HardCase table({.name = "a cell of one, two, three discs",
                  .why = "discs touch their own images through the period, and one neighbour several times"});
  for (const double ratio : {0.4, 1.0, -0.02}) {
    for (const Rotation rotation : {Rotation::from_scene, Rotation::restrained}) {
      CAPTURE(ratio, rotation == Rotation::restrained);
      check_small_cells(table, ratio, rotation);
    }
  }
}

TEST_CASE("two_discs_that_touch_twice_are_right_or_named") {
  HardCase table(
      {.name = "two discs touching twice",
       .why =
           "two blocks of K fall on one another; the ring of two contacts is even, and closes only for equal levers"});
  Assembly pair = chain_of_discs(2, 0.5);
  pair.contacts.push_back(pair.contacts[0]);
  const std::vector<Support> held{{.group = "first", .ux = 0.0, .uy = 0.0, .rotation = 0.0},
                                  {.group = "last", .ux = {}, .uy = 0.0, .rotation = {}}};
  const LoadCase loads{{.group = "last", .kind = LoadKind::total, .force = {1000, 0}, .moment = 7}};
  table.right("solve", solve({pair, usual_springs, held, loads}), 1e-13);
  const Equilibrium state = solve_equilibrium(pair, usual_springs, held, loads);
  CHECK(state.motions[1].u.x == Approx(1000 / 2e9).epsilon(1e-14));
  CHECK(state.motions[1].theta == Approx(7 / (2 * 0.4e9 * 0.25)).epsilon(1e-14));

  const std::vector<Support> pinned{{.group = "first", .ux = 0.0, .uy = 0.0, .rotation = {}},
                                    {.group = "last", .ux = {}, .uy = 0.0, .rotation = {}}};
  table.refused("solve, rotations free", solve({pair, usual_springs, pinned, loads}),
                {"gears", "odd ring", "Hold the rotation"});
  pair.contacts[0].lever_i = 0.3, pair.contacts[0].lever_j = 0.7;  // turns 7:3 at one contact, 1:1 at the other
  table.right("solve, levers that differ", solve({pair, usual_springs, pinned, loads}), 1e-12);

  Assembly cell = delaunay_assembly({.discs = 2, .points = PointProcess::uniform, .seed = 4, .periodic = true});
  const Matrix3 once = effective_stiffness(cell, ContactSprings(SpringConstants{2e9, 0.8e9})).stiffness;
  const std::vector<Contact> contacts = cell.contacts;
  cell.contacts.insert(cell.contacts.end(), contacts.begin(), contacts.end());
  cell.facet_lengths.clear();
  table.right("homogenize", homogenize(cell, usual_springs), 1e-13);
  CHECK(difference(effective_stiffness(cell, usual_springs).stiffness, once) < 1e-14);
}

namespace {

/// Motions (u_x, u_y of every disc) that stretch no contact: unknowns less the rank of the directions of the contacts,
/// by elimination with the largest pivot of all.
std::int64_t motions_without_stretch(const Assembly& assembly) {
  const std::size_t columns = 2 * assembly.size(), rows = assembly.contacts.size();
  std::vector<double> a(rows * columns, 0.0);
  for (std::size_t c = 0; c < rows; ++c) {
    const Contact& contact = assembly.contacts[c];
    const Vec2 branch = assembly.branch(contact), n = branch / norm(branch);
    a[c * columns + 2 * contact.i] -= n.x, a[c * columns + 2 * contact.i + 1] -= n.y;
    a[c * columns + 2 * contact.j] += n.x, a[c * columns + 2 * contact.j + 1] += n.y;
  }
  std::size_t rank = 0;
  for (; rank < std::min(rows, columns); ++rank) {
    std::size_t row = rank, column = rank;
    for (std::size_t r = rank; r < rows; ++r)
      for (std::size_t c = rank; c < columns; ++c)
        if (std::abs(a[r * columns + c]) > std::abs(a[row * columns + column])) row = r, column = c;
    constexpr double zero = 1e-9;
    if (std::abs(a[row * columns + column]) < zero) break;
    for (std::size_t c = 0; c < columns; ++c) std::swap(a[row * columns + c], a[rank * columns + c]);
    for (std::size_t r = 0; r < rows; ++r) std::swap(a[r * columns + column], a[r * columns + rank]);
    for (std::size_t r = rank + 1; r < rows; ++r) {
      const double factor = a[r * columns + rank] / a[rank * columns + rank];
      if (factor == 0) continue;
      for (std::size_t c = rank; c < columns; ++c) a[r * columns + c] -= factor * a[rank * columns + c];
    }
  }
  return static_cast<std::int64_t>(columns - rank);
}

Assembly square_grid(int n) {
  Assembly grid;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) grid.centres.push_back({0.01 * x + 0.005, 0.01 * y + 0.005});
  grid.radii.assign(grid.centres.size(), 0.005);
  grid.period = Vec2{0.01 * n, 0.01 * n};
  return grid;
}

}  // namespace

TEST_CASE("near_the_onset_of_rigidity_floppy_motions_are_counted_as_the_rank_tells") {
  HardCase table(
      {.name = "bond dilution near p_c = 0.66",
       .why = "a triangular lattice of central springs has as many contacts as it needs at p = 2/3: one contact "
              "decides whether a piece is floppy"});
  const ContactSprings central(SpringConstants{1e9, 0});
  constexpr int cells = 8, n = 10;
  for (const double p : {0.6, 0.64, 0.66, 0.68, 0.72}) {
    int agree = 0, rigid = 0;
    std::int64_t floppy = 0;
    Random random(7);
    for (int k = 0; k < cells; ++k) {
      Assembly cell = hexagonal_lattice({.columns = n, .rows = n, .periodic = true});
      std::erase_if(cell.contacts, [&](const Contact&) { return random.uniform() >= p; });
      cell.facet_lengths.clear();
      const std::int64_t known = motions_without_stretch(cell);
      const MechanismReport found = find_mechanisms(cell, central, Rotation::from_scene, {});
      const std::int64_t counted = found.rigid_motions + found.free_pieces + found.gears + found.others;
      CAPTURE(p, k, known, counted);
      CHECK(counted == known);
      agree += counted == known ? 1 : 0;
      rigid += known == 2 ? 1 : 0;
      floppy += known - 2;
    }
    table.note(fmt::format("stability, {} cells of {} discs, p = {}", cells, n * n, p),
               "as many zero-energy modes as by rank",
               fmt::format("{} of {} as by rank; {} rigid, {:.1f} floppy motions in the mean", agree, cells, rigid,
                           static_cast<double>(floppy) / cells));
  }
}

TEST_CASE("points_on_a_square_grid_have_the_contacts_and_the_moduli_of_the_lattice") {
  HardCase table({.name = "cocircular points",
                  .why = "every four neighbours of a square grid lie on one circle: the triangulation may take either "
                         "diagonal, and neither is a contact"});
  const Matrix3 exact{{{1e9, 0, 0}, {0, 1e9, 0}, {0, 0, 0.2e9}}};
  for (const double moved : {0.0, 1e-16, 1e-14}) {  // of the spacing: round-off of other coordinates
    Assembly grid = square_grid(12);
    Random random(3);
    for (Vec2& x : grid.centres) x += 0.01 * moved * Vec2{random.uniform(-1, 1), random.uniform(-1, 1)};
    triangulate(grid);
    CAPTURE(moved, grid.contacts.size());
    CHECK(grid.contacts.size() == 2 * grid.size());
    table.right("homogenize, grid and grid moved by round-off",
                homogenize(grid, usual_springs, Rotation::from_scene, exact), 1e-10);
  }
}
