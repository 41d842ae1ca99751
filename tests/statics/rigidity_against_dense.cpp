// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The judgement of check_rigidity from the contact graph agrees with the eigenvalues of the stiffness matrix.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <tuple>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/linear/stiffness_matrix.hpp"
#include "equidem/statics/rigidity.hpp"

#include "statics/random_bending.hpp"
#include "statics/rigidity_report.hpp"
#include "support/catch.hpp"

using namespace equidem;

namespace {

using Dense = std::vector<std::vector<double>>;

/// Eigenvalues of a symmetric matrix by cyclic Jacobi rotations, ascending.
std::vector<double> eigenvalues(Dense a) {
  const std::size_t n = a.size();
  for (int sweep = 0; sweep < 50; ++sweep) {
    double off = 0;
    double all = 0;
    for (std::size_t p = 0; p < n; ++p) {
      for (std::size_t q = 0; q < n; ++q) {
        all += a[p][q] * a[p][q];
        if (p != q) off += a[p][q] * a[p][q];
      }
    }
    if (off <= 1e-34 * all) break;
    for (std::size_t p = 0; p < n; ++p) {
      for (std::size_t q = p + 1; q < n; ++q) {
        if (a[p][q] == 0) continue;
        const double zeta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = std::copysign(1.0, zeta) / (std::abs(zeta) + std::sqrt(1 + zeta * zeta));
        const double c = 1 / std::sqrt(1 + t * t);
        for (std::size_t k = 0; k < n; ++k) {
          const double x = a[k][p];
          const double y = a[k][q];
          a[k][p] = c * (x - t * y);
          a[k][q] = c * (y + t * x);
        }
        for (std::size_t k = 0; k < n; ++k) {
          const double x = a[p][k];
          const double y = a[q][k];
          a[p][k] = c * (x - t * y);
          a[q][k] = c * (y + t * x);
        }
      }
    }
  }
  std::vector<double> values(n);
  for (std::size_t k = 0; k < n; ++k) values[k] = a[k][k];
  std::sort(values.begin(), values.end());
  return values;
}

/// Zero eigenvalues of a positive semi-definite matrix whose stiffnesses are of the order of 1; none may lie where
/// zero or not is in doubt.
std::int64_t nullity(const Dense& a) {
  std::int64_t zero = 0;
  for (const double value : eigenvalues(a)) {
    if (value <= 1e-12) {
      ++zero;
    } else {
      CHECK(value > 1e-8);
    }
  }
  return zero;
}

struct RandomScene {
  Assembly assembly;
  ContactSprings springs{SpringConstants{}};
  DegreesOfFreedom unknowns;
};

/// K without supports, dense.
Dense dense_stiffness(const RandomScene& scene) {
  DegreesOfFreedom all = scene.unknowns;
  std::fill(all.held.begin(), all.held.end(), std::uint8_t{0});
  const StiffnessMatrix K = assemble_stiffness(scene.assembly, ContactGraph(scene.assembly), scene.springs, all);
  const std::size_t b = K.block;
  Dense dense(all.held.size(), std::vector<double>(all.held.size(), 0.0));
  for (std::size_t d = 0; d < scene.assembly.size(); ++d) {
    for (std::size_t r = 0; r < b; ++r) {
      for (std::size_t c = 0; c < b; ++c) dense[d * b + r][d * b + c] += K.diagonal_block(d)[r * b + c];
    }
  }
  for (std::size_t k = 0; k < scene.assembly.contacts.size(); ++k) {
    const std::size_t i = scene.assembly.contacts[k].i;
    const std::size_t j = scene.assembly.contacts[k].j;
    if (i == j) continue;
    for (std::size_t r = 0; r < b; ++r) {
      for (std::size_t c = 0; c < b; ++c) {
        const double value = K.coupling_block(k)[r * b + c];
        dense[i * b + r][j * b + c] += value;
        dense[j * b + c][i * b + r] += value;
      }
    }
  }
  return dense;
}

/// Zero eigenvalues of K over the components that are not held.
std::int64_t zero_modes(const RandomScene& scene, const Dense& K) {
  Dense free;
  for (std::size_t p = 0; p < K.size(); ++p) {
    if (scene.unknowns.held[p] != 0) continue;
    free.emplace_back();
    for (std::size_t q = 0; q < K.size(); ++q) {
      if (scene.unknowns.held[q] == 0) free.back().push_back(K[p][q]);
    }
  }
  return nullity(free);
}

/// A disc and the cell of the periodic plane in which it is met.
using Image = std::tuple<int, int, int>;

/// All images that contacts join to an image, followed across a few periods in the plane tiled with the cell.
std::set<Image> cluster(const Assembly& assembly, int disc) {
  std::set<Image> found{{disc, 0, 0}};
  std::vector<Image> open{{disc, 0, 0}};
  const auto visit = [&](int d, int x, int y) {
    if (std::abs(x) < 8 && std::abs(y) < 8 && found.insert({d, x, y}).second) open.emplace_back(d, x, y);
  };
  while (!open.empty()) {
    const auto [d, x, y] = open.back();
    open.pop_back();
    for (const Contact& c : assembly.contacts) {
      if (c.i == d) visit(c.j, x + c.shift_x, y + c.shift_y);
      if (c.j == d) visit(c.i, x - c.shift_x, y - c.shift_y);
    }
  }
  return found;
}

/// Which rotations some contact resists.
std::vector<bool> resisted(const Assembly& assembly, const ContactSprings& springs) {
  std::vector<bool> result(assembly.size(), false);
  for (std::size_t k = 0; k < assembly.contacts.size(); ++k) {
    const Contact& c = assembly.contacts[k];
    if (springs[k].kT != 0 && c.lever_i > 0) result[c.i] = true;
    if (springs[k].kT != 0 && c.lever_j > 0) result[c.j] = true;
    if (springs.bending(k) > 0 && c.i != c.j) result[c.i] = result[c.j] = true;
  }
  return result;
}

/// Motions in which the centres of every piece move rigidly and every disc turns as it likes: the columns of P. Zero
/// eigenvalues of P^T K P, with supports added as springs of stiffness 1.
std::int64_t rigid_zero_modes(const RandomScene& scene, const Dense& K) {
  const Assembly& a = scene.assembly;
  const std::size_t b = scene.unknowns.per_disc;
  Dense columns;
  std::set<int> seen;
  for (int first = 0; first < static_cast<int>(a.size()); ++first) {
    if (seen.count(first) != 0) continue;
    const std::set<Image> images = cluster(a, first);
    std::vector<Vec2> centre(a.size());
    std::vector<int> times(a.size(), 0);
    for (const auto& [d, x, y] : images) {
      seen.insert(d);
      ++times[d];
      centre[d] = a.centres[d] + (a.period ? Vec2{x * a.period->x, y * a.period->y} : Vec2{});
    }
    const bool winds = times[first] > 1;
    const bool alone = std::count(times.begin(), times.end(), 0) + 1 == static_cast<std::ptrdiff_t>(a.size());
    for (int mode = 0; mode < (winds || alone ? 2 : 3); ++mode) {
      std::vector<double> column(K.size(), 0.0);
      for (std::size_t d = 0; d < a.size(); ++d) {
        if (times[d] == 0) continue;
        const Vec2 turn = perpendicular(centre[d] - centre[first]);
        const Vec2 u = mode == 0 ? Vec2{1, 0} : mode == 1 ? Vec2{0, 1} : turn;
        column[d * b] = u.x;
        column[d * b + 1] = u.y;
      }
      columns.push_back(column);
    }
  }
  const std::vector<bool> turns = resisted(a, scene.springs);
  for (std::size_t d = 0; b == 3 && d < a.size(); ++d) {
    if (!turns[d]) continue;
    columns.emplace_back(K.size(), 0.0);
    columns.back()[3 * d + 2] = 1;
  }
  for (auto& column : columns) {
    double square = 0;
    for (const double x : column) square += x * x;
    for (double& x : column) x /= std::sqrt(square);
  }
  Dense projected(columns.size(), std::vector<double>(columns.size(), 0.0));
  for (std::size_t p = 0; p < columns.size(); ++p) {
    for (std::size_t q = 0; q < columns.size(); ++q) {
      for (std::size_t r = 0; r < K.size(); ++r) {
        if (columns[p][r] == 0) continue;
        for (std::size_t c = 0; c < K.size(); ++c) projected[p][q] += columns[p][r] * K[r][c] * columns[q][c];
        if (scene.unknowns.held[r] != 0) {
          projected[p][q] += columns[p][r] * columns[q][r];
        }
      }
    }
  }
  return nullity(projected);
}

bool refused(const RandomScene& scene) {
  try {
    check_rigidity(scene.assembly, ContactGraph(scene.assembly), scene.springs, scene.unknowns);
  } catch (const Error&) {
    return true;
  }
  return false;
}

/// Hold components at random, and rotations that nothing resists.
void hold_at_random(RandomScene& scene, bool rotations, double share, Random& random) {
  scene.unknowns.per_disc = rotations ? 3 : 2;
  scene.unknowns.rotation_scale = scene.assembly.mean_radius();
  scene.unknowns.held.assign(scene.assembly.size() * scene.unknowns.per_disc, 0);
  for (auto& held : scene.unknowns.held) held = random.uniform() < share ? 1 : 0;
  const std::vector<bool> turns = resisted(scene.assembly, scene.springs);
  for (std::size_t d = 0; rotations && d < turns.size(); ++d) {
    if (!turns[d]) scene.unknowns.held[3 * d + 2] = 1;
  }
}

/// Lattices, shaken or not, that have lost some contacts; five ways to place the contact points.
RandomScene random_scene(Random& random, bool bends) {
  RandomScene scene;
  const bool hexagonal = random.uniform() < 0.5;
  const bool periodic = random.uniform() < 0.3;
  const int columns = 2 + static_cast<int>(random.below(2));
  const int rows = hexagonal && periodic ? 2 : 1 + static_cast<int>(random.below(3));
  const LatticeOptions options{.columns = columns, .rows = rows, .radius = 0.5, .periodic = periodic};
  scene.assembly = hexagonal ? hexagonal_lattice(options) : square_lattice(options);
  Assembly& a = scene.assembly;
  if (random.uniform() < 0.7) {
    for (Vec2& x : a.centres) x += {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)};
    for (double& r : a.radii) r = random.uniform(0.3, 0.6);
  }
  const double lost = random.uniform() < 0.3 ? 0 : random.uniform(0, 0.5);
  std::erase_if(a.contacts, [&](const Contact&) { return random.uniform() < lost; });
  const std::uint64_t levers = random.below(6);
  for (Contact& c : a.contacts) {
    const double l = norm(a.branch(c));
    const double r_i = a.radii[c.i];
    const double r_j = a.radii[c.j];
    double share = levers == 0 ? 0.5 : r_i / (r_i + r_j);
    if (levers == 1) share = random.uniform(0.3, 0.7);
    if (levers == 2 && random.uniform() < 0.2) share = 0;
    c.lever_i = levers == 3 ? r_i : share * l;
    c.lever_j = levers == 3 ? r_j : l - c.lever_i;
    if (levers == 4 && random.uniform() < 0.2) c.lever_i = c.lever_j = 0;
  }
  const double tangential = random.uniform();  // share of contacts with kT
  std::vector<SpringConstants> springs(a.contacts.size());
  for (auto& k : springs) {
    k = {random.uniform(0.5, 2), random.uniform() < 2 * tangential ? random.uniform(0.2, 1) : 0.0};
  }
  scene.springs = ContactSprings(springs);
  if (bends) scene.springs = scene.springs.with_bending(test::random_bending(springs.size(), random));
  const double shares[] = {0, 0.05, 0.15, 0.3, 0.5};
  hold_at_random(scene, random.uniform() < 0.7, shares[random.below(5)], random);
  return scene;
}

}  // namespace

TEST_CASE("rigid_and_gear_modes_are_the_zero_modes_with_rigidly_moving_centres") {
  const bool bends = GENERATE(false, true);
  Random random(20);
  int free_count = 0;
  int gears = 0;
  int accepted = 0;
  int other_mechanisms = 0;
  for (int trial = 0; trial < 600; ++trial) {
    const RandomScene scene = random_scene(random, bends);
    const RigidityReport report =
        examine_rigidity(scene.assembly, ContactGraph(scene.assembly), scene.springs, scene.unknowns);
    const std::int64_t told = report.free_rigid_motions + report.gear_modes;
    const Dense K = dense_stiffness(scene);
    CAPTURE(bends, trial, scene.assembly.size(), scene.assembly.contacts.size(), scene.unknowns.per_disc,
            scene.assembly.periodic(), report.pieces, report.free_rigid_motions, report.gear_modes);
    CHECK(told == rigid_zero_modes(scene, K));
    CHECK(refused(scene) == (told > 0));
    const std::int64_t zeros = zero_modes(scene, K);
    CHECK(zeros >= told);
    free_count += report.free_rigid_motions > 0 ? 1 : 0;
    gears += report.gear_modes > 0 ? 1 : 0;
    accepted += told == 0 ? 1 : 0;
    other_mechanisms += zeros > told ? 1 : 0;
  }
  CAPTURE(free_count, gears, accepted, other_mechanisms);
  CHECK(free_count > 100);
  CHECK(gears > (bends ? 20 : 100));
  CHECK(accepted > 100);
}

TEST_CASE("a_triangulated_assembly_has_no_other_zero_modes") {
  Random random(21);
  int accepted = 0;
  int refusals = 0;
  for (int trial = 0; trial < 200; ++trial) {
    RandomScene scene;
    const bool periodic = trial % 4 == 0;
    scene.assembly = hexagonal_lattice({.columns = 3, .rows = periodic ? 4 : 3, .radius = 0.5, .periodic = periodic});
    for (Vec2& x : scene.assembly.centres) x += {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)};
    for (Contact& c : scene.assembly.contacts) {
      c.lever_i = c.lever_j = 0.5 * norm(scene.assembly.branch(c));
    }
    const bool rotations = trial % 2 == 0;
    const double kT = rotations ? 0.6 : trial % 3 == 0 ? 0.0 : 0.3;
    scene.springs = ContactSprings(SpringConstants{1, kT});
    hold_at_random(scene, rotations, random.uniform(0, 0.2), random);
    const RigidityReport report =
        examine_rigidity(scene.assembly, ContactGraph(scene.assembly), scene.springs, scene.unknowns);
    const std::int64_t zeros = zero_modes(scene, dense_stiffness(scene));
    CAPTURE(trial, rotations, kT, periodic, report.free_rigid_motions, zeros);
    CHECK(report.free_rigid_motions + report.gear_modes == zeros);
    CHECK(refused(scene) == (zeros > 0));
    ++(zeros > 0 ? refusals : accepted);
  }
  CAPTURE(accepted, refusals);
  CHECK(accepted > 50);
  CHECK(refusals > 50);
}
