// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/sensitivities.hpp"

#include <cmath>
#include <fstream>

#include <nlohmann/json.hpp>

#include "equidem/assembly/files.hpp"
#include "equidem/core/statistics.hpp"

#include "homogenize/samples.hpp"
#include "homogenize/tensors.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace samples;

namespace {

std::vector<SpringConstants> random_springs(std::size_t contacts, std::uint64_t seed) {
  Random random(seed);
  std::vector<SpringConstants> springs(contacts);
  for (SpringConstants& k : springs) k = {random.uniform(0.5e9, 1.5e9), random.uniform(0.1e9, 1e9)};
  return springs;
}

/// Springs of each contact, with bending springs where asked for.
ContactSprings springs_of(const Assembly& assembly, bool bend) {
  const ContactSprings springs(random_springs(assembly.contacts.size(), 5));
  const double radius = assembly.mean_radius();
  return bend ? springs.with_bending(std::vector(assembly.contacts.size(), 0.3e9 * radius * radius)) : springs;
}

Matrix3 stiffness_of(const Assembly& assembly, const ContactSprings& springs) {
  return effective_stiffness(assembly, springs).stiffness;
}

std::vector<double> numbers(const ModuliChange& m) {
  return {m.bulk_modulus_2d, m.shear_modulus, m.young_modulus, m.poisson_ratio};
}

std::vector<double> numbers(const Matrix3& stiffness) {
  const EffectiveModuli m = effective_moduli(stiffness);
  return {m.bulk_modulus_2d, m.shear_modulus, m.young_stress, m.poisson_stress};
}

}  // namespace

TEST_CASE("derivatives_by_springs_are_those_of_the_independent_implementation") {
  const std::string folder = std::string(EQUIDEM_SOURCE_DIR) + "/data/reference/perturbed_hexagonal_400";
  const Assembly assembly = read_assembly(folder + ".json");
  nlohmann::json reference;
  std::ifstream(folder + "_sensitivity.json") >> reference;
  std::vector<SpringConstants> constants;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c)
    constants.push_back({reference["kN"][c].get<double>(), reference["kT"][c].get<double>()});
  const ContactSprings springs(constants);

  const SpringSensitivities found = spring_sensitivities(assembly, springs, effective_stiffness(assembly, springs));

  const auto compare = [](const Matrix3& ours, const nlohmann::json& upper) {
    const double theirs[] = {upper[0], upper[1], upper[2], upper[3], upper[4], upper[5]};
    CHECK(relative_difference(ours, symmetric(theirs)) < 1e-10);
  };
  for (std::size_t k = 0; k < reference["contacts"].size(); ++k) {
    const std::size_t c = reference["contacts"][k];
    CAPTURE(c);
    compare(found.by_kN[c], reference["dC_dkN"][k]);
    compare(found.by_kT[c], reference["dC_dkT"][k]);
  }
}

TEST_CASE("the_stiffness_is_the_sum_of_springs_times_its_derivatives") {
  const bool periodic = GENERATE(true, false), bend = GENERATE(false, true);
  for (const auto& [name, assembly] : assemblies(periodic)) {
    CAPTURE(name, periodic, bend);
    const ContactSprings springs = springs_of(assembly, bend);
    const EffectiveStiffness result = effective_stiffness(
        assembly, springs, {.boundary = periodic ? Boundary::periodic : Boundary::displacement, .solver = {}});
    const SpringSensitivities found = spring_sensitivities(assembly, springs, result);
    Matrix3 sum{};
    for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
      sum = sum + springs[c].kN * found.by_kN[c] + springs[c].kT * found.by_kT[c];
      if (bend) sum = sum + springs.bending(c) * found.by_kM[c];
    }
    CHECK(relative_difference(sum, result.stiffness) < 1e-10);
  }
}

TEST_CASE("a_small_change_of_a_spring_changes_the_stiffness_by_its_derivative") {
  const bool bend = GENERATE(false, true);
  for (const auto& [name, assembly] : assemblies(true)) {
    const ContactSprings springs = springs_of(assembly, bend);
    const SpringSensitivities found = spring_sensitivities(assembly, springs, effective_stiffness(assembly, springs));
    for (const std::size_t c : {std::size_t{0}, assembly.contacts.size() / 2}) {
      CAPTURE(name, bend, c);
      const auto difference = [&](double change, const auto& changed) {
        return (0.5 / change) * (stiffness_of(assembly, changed(change)) - stiffness_of(assembly, changed(-change)));
      };
      const auto with = [&](double kN, double kT, double kM) {
        std::vector<SpringConstants> all;
        for (std::size_t k = 0; k < assembly.contacts.size(); ++k) all.push_back(springs[k]);
        all[c].kN += kN, all[c].kT += kT;
        std::vector<double> bending = springs.bending_springs();
        if (bend) bending[c] += kM;
        return ContactSprings(all).with_bending(bending);
      };
      const double step = 1e-3 * springs[c].kT;
      const Matrix3 by_kN = difference(step, [&](double change) { return with(change, 0, 0); });
      const Matrix3 by_kT = difference(step, [&](double change) { return with(0, change, 0); });
      // differences of numbers of the size of C, and the third derivative
      const double rounding = 1e-11 * largest(stiffness_of(assembly, springs)) / step;
      const auto close = [&](const Matrix3& a, const Matrix3& b, double scale) {
        CHECK(largest(a - b) <= scale * rounding + 1e-5 * largest(b));
      };
      close(by_kN, found.by_kN[c], 1);
      close(by_kT, found.by_kT[c], 1);
      if (!bend) continue;
      const double bending_step = 1e-3 * springs.bending(c);
      close(difference(bending_step, [&](double change) { return with(0, 0, change); }), found.by_kM[c],
            step / bending_step);
    }
  }
}

TEST_CASE("the_stiffness_changes_with_places_and_radii_of_discs_by_its_derivatives") {
  const bool bend = GENERATE(false, true);
  for (const auto& [name, given] : assemblies(true)) {
    Assembly assembly = given;
    place_contact_points(assembly, ContactPoints::radii);
    const ContactSprings springs = springs_of(assembly, bend);
    const ShapeSensitivities found = shape_sensitivities(assembly, springs, effective_stiffness(assembly, springs));
    CAPTURE(name, bend);
    REQUIRE(found.by_radius.size() == assembly.size());
    Random random(4);
    std::vector<Vec2> places(assembly.size());
    std::vector<double> radii(assembly.size());
    Matrix3 by_places{}, by_radii{};
    for (std::size_t d = 0; d < assembly.size(); ++d) {
      const double size = 0.1 * assembly.mean_radius();
      places[d] = {size * random.uniform(-1, 1), size * random.uniform(-1, 1)};
      radii[d] = size * random.uniform(-1, 1);
      by_places = by_places + places[d].x * found.by_position[d][0] + places[d].y * found.by_position[d][1];
      by_radii = by_radii + radii[d] * found.by_radius[d];
    }
    const auto changed = [&](double moved, double grown) {
      Assembly other = assembly;
      for (std::size_t d = 0; d < other.size(); ++d)
        other.centres[d] += moved * places[d], other.radii[d] += grown * radii[d];
      place_contact_points(other, ContactPoints::radii);
      return stiffness_of(other, springs);
    };
    constexpr double h = 1e-3;
    const auto difference = [&](double moved, double grown) {
      const auto over = [&](double t) {
        return (0.5 / t) * (changed(t * moved, t * grown) - changed(-t * moved, -t * grown));
      };
      return (4.0 / 3) * over(h / 2) - (1.0 / 3) * over(h);
    };
    const double scale = largest(stiffness_of(assembly, springs));
    CHECK(largest(difference(1, 0) - by_places) < 1e-7 * scale);
    CHECK(largest(difference(0, 1) - by_radii) < 1e-7 * scale);
  }
}

TEST_CASE("derivatives_by_radii_need_contact_points_that_follow_them") {
  const Assembly assembly = assemblies(true)[3].assembly;
  const ContactSprings springs = springs_of(assembly, false);
  const EffectiveStiffness result = effective_stiffness(assembly, springs);
  CHECK(shape_sensitivities(assembly, springs, result).by_radius.empty());
  const Assembly free = assemblies(false)[0].assembly;
  const ContactSprings on_free = springs_of(free, false);
  const EffectiveStiffness of_free =
      effective_stiffness(free, on_free, {.boundary = Boundary::displacement, .solver = {}});
  CHECK(contains(message_of([&] { shape_sensitivities(free, on_free, of_free); }), "sample with sides"));
}

TEST_CASE("moduli_change_with_the_stiffness_by_their_derivatives") {
  const Matrix3 stiffness{{{3e9, 1e9, 0.1e9}, {1e9, 2.8e9, -0.2e9}, {0.1e9, -0.2e9, 0.9e9}}};
  const Matrix3 change{{{2e6, 1e6, 3e6}, {1e6, -1e6, 0}, {3e6, 0, 4e6}}};
  const std::vector<double> up = numbers(stiffness + change), down = numbers(stiffness - change),
                            found = numbers(change_of_moduli(stiffness, change));
  for (std::size_t k = 0; k < 4; ++k) {
    CAPTURE(k);
    CHECK(found[k] == Approx(0.5 * (up[k] - down[k])).epsilon(1e-5));
  }
}

TEST_CASE("moduli_of_springs_that_scatter_scatter_as_their_derivatives_say") {
  const Assembly assembly = assemblies(true)[2].assembly;
  const ContactSprings springs = springs_of(assembly, false);
  const EffectiveStiffness result = effective_stiffness(assembly, springs);
  constexpr double variation = 0.1;
  const SpringSensitivities by_springs = spring_sensitivities(assembly, springs, result);
  const auto scatter = [&](double ModuliChange::*modulus) {
    return modulus_by_springs(result.stiffness, by_springs, modulus).scatter(springs);
  };
  const std::vector<double> expected =
      numbers(ModuliChange{scatter(&ModuliChange::bulk_modulus_2d), scatter(&ModuliChange::shear_modulus),
                           scatter(&ModuliChange::young_modulus), scatter(&ModuliChange::poisson_ratio)});
  const MeanShift shift = mean_shift_of_moduli(assembly, springs, result, by_springs);
  const std::vector<double> shifts = numbers(shift.shift), errors = numbers(shift.standard_error);
  constexpr std::size_t samples = 400;
  Random random(11);
  std::vector<std::vector<double>> drawn(4);
  for (std::size_t n = 0; n < samples; ++n) {
    std::vector<SpringConstants> all;
    for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
      const double factor = 1 + variation * std::sqrt(3.0) * random.uniform(-1, 1);  // a variance of variation²
      all.push_back({factor * springs[c].kN, factor * springs[c].kT});
    }
    const std::vector<double> moduli = numbers(stiffness_of(assembly, ContactSprings(all)));
    for (std::size_t k = 0; k < 4; ++k) drawn[k].push_back(moduli[k]);
  }
  for (std::size_t k = 0; k < 4; ++k) {
    double mean = 0, square = 0;
    for (const double value : drawn[k]) mean += value / samples;
    for (const double value : drawn[k]) square += (value - mean) * (value - mean) / (samples - 1);
    CAPTURE(k, variation * expected[k], std::sqrt(square));
    // a standard deviation of n samples scatters by 1/sqrt(2 n) = 3.5 %; the second order is of the size of variation²
    CHECK(std::sqrt(square) ==
          Approx(variation * expected[k]).epsilon(3 / std::sqrt(2.0 * samples) + variation * variation));
    // of the mean: its scatter, that of the probes, and the fourth order
    const double before = numbers(result.stiffness)[k], moved = variation * variation * shifts[k],
                 error = std::hypot(std::sqrt(square / samples), variation * variation * errors[k]);
    CAPTURE(mean - before, moved, error);
    CHECK(std::abs(mean - before - moved) <= 3.5 * error + variation * variation * std::abs(moved));
  }
}

TEST_CASE("mean_moduli_shift_by_half_the_second_derivatives_by_the_springs_of_each_contact") {
  const bool periodic = GENERATE(true, false), bend = GENERATE(true, false);
  const Assembly assembly = assemblies(periodic)[0].assembly;
  const ContactSprings springs = springs_of(assembly, bend);
  const Boundary boundary = periodic ? Boundary::periodic : Boundary::displacement;
  const auto homogenized = [&](const ContactSprings& of) {
    return effective_stiffness(assembly, of, {.boundary = boundary, .solver = {}});
  };
  const EffectiveStiffness result = homogenized(springs);
  std::vector<double> expected(4, 0.0);
  const std::vector<double> middle = numbers(result.stiffness);
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    constexpr double h = 1e-3;
    const auto changed = [&](double by) {
      std::vector<SpringConstants> all;
      std::vector<double> bending;
      for (std::size_t k = 0; k < assembly.contacts.size(); ++k) {
        const double factor = k == c ? 1 + by : 1;
        all.push_back({factor * springs[k].kN, factor * springs[k].kT});
        if (bend) bending.push_back(factor * springs.bending(k));
      }
      const ContactSprings of(all);
      return numbers(homogenized(bend ? of.with_bending(bending) : of).stiffness);
    };
    const std::vector<double> up = changed(h), down = changed(-h);
    for (std::size_t k = 0; k < 4; ++k) expected[k] += 0.5 * (up[k] - 2 * middle[k] + down[k]) / (h * h);
  }
  const MeanShift found =
      mean_shift_of_moduli(assembly, springs, result, spring_sensitivities(assembly, springs, result), {.probes = 400});
  const std::vector<double> shifts = numbers(found.shift), errors = numbers(found.standard_error);
  for (std::size_t k = 0; k < 4; ++k) {
    CAPTURE(periodic, bend, k, middle[k], expected[k], shifts[k], errors[k]);
    CHECK(std::abs(shifts[k] - expected[k]) <= 3.5 * errors[k] + 1e-4 * std::abs(expected[k]));
    if (k < 3) CHECK(shifts[k] < 0);  // the stiffness is concave in the springs
    if (k < 3) CHECK(errors[k] < 0.1 * std::abs(shifts[k]));
  }
}

TEST_CASE("derivatives_by_springs_are_refused_where_they_do_not_exist") {
  const Assembly assembly = assemblies(false)[0].assembly;
  const ContactSprings springs(SpringConstants{1e9, 0.5e9});
  const EffectiveStiffness tractions =
      effective_stiffness(assembly, springs, {.boundary = Boundary::traction, .solver = {}});
  CHECK_THROWS_WITH(spring_sensitivities(assembly, springs, tractions), Catch::Contains("tractions"));
  const Assembly cell = assemblies(true)[0].assembly;
  const ContactSprings unstable(SpringConstants{1e9, -0.6e9});
  const EffectiveStiffness lost = effective_stiffness(cell, unstable);
  CAPTURE(lost.unstable_modes.value_or(-1));
  CHECK_THROWS_WITH(spring_sensitivities(cell, unstable, lost), Catch::Contains("unstable mode"));
}
