// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/calibrate/calibrate.hpp"

#include <algorithm>
#include <cmath>
#include <regex>
#include <string>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/files.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"

#include "homogenize/samples.hpp"
#include "support/catch.hpp"

namespace {

using namespace equidem;
using samples::message_of;

Assembly random_cell(PointProcess points, std::int64_t discs, bool periodic = true) {
  return delaunay_assembly({.discs = discs, .points = points, .disorder = 0.3, .seed = 5, .periodic = periodic});
}

/// A Delaunay assembly with contacts taken out at random: four to six contacts per disc, stiff or soft against slip.
Assembly diluted_cell(double kept, std::int64_t discs = 600, std::uint64_t seed = 7) {
  Assembly cell = random_cell(PointProcess::poisson_disc, discs);
  Random random(seed);
  std::vector<Contact> contacts;
  for (const Contact& contact : cell.contacts)
    if (random.uniform(0, 1) < kept) contacts.push_back(contact);
  cell.contacts = contacts;
  cell.facet_lengths.clear();
  return cell;
}

struct Kind {
  std::string name;
  Assembly assembly;
  CalibrateOptions options;
};

/// Every kind of assembly, boundary and weighting.
std::vector<Kind> kinds() {
  const LatticeOptions lattice{.columns = 6, .rows = 6, .periodic = true};
  std::vector<Kind> all{
      {"hexagonal, closed form", hexagonal_lattice(lattice), {.lattice = &lattices::hexagonal}},
      {"hexagonal, by a search", hexagonal_lattice(lattice), {}},
      {"square, by a search on its mean over all directions", square_lattice(lattice), {}},
      {"Poisson disc", random_cell(PointProcess::poisson_disc, 300), {}},
      {"perturbed hexagonal", random_cell(PointProcess::perturbed_hexagonal, 300), {}},
      {"uniform points", random_cell(PointProcess::uniform, 300), {}},
      {"file", read_assembly(EQUIDEM_SOURCE_DIR "/data/reference/perturbed_hexagonal_400.json"), {}},
      {"free block, displaced boundary", random_cell(PointProcess::poisson_disc, 300, false), {}},
      {"free block, tractions",
       random_cell(PointProcess::poisson_disc, 300, false),
       {.homogenize = {.boundary = Boundary::traction, .solver = {}}}},
      {"five contacts a disc", diluted_cell(0.83), {}},
  };
  for (const PointProcess points : {PointProcess::poisson_disc, PointProcess::uniform}) {
    for (const SpringWeighting weighting :
         {SpringWeighting::contact_density, SpringWeighting::local_contact_density, SpringWeighting::voronoi})
      all.push_back({to_string(weighting), random_cell(points, 300), {.weighting = weighting}});
  }
  const std::size_t free = all.size();
  for (std::size_t k = 0; k < free; ++k) {
    if (all[k].options.homogenize.boundary == Boundary::traction) continue;
    all.push_back(all[k]);
    all.back().name += ", rotation restrained";
    all.back().options.homogenize.rotation = Rotation::restrained;
  }
  return all;
}

EffectiveStiffness stiffness_of(const Kind& kind, SpringConstants springs) {
  HomogenizeOptions options = kind.options.homogenize;
  if (!kind.assembly.periodic() && options.boundary == Boundary::periodic) options.boundary = Boundary::displacement;
  return effective_stiffness(kind.assembly, contact_springs(kind.assembly, springs, kind.options.weighting), options);
}

TEST_CASE("springs_come_back_from_their_moduli") {
  for (const Kind& kind : kinds()) {
    const bool closed_form = kind.options.lattice != nullptr;
    for (const double ratio : {0.05, 0.4, 1.0, 3.0}) {
      if (closed_form && ratio > 1) continue;
      const SpringConstants springs{3.7e8, ratio * 3.7e8};
      const EffectiveModuli moduli = effective_moduli(stiffness_of(kind, springs).stiffness);
      const Calibration found = calibrate(
          kind.assembly, moduli_from_bulk(moduli.bulk_modulus_2d, moduli.shear_modulus, Plane::stress), kind.options);
      CAPTURE(kind.name, ratio, found.springs.ratio(), found.factorizations, found.relative_error, found.method);
      CHECK(found.springs.kN == Approx(springs.kN).epsilon(1e-9));
      CHECK(found.springs.kT == Approx(springs.kT).epsilon(1e-9));
      CHECK(found.factorizations <= (closed_form ? 1 : 12));
    }
  }
}

TEST_CASE("moduli_are_reached_to_1e_10_within_12_factorizations") {
  for (const PointProcess points :
       {PointProcess::poisson_disc, PointProcess::perturbed_hexagonal, PointProcess::uniform}) {
    const Kind kind{to_string(points), random_cell(points, points == PointProcess::poisson_disc ? 10000 : 2000), {}};
    for (const double nu : {0.19, -0.2}) {
      const ElasticModuli target{2.5e7, nu, Plane::strain};
      const Calibration found = calibrate(kind.assembly, target, kind.options);
      CAPTURE(kind.name, kind.assembly.size(), nu, found.factorizations, found.iterations, found.relative_error);
      CHECK(found.factorizations <= 12);
      CHECK(found.factorizations == found.iterations + 2);
      CHECK(found.rising);
      // Homogenized anew.
      const EffectiveModuli moduli = effective_moduli(stiffness_of(kind, found.springs).stiffness);
      CHECK(moduli.shear_modulus == Approx(target.shear_modulus).epsilon(1e-10));
      CHECK(moduli.bulk_modulus_2d == Approx(target.bulk_modulus_2d()).epsilon(1e-10));
      CHECK(moduli.poisson_strain == Approx(nu).epsilon(1e-10));
    }
  }
}

TEST_CASE("the_derivative_by_kT_is_the_energy_in_tangential_springs") {
  for (const Kind& kind : kinds()) {
    const double ratio = 0.3, h = 1e-3;
    const auto at = [&](double r) { return stiffness_of(kind, {1, r}).stiffness; };
    const auto low = at(ratio - h), high = at(ratio + h), far_low = at(ratio - 2 * h), far_high = at(ratio + 2 * h);
    const EffectiveStiffness middle = stiffness_of(kind, {1, ratio});
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t column = 0; column < 3; ++column) {
        // Central difference of fourth order.
        const double difference =
            (8 * (high[row][column] - low[row][column]) - (far_high[row][column] - far_low[row][column])) / (12 * h);
        CAPTURE(kind.name, row, column);
        CHECK(middle.tangential_part[row][column] / ratio ==
              Approx(difference).epsilon(1e-6).margin(1e-9 * middle.stiffness[0][0]));
      }
    }
  }
}

/// The number that a remedy asks for.
double advised(const std::string& message) {
  std::smatch found;
  INFO(message);
  REQUIRE(std::regex_search(message, found, std::regex("at (?:most|least) (-?[0-9.]+[0-9])")));
  return std::stod(found[1]);
}

TEST_CASE("what_is_out_of_range_is_refused_with_a_value_that_is_feasible") {
  const Assembly cell = random_cell(PointProcess::poisson_disc, 300), sparse = diluted_cell(0.8);
  struct Wish {
    const Assembly& assembly;
    double nu;
    bool static_only;
  };
  for (const Wish& wish :
       {Wish{cell, 0.45, false}, {sparse, 0.45, false}, {sparse, -0.99, false}, {cell, 0.45, true}}) {
    for (const Plane plane : {Plane::strain, Plane::stress}) {
      const CalibrateOptions options{.static_only = wish.static_only};
      const auto ask = [&](double nu) { return calibrate(wish.assembly, {1e9, nu, plane}, options); };
      const std::string message = message_of([&] { ask(wish.nu); });
      const double nearest = advised(message);
      CAPTURE(message, nearest);
      const Calibration found = ask(nearest);
      CHECK(found.relative_error <= 1e-10);
      CHECK((found.springs.kT < 0) == wish.static_only);
      if (!wish.static_only) {
        CHECK(nearest <= found.highest_poisson_ratio(plane));
        CHECK(nearest >= found.lowest_poisson_ratio(plane));
        // As near as six decimals allow.
        CHECK(std::min(found.highest_poisson_ratio(plane) - nearest, nearest - found.lowest_poisson_ratio(plane)) <
              2e-6);
      }
    }
  }
}

// Sparse networks have nu rise and fall with kT/kN, and some are mechanisms at kT = 0.
TEST_CASE("what_a_sparse_network_shows_at_some_springs_is_reached_and_nothing_beyond_is_claimed") {
  int turning = 0;
  for (const double kept : {0.62, 0.7}) {
    for (const std::uint64_t seed : {1, 2}) {
      const Kind kind{"", diluted_cell(kept, 64, seed), {}};
      std::vector<double> shown;
      for (double exponent = -5; exponent <= 4; exponent += 1.5)
        shown.push_back(effective_moduli(stiffness_of(kind, {1, std::pow(10, exponent)}).stiffness).poisson_strain);
      CAPTURE(kept, seed);
      for (std::size_t k = 0; k < shown.size(); ++k) {
        if (shown[k] <= -1) continue;
        const Calibration found = calibrate(kind.assembly, {1e9, shown[k], Plane::strain});
        CAPTURE(k, shown[k], found.springs.ratio(), found.factorizations);
        CHECK(effective_moduli(stiffness_of(kind, found.springs).stiffness).poisson_strain ==
              Approx(shown[k]).margin(1e-9));
        const double lowest = found.lowest_poisson_ratio(Plane::strain);
        const double highest = found.highest_poisson_ratio(Plane::strain);
        CHECK(lowest <= shown[k]);
        CHECK(shown[k] <= highest);
        if (!found.scanned) continue;
        turning += found.rising ? 0 : 1;
        CHECK(lowest <= std::max(-1.0, *std::min_element(shown.begin(), shown.end())) + 1e-9);
        CHECK(highest >= *std::max_element(shown.begin(), shown.end()) - 1e-9);
      }
      for (const double nu : {0.499, -0.9999}) {
        const auto ask = [&](double wanted) { return calibrate(kind.assembly, {1e9, wanted, Plane::strain}); };
        const std::string message = message_of([&] { ask(nu); });
        if (message.empty()) continue;
        CAPTURE(message);
        CHECK(ask(advised(message)).relative_error <= 1e-10);
      }
    }
  }
  CHECK(turning > 5);
}

TEST_CASE("the_static_limit_advised_is_reached") {
  for (const std::uint64_t seed : {1, 2}) {
    const Assembly cell = delaunay_assembly({.discs = 100, .seed = seed, .periodic = true});
    const auto ask = [&](double nu) { return calibrate(cell, {1e9, nu, Plane::strain}, {.static_only = true}); };
    std::string first;
    for (const double nu : {0.49, 0.38}) {
      const std::string message = message_of([&] { ask(nu); });
      const double nearest = advised(message);
      CAPTURE(seed, nu, message);
      const Calibration found = ask(nearest);
      CHECK(found.springs.kT < 0);
      CHECK(found.achieved.unstable_modes == 0);
      CHECK(found.relative_error <= 1e-10);
      // The limit does not depend on the wanted moduli.
      const std::string advice = message.substr(message.find("the highest"));
      if (first.empty()) first = advice;
      CHECK(advice == first);
    }
  }
}

TEST_CASE("negative_tangential_springs_are_for_statics_and_stop_at_the_static_limit") {
  const Assembly lattice = hexagonal_lattice({.columns = 6, .rows = 6, .periodic = true});
  for (const bool closed_form : {true, false}) {
    CalibrateOptions options{.static_only = true};
    if (closed_form) options.lattice = &lattices::hexagonal;
    CAPTURE(closed_form);
    // nu = (1 - r)/4, eq. (22): stable for r > -1/3.
    const Calibration found = calibrate(lattice, {1e9, 0.33, Plane::strain}, options);
    CHECK(found.springs.ratio() == Approx(1 - 4 * 0.33).epsilon(1e-10));
    CHECK(found.achieved.unstable_modes == 0);
    const std::string message = message_of([&] { calibrate(lattice, {1e9, 0.34, Plane::strain}, options); });
    CAPTURE(message);
    CHECK(samples::contains(message, "static limit"));
    options.static_only = false;
    const std::string unasked = message_of([&] { calibrate(lattice, {1e9, 0.33, Plane::strain}, options); });
    CAPTURE(unasked);
    CHECK(samples::contains(unasked, "at most"));
    CHECK(samples::contains(unasked, "static_only = true"));
  }
}

TEST_CASE("a_lattice_names_the_source_of_its_relation_and_offers_negative_springs_up_to_its_static_limit") {
  Lattice sheet = lattices::hexagonal;
  sheet.relation.source = "Griffiths & Mustoe 2001";
  const Assembly assembly = hexagonal_lattice({.columns = 6, .rows = 6, .periodic = true});
  const auto refused = [&](const ElasticModuli& moduli) {
    return message_of([&] { calibrate(assembly, moduli, {.lattice = &sheet}); });
  };
  CHECK(calibrate(assembly, {1e9, 0.2}, {.lattice = &sheet}).method == "closed form, Griffiths & Mustoe 2001");
  CHECK_THAT(refused({1e9, 0.3}), Catch::Contains("here kT/kN = -0.2 by Griffiths & Mustoe 2001"));
  // kT/kN = -1/3: nu = 1/3 in plane strain, 1/2 in plane stress.
  CHECK_THAT(refused({1e9, 0.4}), Catch::Contains("at most 0.25, or below 0.333333 with static_only = true"));
  CHECK_THAT(refused({1e9, 0.6, Plane::stress}),
             Catch::Contains("at most 0.333333, or below 0.5 with static_only = true"));
}

TEST_CASE("stiffer_moduli_take_springs_stiffer_by_the_same_factor") {
  const Assembly cell = random_cell(PointProcess::poisson_disc, 300);
  const Calibration soft = calibrate(cell, {1.0, 0.1, Plane::strain});
  for (const double factor : {1e12, 1e-100, 1e100}) {
    const Calibration scaled = calibrate(cell, {factor, 0.1, Plane::strain});
    CAPTURE(factor);
    CHECK(scaled.springs.kN / factor == Approx(soft.springs.kN).epsilon(1e-12));
    CHECK(scaled.springs.kT / factor == Approx(soft.springs.kT).epsilon(1e-10));
  }
}

// With kT = kN and rotation restrained each contact resists the relative motion alike in all directions, so that u_x
// and u_y are independent: K = G for any network.
TEST_CASE("with_rotation_restrained_nu_0_asks_for_equal_springs_on_every_assembly") {
  for (const Kind& kind : kinds()) {
    if (kind.options.homogenize.rotation != Rotation::restrained) continue;
    const Calibration found = calibrate(kind.assembly, {1e9, 0, Plane::strain}, kind.options);
    CAPTURE(kind.name, found.springs.ratio());
    CHECK(found.springs.ratio() == Approx(1).epsilon(1e-10));
  }
}

TEST_CASE("lattices_take_the_closed_form") {
  const ElasticModuli target{1e9, 0.2, Plane::strain};
  for (const Rotation rotation : {Rotation::free, Rotation::restrained}) {
    for (const bool periodic : {true, false}) {
      const Assembly lattice = hexagonal_lattice({.columns = 6, .rows = 6, .periodic = periodic});
      const Calibration found = calibrate(
          lattice, target, {.homogenize = {.rotation = rotation, .solver = {}}, .lattice = &lattices::hexagonal});
      const SpringConstants abe = springs_for(target, lattices::hexagonal.relation);
      CAPTURE(periodic, found.method, found.relative_error);
      CHECK(found.springs.kN == abe.kN);
      CHECK(found.springs.kT == abe.kT);
      CHECK(found.iterations == 0);
      CHECK(found.verified == periodic);
      CHECK(found.factorizations == (periodic ? 1 : 0));
      CHECK(found.relative_error < 1e-13);
      CHECK(found.highest_poisson_ratio(Plane::strain) == 0.25);
    }
  }
  const Assembly square = square_lattice({.columns = 6, .rows = 6, .periodic = true});
  const Calibration found = calibrate(square, {1e9, 0, Plane::strain}, {.lattice = &lattices::square});
  CHECK(found.springs.kN == 2e9);
  CHECK(found.springs.kT == 2e9);
  CHECK(found.moduli.anisotropy < 1e-13);
  CHECK(samples::contains(message_of([&] { calibrate(square, target, {.lattice = &lattices::square}); }), "nu = 0"));
}

TEST_CASE("a_lattice_that_is_none_is_found_out_and_its_springs_come_with_their_error") {
  const Assembly cell = random_cell(PointProcess::poisson_disc, 300);
  try {
    static_cast<void>(calibrate(cell, {1e9, 0.2, Plane::strain}, {.lattice = &lattices::hexagonal}));
    FAIL("it passed for one");
  } catch (const ErrorWith<Calibration>& error) {
    const Calibration& best = error.found();
    CAPTURE(error.what(), best.springs.kN, best.springs.ratio(), best.relative_error);
    CHECK(samples::contains(error.what(), fmt::format("the moduli reached are off by {:.2g}", best.relative_error)));
    CHECK((best.springs.kN > 0 && best.relative_error > 1e-3));
  }
}

TEST_CASE("too_little_memory_is_no_instability_of_the_assembly") {
  const Assembly cell = random_cell(PointProcess::poisson_disc, 100);
  CalibrateOptions options;
  options.homogenize.solver.memory_limit = 1;
  try {
    calibrate(cell, {1e9, 0.2, Plane::strain}, options);
    FAIL("springs were found within a byte");
  } catch (const Error& error) {
    CAPTURE(error.what());
    CHECK(error.kind() == ErrorKind::out_of_memory);
    CHECK(error.exit_code() == 1);
  }
}

TEST_CASE("what_cannot_be_calibrated_is_refused") {
  const Assembly cell = random_cell(PointProcess::poisson_disc, 100);
  const auto refusal = [](const Assembly& assembly, const ElasticModuli& target, const CalibrateOptions& options) {
    return message_of([&] { calibrate(assembly, target, options); });
  };
  const ElasticModuli target{1e9, 0.2, Plane::strain};
  CHECK(samples::contains(refusal(cell, {-1, 0.2, Plane::strain}, {}), "shear modulus"));
  CHECK(samples::contains(refusal(cell, {1e9, 0.5, Plane::strain}, {}), "between -1 and 0.5"));
  CHECK(samples::contains(refusal(cell, target, {.tolerance = 0}), "tolerance"));
  CHECK(samples::contains(refusal(hexagonal_lattice({.columns = 4, .rows = 4, .periodic = true}), target,
                                  {.weighting = SpringWeighting::voronoi, .lattice = &lattices::square}),
                          "weighting"));
  Assembly with_springs = cell;
  with_springs.contact_kN.assign(cell.contacts.size(), 1e9);
  CHECK(samples::contains(refusal(with_springs, target, {}), "springs of its own"));
}

}  // namespace
