// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/effective_stiffness.hpp"

#include <cmath>
#include <fstream>
#include <numbers>

#include <nlohmann/json.hpp>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/files.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/assembly/touching.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/contact/materials.hpp"
#include "equidem/homogenize/bounds.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/homogenize/stress.hpp"

#include "homogenize/samples.hpp"
#include "homogenize/tensors.hpp"
#include "support/catch.hpp"
#include "support/free_samples.hpp"

using namespace equidem;
using namespace samples;

namespace {

using std::numbers::sqrt3;

EffectiveStiffness of(const Assembly& assembly, SpringConstants k, Rotation rotation = Rotation::from_scene,
                      Boundary boundary = Boundary::periodic) {
  return effective_stiffness(assembly, ContactSprings(k), {.boundary = boundary, .rotation = rotation, .solver = {}});
}

Assembly lattice_cell(bool hexagonal, int columns, int rows) {
  const LatticeOptions options{.columns = columns, .rows = rows, .radius = 0.005, .periodic = true};
  return hexagonal ? hexagonal_lattice(options) : square_lattice(options);
}

}  // namespace

TEST_CASE("lattices_have_the_stiffness_of_the_closed_forms") {
  const double ratio = GENERATE(-0.3, -0.1, 0.0, 1e-8, 0.05, 0.25, 0.5, 1.0, 1e8);
  const auto [columns, rows] = GENERATE(std::pair{1, 2}, std::pair{2, 2}, std::pair{3, 4}, std::pair{8, 6});
  const Rotation rotation = GENERATE(Rotation::from_scene, Rotation::restrained);
  const SpringConstants k{1e9, ratio * 1e9};
  CAPTURE(ratio, columns, rows, rotation == Rotation::restrained);
  // Rotation restrained or not, a symmetric strain turns no disc: the stiffness is that of F1; (55) has the same.
  SECTION("hexagonal: F1, Abe (34)") {
    const EffectiveStiffness c = of(lattice_cell(true, columns, rows), k, rotation);
    const double K = sqrt3 / 2 * k.kN, G = sqrt3 / 4 * (k.kN + k.kT);
    CHECK(relative_difference(c.stiffness, isotropic_stiffness(K, G)) < 1e-12);
    CHECK(c.unstable_modes == 0);
  }
  SECTION("square: F2") {
    if (ratio <= 0) return;
    const EffectiveStiffness c = of(lattice_cell(false, columns, rows), k, rotation);
    const Matrix3 exact{{{k.kN, 0, 0}, {0, k.kN, 0}, {0, 0, k.kT / 2}}};
    CHECK(relative_difference(c.stiffness, exact) < 1e-12);
    CHECK(std::abs(c.stiffness[2][2] / exact[2][2] - 1) < 1e-12);
  }
}

TEST_CASE("every_lattice_has_the_moduli_of_its_relation_and_the_tension_test_that_follows") {
  for (const Lattice& lattice : all_lattices()) {
    for (const double ratio : {0.25, 1.0}) {
      if (lattice.relation.equal_springs != nullptr && ratio != 1) continue;
      CAPTURE(lattice.name, ratio);
      REQUIRE((lattice.make != nullptr && lattice.relation.moduli != nullptr && lattice.relation.springs != nullptr));
      const SpringConstants k{1e9, ratio * 1e9};
      const SheetModuli moduli = lattice.relation.moduli(k, {});
      const Assembly cell = lattice.make({.columns = 4, .rows = 4, .radius = 0.005, .periodic = true});
      const EffectiveStiffness c = of(cell, k);
      CHECK(relative_difference(c.stiffness, isotropic_stiffness(moduli.bulk, moduli.shear)) < 1e-12);
      if (lattice.tension == nullptr) continue;
      const double nu = (moduli.bulk - moduli.shear) / (2 * moduli.bulk);
      const TensionTheory theory = lattice.tension(ratio);
      CHECK(std::abs(theory.poisson_ratio - nu) < 1e-14);
      CHECK(std::abs(theory.stiffness_ratio - 2 * moduli.shear / ((1 - nu) * k.kN)) < 1e-14);
    }
  }
}

TEST_CASE("restrained_rotation_makes_the_stress_unsymmetric_as_equation_55_says") {
  const double ratio = GENERATE(-0.2, 0.25, 1.0);
  const double kN = 1e9, kT = ratio * kN;
  const EffectiveStiffness c = of(lattice_cell(true, 4, 4), {kN, kT}, Rotation::restrained);
  // sigma = sqrt3/4 [(kN - kT) d_ij e_mm + 2 (kN + kT) e_ij] + sqrt3/2 kT e_ji W, W = u_2,1 - u_1,2 (errata A4).
  const double l = sqrt3 / 4 * (kN - kT), m = sqrt3 / 4 * (kN + kT), t = sqrt3 / 2 * kT;
  const Matrix4 exact{{{l + 2 * m, l, 0, 0}, {l, l + 2 * m, 0, 0}, {0, 0, m + t, m - t}, {0, 0, m - t, m + t}}};
  CAPTURE(ratio, c.gradient_stiffness[2][2], exact[2][2], c.gradient_stiffness[2][3], exact[2][3]);
  CHECK(largest_entry(c.gradient_stiffness + (-1.0) * exact) < 1e-12 * largest_entry(exact));
}

TEST_CASE("a_random_cell_has_the_stiffness_of_the_independent_implementation") {
  const std::string folder = std::string(EQUIDEM_SOURCE_DIR) + "/data/reference/";
  const Assembly assembly = read_assembly(folder + "perturbed_hexagonal_400.json");
  nlohmann::json reference;
  std::ifstream(folder + "perturbed_hexagonal_400_stiffness.json") >> reference;
  for (const auto& expected : reference["results"]) {
    const double ratio = expected["kT_over_kN"];
    const std::string rotations = expected["rotations"];
    CAPTURE(ratio, rotations);
    const EffectiveStiffness c =
        of(assembly, {1, ratio}, rotations == "free" ? Rotation::from_scene : Rotation::restrained);
    const double size = largest_entry(c.stiffness);
    for (int r = 0; r < 3; ++r) {
      for (int s = 0; s < 3; ++s) {
        CAPTURE(r, s);
        // Off-diagonal entries are small differences: relative to the entry where it counts.
        const double wanted = expected["C_voigt"][r][s];
        CHECK(std::abs(c.stiffness[r][s] - wanted) <= 1e-9 * std::max(std::abs(wanted), 1e-3 * size));
      }
    }
    for (int r = 0; r < 4; ++r) {
      for (int s = 0; s < 4; ++s) {
        CAPTURE(r, s);
        CHECK(std::abs(c.gradient_stiffness[r][s] - expected["C4"][r][s].get<double>()) <= 1e-10 * size);
      }
    }
  }
}

TEST_CASE("strain_energies_are_the_derivatives_of_the_stiffness") {
  const Boundary boundary = GENERATE(Boundary::periodic, Boundary::displacement, Boundary::traction);
  const Rotation rotation = GENERATE(Rotation::from_scene, Rotation::restrained);
  for (const Sample& sample : assemblies(true)) {
    CAPTURE(sample.name, to_string(boundary), rotation == Rotation::restrained);
    const double r = 0.4, h = 1e-4;
    const EffectiveStiffness c = of(sample.assembly, {1, r}, rotation, boundary);
    const EffectiveStiffness ahead = of(sample.assembly, {1, r + h}, rotation, boundary);
    const EffectiveStiffness behind = of(sample.assembly, {1, r - h}, rotation, boundary);
    const Matrix3 slope = (r / (2 * h)) * (ahead.stiffness + (-1.0) * behind.stiffness);
    CHECK(relative_difference(c.tangential_part, slope) < 1e-6);
    CHECK(relative_difference(c.tangential_part + c.normal_part, c.stiffness) < 1e-12);
  }
}

TEST_CASE("macroscopic_power_is_microscopic_power") {  // Hill & Mandel
  const double ratio = GENERATE(0.0, 0.3, 1.0, -0.1);
  const Boundary boundary = GENERATE(Boundary::periodic, Boundary::displacement);
  for (const Sample& sample : assemblies(true)) {
    if (sample.name == "square" && ratio <= 0) continue;
    CAPTURE(sample.name, ratio, to_string(boundary));
    const EffectiveStiffness c = of(sample.assembly, {1e9, ratio * 1e9}, Rotation::from_scene, boundary);
    CHECK(c.relative_residual < 1e-14);
    if (boundary == Boundary::periodic) CHECK(c.hill_mandel < 1e-12);
    CHECK(c.error_bound < 1e-12 * largest_entry(c.stiffness));
  }
}

TEST_CASE("larger_samples_close_the_gap_between_the_boundaries_as_one_over_their_size") {
  const ContactSprings springs(SpringConstants{1, 0.3});
  const auto gap = [&](int n) {
    const Assembly cell = hexagonal_lattice({.columns = n, .rows = n, .radius = 0.005, .periodic = true});
    const auto shear = [&](Boundary boundary) {
      return effective_moduli(
                 effective_stiffness(cell, springs, {.boundary = boundary, .rotation = {}, .solver = {}}).stiffness)
          .shear_modulus;
    };
    return shear(Boundary::displacement) - shear(Boundary::traction);
  };
  const double small = gap(12), large = gap(48);
  const double order = std::log(small / large) / std::log(4.0);
  CAPTURE(small, large, order);
  CHECK(order > 0.9);
  CHECK(order < 1.1);
}

TEST_CASE("discs_that_carry_nothing_change_nothing") {
  Assembly cell = lattice_cell(true, 6, 6);
  const ContactSprings springs(SpringConstants{1e9, 0.4e9});
  const EffectiveStiffness bare = effective_stiffness(cell, springs);
  const auto add_disc = [&](Vec2 at) {
    cell.centres.push_back(at);
    cell.radii.push_back(0.001);
    cell.cell_areas.clear();
    cell.facet_lengths.clear();
    return static_cast<std::int32_t>(cell.size() - 1);
  };
  const std::int32_t rattler = add_disc({0.0101, 0.0203});
  const std::int32_t first = add_disc({0.0301, 0.0203}), second = add_disc({0.0311, 0.0203});
  cell.contacts.push_back({.i = 0, .j = first, .lever_i = 0, .lever_j = 0});
  cell.contacts.back().lever_i = norm(cell.branch(cell.contacts.back()));
  cell.contacts.push_back({.i = first, .j = second, .lever_i = 0.0005, .lever_j = 0.0005});
  CAPTURE(rattler, first, second);
  const EffectiveStiffness c = effective_stiffness(cell, springs);
  CHECK(relative_difference(c.stiffness, bare.stiffness) < 1e-13);
  CHECK(c.rattlers == 1);
  CHECK(c.discs_removed == 3);
  CHECK(!c.removed.empty());
}

TEST_CASE("a_floppy_network_prints_no_modulus") {
  const SpringConstants no_slip_resistance{1e9, 0};
  SECTION("square lattice without tangential springs") {
    const std::string message =
        message_of([&] { static_cast<void>(of(lattice_cell(false, 4, 4), no_slip_resistance)); });
    CAPTURE(message);
    CHECK(contains(message, "no energy") + contains(message, "at no cost") > 0);
  }
  SECTION("one column of the square lattice without tangential springs") {
    const std::string message =
        message_of([&] { static_cast<void>(of(lattice_cell(false, 1, 1), no_slip_resistance)); });
    CAPTURE(message);
    CHECK(contains(message, "costs no energy"));
  }
  SECTION("chains along x only") {
    Assembly chains = lattice_cell(false, 4, 4);
    std::erase_if(chains.contacts, [&](const Contact& c) { return std::abs(chains.branch(c).y) > 1e-3; });
    chains.facet_lengths.clear();
    const std::string message = message_of([&] { static_cast<void>(of(chains, {1e9, 0.5e9})); });
    CAPTURE(message);
    CHECK(contains(message, "one direction only"));
  }
  SECTION("honeycomb without tangential springs") {
    Assembly honeycomb = lattice_cell(true, 6, 6);  // a third of the discs taken out
    std::vector<std::uint8_t> out(honeycomb.size(), 0);
    for (std::size_t d = 0; d < honeycomb.size(); ++d) {
      const int row = static_cast<int>(d) / 6, column = static_cast<int>(d) % 6;
      if ((column + (row % 2 == 1 ? 2 : 0)) % 3 == 0) out[d] = 1;
    }
    std::erase_if(honeycomb.contacts, [&](const Contact& c) { return out[c.i] != 0 || out[c.j] != 0; });
    honeycomb.facet_lengths.clear();
    CHECK(honeycomb.contacts.size() == honeycomb.size());  // 2/3 of the discs, 3/2 contacts each
    const std::string message = message_of([&] { static_cast<void>(of(honeycomb, no_slip_resistance)); });
    CAPTURE(message);
    CHECK(!message.empty());
  }
  SECTION("no contacts") {
    Assembly loose = lattice_cell(true, 4, 4);
    loose.contacts.clear();
    loose.facet_lengths.clear();
    CHECK(contains(message_of([&] { static_cast<void>(of(loose, {1, 1})); }), "no contacts"));
  }
}

namespace {

/// Free samples as files give them: discs that touch, and scattered ones joined by their triangulation.
std::vector<Sample> samples_of_files() {
  std::vector<Sample> samples = {{"hexagonal block", test::hexagonal_block()},
                                 {"heap", test::rows_of_discs(7, 7, 1)},
                                 {"heap with a flat top", test::rows_of_discs(8, 4, 1)}};
  for (Sample& sample : samples) {
    sample.assembly.contacts = touching_discs(sample.assembly, 1e-9);
    for (Contact& c : sample.assembly.contacts) c.lever_i = c.lever_j = 0.5 * norm(sample.assembly.branch(c));
  }
  Random random(5);
  samples.push_back({"scattered", test::scattered_discs(80, 0.5, 1.5, random)});
  triangulate(samples.back().assembly);
  return samples;
}

const std::vector<test::Placement> placements = {{.degrees = 13, .moved = {}},
                                                 {.degrees = 30, .mirrored = true, .moved = {}},
                                                 {.degrees = 45, .moved = {40, -30}},
                                                 {.degrees = 77, .mirrored = true, .moved = {}, .unit = 1e-3}};

/// A stiffness in the axes of a sample that lies otherwise.
Matrix3 placed(const Matrix3& c, const test::Placement& placement) {
  Matrix3 result = rotated(c, -placement.degrees * std::numbers::pi / 180);
  for (std::size_t k = 0; placement.mirrored && k < 2; ++k) result[k][2] = -result[k][2], result[2][k] = -result[2][k];
  return result;
}

}  // namespace

TEST_CASE("moduli_and_solid_fraction_do_not_depend_on_how_the_sample_lies") {
  for (const auto& [name, sample] : samples_of_files()) {
    const bool scattered = name == "scattered";
    for (const Boundary boundary : {Boundary::displacement, Boundary::traction}) {
      for (const SpringWeighting weighting : {SpringWeighting::uniform, SpringWeighting::contact_density,
                                              SpringWeighting::local_contact_density, SpringWeighting::voronoi}) {
        // Facets of contacts that a corner of the region cuts off are round-off, and so would their springs be.
        if (scattered && weighting == SpringWeighting::voronoi) continue;
        const auto stiffness = [&](const Assembly& a) {
          const ContactSprings springs = contact_springs(a, {1e9, 3e8}, weighting);
          return effective_stiffness(a, springs, {.boundary = boundary, .rotation = {}, .solver = {}}).stiffness;
        };
        Assembly as_it_lies = sample;
        measure_cells(as_it_lies);
        const Matrix3 expected = stiffness(as_it_lies);
        for (const test::Placement& placement : placements) {
          Assembly other = placed(sample, placement);
          measure_cells(other);
          const Matrix3 found = stiffness(other), wanted = placed(expected, placement);
          CAPTURE(name, to_string(boundary), to_string(weighting), placement.name(), shown(found), shown(wanted));
          CHECK(relative_difference(found, wanted) < (scattered ? 1e-10 : 1e-12));
          CHECK(other.solid_fraction() == Approx(as_it_lies.solid_fraction()).epsilon(1e-12));
        }
      }
    }
  }
}

TEST_CASE("a_heap_of_logs_has_the_mean_stress_of_its_lines_of_contacts_however_it_lies") {
  // Report 01: every line of contacts carries W/sqrt 3 more at each log.
  Assembly heap = test::rows_of_discs(7, 7, 1);
  heap = test::placed(heap, {.moved = {}, .unit = 0.15});
  heap.contacts = touching_discs(heap, 1e-9);
  std::erase_if(heap.contacts, [&](const Contact& c) { return std::abs(heap.branch(c).y) < 0.01; });  // of one row
  for (Contact& c : heap.contacts) c.lever_i = c.lever_j = 0.075;
  constexpr double W = 1.5;
  std::vector<test::Placement> all = placements;
  all.insert(all.begin(), test::Placement{.moved = {}});
  for (const test::Placement& placement : all) {
    Assembly a = placed(heap, placement);
    measure_cells(a);
    for (std::int32_t d = 0; d < 28; ++d) a.groups[d < 7 ? "base" : "logs"].discs.push_back(d);
    const Equilibrium found = solve_equilibrium(
        a, ContactSprings(SpringConstants{2e6, 0}),
        std::vector<Support>{{.group = "base", .ux = 0.0, .uy = 0.0, .rotation = {}}},
        {{.group = "logs", .kind = LoadKind::per_disc, .force = placement.turned({0, -W}), .moment = 0}});
    const Tensor2 s = macroscopic_stress(a, found.contact_forces);
    const Vec2 x = placement.turned({1, 0}), y = placement.turned({0, 1});
    const double xx = placement.unit * dot(x, s * x), yy = placement.unit * dot(y, s * y);
    CAPTURE(placement.name(), xx, yy, a.area());
    CHECK(xx == Approx(-3.72715).epsilon(1e-5));
    CHECK(yy == Approx(-11.18146).epsilon(1e-5));
    CHECK(yy / xx == Approx(3).epsilon(1e-9));
  }
}

TEST_CASE("rows_of_two_materials_are_springs_in_series_across_and_side_by_side_along") {
  // On a square lattice C_xx is the mean kN along the rows, C_yy the kN across them.
  Assembly lattice = lattice_cell(false, 4, 6);
  for (std::int32_t disc = 0; disc < static_cast<std::int32_t>(lattice.size()); ++disc) {
    const double spacing = 2 * lattice.radii.front();
    const auto row = std::lround(lattice.centres[static_cast<std::size_t>(disc)].y / spacing);
    lattice.groups[row % 2 == 0 ? "hard" : "soft"].discs.push_back(disc);
  }
  const SpringConstants hard{4e9, 1e9}, soft{1e9, 3e8};
  const std::vector<OfPair<SpringConstants>> pairs = {{{"hard", "hard"}, false, hard}, {{"soft", "soft"}, false, soft}};
  const ContactSprings springs(Materials(lattice, pairs).of_contacts({1, 1}, pairs, in_series));
  const Matrix3 stiffness = effective_stiffness(lattice, springs).stiffness;
  CAPTURE(stiffness[0], stiffness[1]);
  CHECK_THAT(stiffness[0][0], Catch::Matchers::WithinRel(0.5 * (hard.kN + soft.kN), 1e-12));
  CHECK_THAT(stiffness[1][1], Catch::Matchers::WithinRel(2 * hard.kN * soft.kN / (hard.kN + soft.kN), 1e-12));
  CHECK_THAT(stiffness[0][1], Catch::Matchers::WithinAbs(0, 1e-12 * stiffness[0][0]));
}
