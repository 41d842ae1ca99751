// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The judgement of check_rigidity from the contact graph agrees with the eigenvalues of the stiffness matrix.
#include <Eigen/Dense>
#include <algorithm>
#include <cstdint>
#include <set>
#include <vector>

#include "equidem/linear/stiffness_matrix.hpp"
#include "equidem/statics/rigidity.hpp"

#include "statics/random_networks.hpp"
#include "statics/rigidity_report.hpp"
#include "support/catch.hpp"
#include "support/dense_oracle.hpp"
#include "support/refusal.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

using Dense = Eigen::MatrixXd;

/// Zero eigenvalues of a positive semi-definite matrix whose stiffnesses are of the order of 1; none may lie where
/// zero or not is in doubt.
std::int64_t nullity(const Dense& a) {
  if (a.size() == 0) return 0;
  std::int64_t zero = 0;
  const Eigen::SelfAdjointEigenSolver<Dense> eigen(a, Eigen::EigenvaluesOnly);
  for (const double value : eigen.eigenvalues()) {
    if (value <= 1e-12)
      ++zero;
    else
      CHECK(value > 1e-8);
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
  const DenseMatrix K = dense_matrix(
      assemble_stiffness(scene.assembly, ContactGraph(scene.assembly), scene.springs, all), scene.assembly);
  const auto n = static_cast<Eigen::Index>(K.size);
  return Eigen::Map<const Dense>(K.entries.data(), n, n);
}

/// Zero eigenvalues of K over the components that are not held.
std::int64_t zero_modes(const RandomScene& scene, const Dense& K) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index p = 0; p < K.rows(); ++p)
    if (scene.unknowns.held[p] == 0) free.push_back(p);
  return nullity(K(free, free));
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
  std::vector<Eigen::VectorXd> columns;
  std::set<int> seen;
  for (int first = 0; first < static_cast<int>(a.size()); ++first) {
    if (seen.count(first) != 0) continue;
    std::vector<Vec2> centre(a.size());
    std::vector<int> times(a.size(), 0);
    for (const auto& [d, x, y] : images_joined_to(a, first)) {
      seen.insert(d);
      ++times[d];
      centre[d] = a.centres[d] + (a.period ? Vec2{x * a.period->x, y * a.period->y} : Vec2{});
    }
    const bool winds = times[first] > 1;
    const bool alone = std::count(times.begin(), times.end(), 0) + 1 == static_cast<std::ptrdiff_t>(a.size());
    for (int mode = 0; mode < (winds || alone ? 2 : 3); ++mode) {
      Eigen::VectorXd column = Eigen::VectorXd::Zero(K.rows());
      for (std::size_t d = 0; d < a.size(); ++d) {
        if (times[d] == 0) continue;
        const Vec2 turn = perpendicular(centre[d] - centre[first]);
        const Vec2 u = mode == 0 ? Vec2{1, 0} : mode == 1 ? Vec2{0, 1} : turn;
        column[d * b] = u.x;
        column[d * b + 1] = u.y;
      }
      columns.push_back(column.normalized());
    }
  }
  const std::vector<bool> turns = resisted(a, scene.springs);
  for (std::size_t d = 0; b == 3 && d < a.size(); ++d)
    if (turns[d]) columns.emplace_back(Eigen::VectorXd::Unit(K.rows(), 3 * d + 2));
  Dense P(K.rows(), std::ssize(columns)), supported = K;
  for (std::size_t c = 0; c < columns.size(); ++c) P.col(c) = columns[c];
  for (Eigen::Index p = 0; p < K.rows(); ++p) supported(p, p) += scene.unknowns.held[p] != 0 ? 1 : 0;
  return nullity(P.transpose() * supported * P);
}

bool refused(const RandomScene& scene) {
  const ContactGraph graph(scene.assembly);
  return !refusal_of([&] { check_rigidity(scene.assembly, graph, scene.springs, scene.unknowns); }).message.empty();
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
  scene.assembly =
      shaken_lattice(hexagonal, {.columns = columns, .rows = rows, .radius = 0.5, .periodic = periodic}, random);
  Assembly& a = scene.assembly;
  const double lost = random.uniform() < 0.3 ? 0 : random.uniform(0, 0.5);
  std::erase_if(a.contacts, [&](const Contact&) { return random.uniform() < lost; });
  place_contact_points(a, random);
  const double tangential = random.uniform();  // share of contacts with kT
  scene.springs = drawn_springs(a.contacts.size(), 2 * tangential, bends, random);
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
