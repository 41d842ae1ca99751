// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The lowest natural frequencies.
#include "equidem/waves/natural_frequencies.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/random.hpp"
#include "equidem/statics/motion_description.hpp"
#include "equidem/waves/stability.hpp"
#include "equidem/waves/vibration.hpp"

#include "support/assemblies.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"
#include "support/off_line_networks.hpp"
#include "support/sturm.hpp"
#include "waves/networks.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// M^-1/2 K M^-1/2, with held components far above all others.
Tridiagonal plain_spectrum(const Assembly& assembly, const ContactSprings& springs, const DegreesOfFreedom& unknowns,
                           const std::vector<Inertia>& inertia) {
  const ContactGraph graph(assembly);
  DenseMatrix k = dense_matrix(assemble_stiffness(assembly, graph, springs, unknowns), assembly);
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  const double a = unknowns.rotation_scale;
  std::vector<double> root(k.size);
  for (std::size_t c = 0; c < k.size; ++c) {
    const Inertia& body = inertia[c / b];
    root[c] = std::sqrt(c % b == 2 ? body.moment / (a * a) : body.mass);
  }
  for (std::size_t r = 0; r < k.size; ++r) {
    for (std::size_t c = 0; c < k.size; ++c) k(r, c) /= root[r] * root[c];
  }
  const double far = 10 * element_bound(assembly, springs, inertia, true);
  for (std::size_t c = 0; c < k.size; ++c) {
    if (unknowns.held[c] != 0) k(c, c) = far;
  }
  return tridiagonalize(std::move(k));
}

/// Each value lies where the plain spectrum has the eigenvalue of its place, and all zero-energy modes are counted.
void check_against(const Tridiagonal& plain, const NaturalFrequencies& found) {
  constexpr double rounding = 1e-13;  // of the largest eigenvalue, in the plain spectrum
  CAPTURE(found.zero_energy_modes, found.why_none, found.solver, found.iterations, found.squared, found.error_bounds);
  CHECK(eigenvalues_below(plain, rounding * plain.norm + 1e-300) == found.zero_energy_modes);
  CHECK(found.converged == found.why_none.empty());
  for (std::size_t k = 0; k < found.squared.size(); ++k) {
    const double margin = found.error_bounds[k] + rounding * plain.norm;
    const auto place = found.zero_energy_modes + static_cast<std::int64_t>(k);
    CAPTURE(k, eigenvalues_below(plain, found.squared[k] - margin),
            eigenvalues_below(plain, found.squared[k] + margin));
    CHECK(eigenvalues_below(plain, found.squared[k] - margin) <= place);
    CHECK(eigenvalues_below(plain, found.squared[k] + margin) > place);
    CHECK(found.error_bounds[k] <= 1e-6 * found.squared[k] + rounding * plain.norm);
  }
}

}  // namespace

TEST_CASE("the_lowest_frequencies_are_those_of_the_whole_spectrum") {
  std::size_t checked = 0;
  for (const HeldScene& scene : held_scenes()) {
    const Assembly& assembly = scene.assembly();
    if (scene.springs.any_negative()) continue;
    const bool large = assembly.size() > 100;
    if (large && scene.name.find("kT/kN = 0.5, rotation free, uniform") == std::string::npos) continue;
    const auto inertia = inertia_of(assembly.radii, 1000, Body::disc);
    const Effects effects = derive_effects(scene.springs, scene.options.rotation);
    for (const bool supported : {true, false}) {
      if (large && !supported) continue;
      const DegreesOfFreedom unknowns =
          number_unknowns(assembly, scene.springs, effects,
                          supported ? std::span<const Support>(scene.supports) : std::span<const Support>{});
      const Tridiagonal plain = plain_spectrum(assembly, scene.springs, unknowns, inertia);
      for (const std::size_t dense_limit : {0, 150}) {
        const NaturalFrequencies found =
            natural_frequencies(assembly, scene.springs, unknowns, inertia, {.dense_limit = dense_limit});
        CAPTURE(scene.name, supported, dense_limit, found.why_none);
        check_against(plain, found);
        const std::int64_t others = unknowns.unknowns - found.zero_energy_modes;
        CHECK(static_cast<std::int64_t>(found.squared.size()) == std::min<std::int64_t>(4, others));
        ++checked;
      }
    }
  }
  CHECK(checked > 100);
}

TEST_CASE("the_lowest_frequencies_of_bodies_off_the_lines_of_centres") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Assembly assembly = off_line(random_cell(40, seed), seed);
    const ContactSprings springs(SpringConstants{1, seed % 2 == 0 ? 0.4 : 0});
    const auto inertia = inertia_of(assembly, 2000, Body::disc);
    const DegreesOfFreedom unknowns =
        number_unknowns(assembly, springs, derive_effects(assembly, springs, Rotation::from_scene), {});
    CAPTURE(seed);
    check_against(plain_spectrum(assembly, springs, unknowns, inertia),
                  natural_frequencies(assembly, springs, unknowns, inertia, {.dense_limit = 0}));
  }
}

// Without tangential springs square lattices shear, and networks that lack contacts have mechanisms inside.
TEST_CASE("mechanisms_have_the_frequency_zero_and_are_counted") {
  std::vector<Assembly> networks{square_lattice({.columns = 6, .rows = 4}), periodic_square(5, 4)};
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Assembly network = random_cell(50, seed);
    Random random(seed);
    std::erase_if(network.contacts,
                  [&](const Contact&) { return random.uniform() < 0.06 * static_cast<double>(seed % 5); });
    network.facet_lengths.clear();
    networks.push_back(network);
  }
  std::int64_t modes = 0;
  for (const Assembly& network : networks) {
    for (const double kT : {0.0, 0.3}) {
      const ContactSprings springs(SpringConstants{1, kT});
      const auto inertia = unit_masses(network);
      const DegreesOfFreedom unknowns =
          number_unknowns(network, springs, derive_effects(springs, Rotation::from_scene), {});
      const NaturalFrequencies found = natural_frequencies(network, springs, unknowns, inertia, {.dense_limit = 0});
      CAPTURE(network.size(), network.contacts.size(), kT);
      check_against(plain_spectrum(network, springs, unknowns, inertia), found);
      modes += found.zero_energy_modes;
    }
  }
  CHECK(modes > 60);
}

TEST_CASE("too_many_zero_energy_modes_are_a_reason_and_no_frequency") {
  const Assembly square = square_lattice({.columns = 50, .rows = 50});
  const ContactSprings springs(SpringConstants{1, 0});
  const NaturalFrequencies found = natural_frequencies(
      square, springs, number_unknowns(square, springs, derive_effects(springs, Rotation::from_scene), {}),
      unit_masses(square));
  CHECK(found.squared.empty());
  CHECK_THAT(found.why_none, Catch::Contains("zero-energy modes"));
}

// omega_k = 2 sqrt(kN/m) sin((2k - 1) pi / (4n + 2)) of n beads between a held and a free end.
TEST_CASE("a_chain_with_a_held_and_a_free_end_has_the_frequencies_of_a_string_of_beads") {
  const int n = GENERATE(5, 60, 400);
  Assembly chain = chain_of_discs(n + 1, 1);
  for (int d = 0; d <= n; ++d) chain.groups["all"].discs.push_back(d);
  const ContactSprings springs(SpringConstants{4, 0});
  const std::vector<Support> supports{{"first", 0.0, {}, {}}, {"all", {}, 0.0, {}}};
  const DegreesOfFreedom unknowns =
      number_unknowns(chain, springs, derive_effects(springs, Rotation::from_scene), supports);
  const NaturalFrequencies found =
      natural_frequencies(chain, springs, unknowns, unit_masses(chain), {.tolerance = 1e-9});
  REQUIRE(found.squared.size() == 4);
  for (int k = 1; k <= 4; ++k) {
    CAPTURE(n, k, found.iterations, found.error_bounds);
    const double omega = 4 * std::sin((2 * k - 1) * std::numbers::pi / (4 * n + 2));
    CHECK(std::sqrt(found.squared[k - 1]) == Approx(omega).epsilon(1e-9));
  }
}

TEST_CASE("multigrid_and_elimination_find_the_same_frequencies") {
  DelaunayOptions options{.discs = 1500, .seed = 3, .radii = {0.8, 1.6}, .aspect = 2};
  Assembly random = delaunay_assembly(options);
  options.periodic = true;
  for (const Assembly& assembly : {random, delaunay_assembly(options), periodic_hexagonal(36, 40),
                                   hexagonal_lattice({.columns = 60, .rows = 25, .radius = 1})}) {
    for (const double kT : {0.0, 0.05, 0.5}) {
      const ContactSprings springs(SpringConstants{1, kT});
      const auto inertia = inertia_of(assembly.radii, 1, Body::disc);
      const DegreesOfFreedom unknowns =
          number_unknowns(assembly, springs, derive_effects(springs, Rotation::from_scene), {});
      const auto by = [&](SolverMethod method) {
        return natural_frequencies(assembly, springs, unknowns, inertia, {.count = 5, .solver = {.method = method}});
      };
      const NaturalFrequencies direct = by(SolverMethod::multifrontal), multigrid = by(SolverMethod::multigrid);
      CAPTURE(assembly.kind, assembly.periodic(), kT, direct.squared, multigrid.squared, multigrid.why_none);
      CHECK(direct.converged);
      CHECK(multigrid.converged);
      CHECK(direct.zero_energy_modes == (assembly.periodic() ? 2 : 3));
      CHECK(multigrid.zero_energy_modes == direct.zero_energy_modes);
      REQUIRE(multigrid.squared.size() == 5);
      for (std::size_t k = 0; k < 5; ++k) {
        CHECK(std::abs(multigrid.squared[k] - direct.squared[k]) <= multigrid.error_bounds[k] + direct.error_bounds[k]);
      }
    }
  }
}

TEST_CASE("the_bits_of_natural_frequencies_do_not_depend_on_threads") {
  const Assembly assembly = delaunay_assembly({.discs = 3000, .seed = 3, .radii = {0.8, 1.6}});
  const ContactSprings springs(SpringConstants{1, 0.4});
  const SolverMethod method = GENERATE(SolverMethod::multifrontal, SolverMethod::multigrid);
  const DegreesOfFreedom unknowns =
      number_unknowns(assembly, springs, derive_effects(springs, Rotation::from_scene), {});
  std::vector<double> first;
  for (const int threads : {1, 2, 5}) {
    const ThreadsFor here(threads);
    const NaturalFrequencies found =
        natural_frequencies(assembly, springs, unknowns, unit_masses(assembly), {.solver = {.method = method}});
    if (threads == 1) first = found.squared;
    CHECK(found.squared.size() == 4);
    CHECK(found.squared == first);
  }
}

TEST_CASE("frequencies_about_a_state_of_rest_under_forces_are_those_of_a_dense_matrix") {
  Assembly block = delaunay_assembly({.discs = 40, .disorder = 0.3, .seed = 5});
  Random random(2);
  for (const Contact& contact : block.contacts) {
    const double size = 0.05 * norm(block.branch(contact));  // kN l = l
    block.contact_normal_force.push_back(size * random.uniform(-1, 1));
    block.contact_tangential_force.push_back(size * random.uniform(-0.5, 0.5));
  }
  const ContactSprings bare({1, 0.4}), springs = bare.with_prestress(prestress_of(block));
  const std::vector<Support> held{{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = 0.0}};
  const StabilityOptions options{.density = 1.2};
  const Stability s = analyze_stability(block, springs, held, options),
                  without = analyze_stability(block, bare, held, options);
  REQUIRE(s.status() == "stable");
  REQUIRE(s.natural.squared.size() == 4);
  // Second derivatives of the energy, by energies of sums of unit motions.
  const DegreesOfFreedom unknowns = number_unknowns(block, springs, s.effects, held);
  const std::vector<Inertia> inertia = inertia_of(block, options.density, options.body);
  const double a = unknowns.rotation_scale;
  const auto energy = [&](std::size_t p, std::size_t q) {
    std::vector<double> x(unknowns.held.size(), 0.0);
    x[p] += 1;
    if (q < x.size()) x[q] += 1;
    return elastic_energy(block, springs, disc_motions(unknowns, x));
  };
  DenseMatrix k(unknowns.held.size());
  std::vector<double> alone, root;
  for (std::size_t c = 0; c < k.size; ++c) {
    alone.push_back(energy(c, k.size));
    root.push_back(std::sqrt(c % 3 == 2 ? inertia[c / 3].moment / (a * a) : inertia[c / 3].mass));
  }
  const double far = 10 * element_bound(block, springs, inertia, true);
  for (std::size_t p = 0; p < k.size; ++p) {
    for (std::size_t q = 0; q < k.size; ++q) {
      k(p, q) = (energy(p, q) - alone[p] - alone[q]) / (root[p] * root[q]);
      if (unknowns.held[p] != 0 || unknowns.held[q] != 0) k(p, q) = p == q ? far : 0;
    }
  }
  check_against(tridiagonalize(std::move(k)), s.natural);
  CHECK(std::abs(s.natural.squared[0] / without.natural.squared[0] - 1) > 1e-3);
}

TEST_CASE("a_state_of_rest_that_its_forces_make_unstable_has_no_natural_frequencies") {
  Assembly row = square_lattice({.columns = 12, .rows = 1, .radius = 0.5});
  row.groups["ends"].discs = {0, 11};
  row.contact_normal_force.assign(row.contacts.size(), -0.5);
  row.contact_tangential_force.assign(row.contacts.size(), 0.0);
  const ContactSprings springs = ContactSprings({1, 0.01}).with_prestress(prestress_of(row));
  const std::vector<Support> held{{.group = "ends", .ux = 0.0, .uy = 0.0, .rotation = 0.0}};
  const Stability s = analyze_stability(row, springs, held);
  CHECK(s.status() == "unstable");
  CHECK(s.natural.squared.empty());
  CHECK(s.natural.why_none == "springs and forces at rest together are not stable");
}
