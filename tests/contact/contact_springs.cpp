// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The springs of every contact: weightings, overrides, refusals.
#include "equidem/contact/contact_springs.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/error.hpp"

#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// A disc in the middle for each angle: contacts of exactly the given directions.
Assembly pairs_of_discs(const std::vector<double>& angles) {
  Assembly assembly;
  assembly.kind = "pairs";
  for (const double angle : angles) {
    const auto i = static_cast<std::int32_t>(assembly.centres.size());
    const Vec2 centre{10.0 * i, 0};
    assembly.centres.push_back(centre);
    assembly.centres.push_back(centre + 2.0 * Vec2{std::cos(angle), std::sin(angle)});
    assembly.contacts.push_back({i, i + 1, 0, 0, 1, 1});
  }
  assembly.radii.assign(assembly.centres.size(), 1.0);
  assembly.cell_areas.assign(assembly.centres.size(), 4.0);
  return assembly;
}

/// Angles whose density is (1 + a cos 2(t - t0) + b cos 4(t - t1))/(2 pi) exactly: the quantiles, not random draws,
/// so that the mean over n of them is the integral to 1/n².
std::vector<double> anisotropic_angles(int count, double a, double t0, double b, double t1) {
  const auto cumulative = [&](double t) {
    return (t + a / 2 * (std::sin(2 * (t - t0)) + std::sin(2 * t0)) +
            b / 4 * (std::sin(4 * (t - t1)) + std::sin(4 * t1))) /
           (2 * std::numbers::pi);
  };
  std::vector<double> angles;
  for (int k = 0; k < count; ++k) {
    const double target = (k + 0.5) / count;
    double low = 0;
    double high = 2 * std::numbers::pi;
    while (high - low > 1e-14) {
      const double middle = (low + high) / 2;
      (cumulative(middle) < target ? low : high) = middle;
    }
    angles.push_back(low);
  }
  return angles;
}

/// sum k n_i n_j / sum k and sum k n_i n_j n_k n_l / sum k in their deviations from isotropy: the four harmonics.
double anisotropy(const Assembly& assembly, const ContactSprings& springs) {
  double sum = 0;
  double harmonics[4] = {};
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Vec2 l = assembly.branch(assembly.contacts[c]);
    const double t = std::atan2(l.y, l.x);
    const double k = springs[c].kN;
    sum += k;
    harmonics[0] += k * std::cos(2 * t);
    harmonics[1] += k * std::sin(2 * t);
    harmonics[2] += k * std::cos(4 * t);
    harmonics[3] += k * std::sin(4 * t);
  }
  double largest = 0;
  for (const double h : harmonics) largest = std::max(largest, std::abs(h / sum));
  return largest;
}

}  // namespace

TEST_CASE("contact_density_weighting_makes_fabric_isotropic_to_fourth_order") {
  const Assembly assembly = pairs_of_discs(anisotropic_angles(2000, 0.4, 0.3, 0.3, 1.1));
  const double unweighted = anisotropy(assembly, contact_springs(assembly, {1, 0.5}, SpringWeighting::uniform));
  const double weighted = anisotropy(assembly, contact_springs(assembly, {1, 0.5}, SpringWeighting::contact_density));
  CAPTURE(unweighted, weighted);
  CHECK(unweighted > 0.1);
  CHECK(weighted < 1e-5);
}

TEST_CASE("contact_density_of_an_isotropic_assembly_is_z_over_2_pi_at_every_contact") {
  std::vector<double> angles(12);
  for (std::size_t k = 0; k < 12; ++k) angles[k] = 0.1 + static_cast<double>(k) * std::numbers::pi / 6;
  const LatticeOptions cell{.columns = 6, .rows = 6, .periodic = true};
  using enum SpringWeighting;
  for (const auto& [assembly, weighting] : {std::pair{pairs_of_discs(angles), contact_density},
                                            {square_lattice(cell), local_contact_density},
                                            {hexagonal_lattice(cell), local_contact_density}}) {
    const ContactSprings springs = contact_springs(assembly, {3, 2}, weighting);
    const double psi = assembly.coordination_number() / (2 * std::numbers::pi);
    for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
      CAPTURE(assembly.kind, c);
      CHECK(springs[c].kN == Approx(3 / psi).epsilon(1e-13));
      CHECK(springs[c].kT == Approx(2 / psi).epsilon(1e-13));
    }
  }
}

TEST_CASE("local_contact_density_is_the_inverse_of_the_angle_that_a_contact_has_to_itself") {
  // A disc with three contacts at 0, 100 and 200 degrees; each of the other discs has a single contact, the full turn.
  constexpr double degree = std::numbers::pi / 180;
  Assembly assembly;
  assembly.centres = {{0, 0}};
  for (const double angle : {0.0, 100.0, 200.0}) {
    assembly.contacts.push_back({0, static_cast<std::int32_t>(assembly.centres.size()), 0, 0, 1, 1});
    assembly.centres.push_back(2.0 * Vec2{std::cos(angle * degree), std::sin(angle * degree)});
  }
  assembly.radii.assign(4, 1.0);
  const std::vector<double> psi = local_contact_density(assembly);
  // gaps of 100, 100 and 160 degrees
  const double expected[] = {130, 100, 130};
  for (std::size_t c = 0; c < 3; ++c) {
    CAPTURE(c, 1 / psi[c] / degree);
    CHECK(1 / psi[c] == Approx((expected[c] + 360) / 2 * degree).epsilon(1e-14));
  }
}

TEST_CASE("local_contact_density_does_not_count_the_open_side_of_an_assembly") {
  // Row at a straight side: contacts at 0, 60, 120 and 180 degrees, the half turn below is open.
  const Assembly block = hexagonal_lattice({.columns = 9, .rows = 9});
  const std::vector<double> psi = local_contact_density(block);
  std::vector<int> contacts(block.size());
  for (const Contact& c : block.contacts) ++contacts[c.i], ++contacts[c.j];
  int sides = 0;
  for (std::size_t c = 0; c < psi.size(); ++c) {
    const auto [i, j] = std::pair{contacts[block.contacts[c].i], contacts[block.contacts[c].j]};
    if (i != 4 && j != 4) continue;
    if (i != 4 && i != 6) continue;
    if (j != 4 && j != 6) continue;
    ++sides;
    CAPTURE(c, block.contacts[c].i, block.contacts[c].j);
    CHECK(psi[c] == Approx(3 / std::numbers::pi).epsilon(1e-14));
  }
  CHECK(sides > 30);
}

TEST_CASE("voronoi_weighting_scales_by_shared_edge_over_distance") {
  Assembly assembly = pairs_of_discs({0.0, 1.0, 2.0});
  assembly.facet_lengths = {1.0, 0.5, 4.0};
  const ContactSprings springs = contact_springs(assembly, {10, -4}, SpringWeighting::voronoi);
  for (std::size_t c = 0; c < 3; ++c) {
    CAPTURE(c);
    CHECK(springs[c].kN == Approx(10 * assembly.facet_lengths[c] / 2));
    CHECK(springs[c].kT == Approx(-4 * assembly.facet_lengths[c] / 2));
  }
  CHECK(springs.any_tangential());
  CHECK(springs.any_negative());
  CHECK(springs.largest() == Approx(20));
}

TEST_CASE("uniform_weighting_stores_one_pair") {
  const Assembly assembly = pairs_of_discs({0.0, 1.0});
  const ContactSprings springs = contact_springs(assembly, {10, 0}, SpringWeighting::uniform);
  CHECK(springs.uniform());
  CHECK(springs[1].kN == 10);
  CHECK_FALSE(springs.any_tangential());
  CHECK_FALSE(springs.any_negative());
  CHECK(springs.largest() == 10);
}

TEST_CASE("springs_of_the_assembly_override_those_of_the_case") {
  Assembly assembly = pairs_of_discs({0.0, 1.0});
  assembly.facet_lengths = {1, 1};
  assembly.contact_kN = {3, 5};
  SECTION("both springs: the case and its weighting are not asked") {
    assembly.contact_kT = {0, -7};
    const auto weighting = GENERATE(SpringWeighting::uniform, SpringWeighting::contact_density,
                                    SpringWeighting::local_contact_density, SpringWeighting::voronoi);
    const ContactSprings springs = contact_springs(assembly, {0, 0}, weighting);
    CHECK(springs[0].kN == 3);
    CHECK(springs[1].kN == 5);
    CHECK(springs[1].kT == -7);
    CHECK(springs.any_tangential());
    CHECK(springs.any_negative());
    CHECK(springs.largest() == 7);
  }
  SECTION("one spring: the other comes from the case") {
    const ContactSprings springs = contact_springs(assembly, {100, 2}, SpringWeighting::uniform);
    CHECK(springs[1].kN == 5);
    CHECK(springs[1].kT == 2);
  }
}

TEST_CASE("bad_springs_are_refused_with_the_contact_and_the_value") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  using enum SpringWeighting;
  const auto refused = [](const Assembly& assembly, SpringConstants k, SpringWeighting weighting,
                          const std::vector<std::string>& words) {
    check_refused([&] { static_cast<void>(contact_springs(assembly, k, weighting)); }, words);
  };
  const Assembly three = pairs_of_discs({0.0, 1.0, 2.0});
  for (const double kN : {0.0, -2.5, nan, infinity})
    refused(three, {kN, 1}, uniform, {"the normal spring is kN = ", "must be positive and finite"});
  refused(three, {1, nan}, contact_density, {"kT = nan"});
  refused(three, {1, 1}, voronoi, {"has no cell edges"});
  Assembly own = three;
  own.contact_kN = {1, 0, 1}, own.contact_kT = {1, 1, 1};
  refused(own, {1, 1}, uniform, {"contact 1 (discs 2 and 3) is kN = 0"});
  own.contact_kN = {1, 1, 1}, own.contact_kT = {1, 1, infinity};
  refused(own, {1, 1}, uniform, {"contact 2 (discs 4 and 5) is kT = inf"});
  Assembly edges = three;
  edges.facet_lengths = {1, 1, 0};
  refused(edges, {1, 1}, voronoi, {"contact 2 (discs 4 and 5)"});
  // Nearly all contacts along x and one across: 1 + 2 cos 2t + 2 cos 4t is below zero somewhere.
  std::vector<double> angles(30, 0.0);
  angles.push_back(std::numbers::pi / 4);
  refused(pairs_of_discs(angles), {1, 1}, contact_density,
          {"contact 30 (discs 60 and 61)", "Use the weighting \"uniform\""});
  Assembly thrice = pairs_of_discs({0.3});
  thrice.contacts.assign(3, thrice.contacts.front());
  refused(thrice, {1, 1}, local_contact_density, {"three contacts in one direction at contact 0 (discs 0 and 1)"});
}
