// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Waves and the homogenized continuum tell of the same sound; the survey of a cell says what closed forms say.
#include "equidem/waves/wave_survey.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/waves/stability.hpp"

#include "support/catch.hpp"
#include "support/fields.hpp"
#include "waves/networks.hpp"

using namespace equidem;
using namespace equidem::test;

// Two independent roads to one number: perturbation of the dynamic matrix, and load cases on a factorized stiffness.
TEST_CASE("the_sound_of_long_waves_is_that_of_the_homogenized_continuum") {
  const Assembly assembly = GENERATE(periodic_hexagonal(3, 4), periodic_square(3, 3), random_cell(10, 1),
                                     random_cell(40, 2), random_cell(25, 7));
  const Rotation rotation = GENERATE(Rotation::free, Rotation::restrained);
  const double ratio = GENERATE(-0.1, 0.4, 1.0);
  const ContactSprings springs(SpringConstants{2, ratio * 2});
  const BlochWaves waves(primitive_cell(assembly, springs), unit_masses(assembly), rotation == Rotation::free);
  const EffectiveStiffness homogenized = effective_stiffness(assembly, springs, {.rotation = rotation});
  for (const double angle : {0.0, 0.4, 0.8, 1.3, 2.5}) {
    const Vec2 n{std::cos(angle), std::sin(angle)};
    const auto found = waves.sound_speeds(n);
    const PlaneWaves expected = plane_waves(homogenized.gradient_stiffness, waves.mass_per_area(), n);
    CAPTURE(assembly.kind, assembly.size(), ratio, angle, rotation == Rotation::free);
    CHECK(found.longitudinal_squared == Approx(expected.longitudinal_squared).epsilon(1e-10));
    CHECK(found.transverse_squared == Approx(expected.transverse_squared).epsilon(1e-10));
  }
}

TEST_CASE("the_sound_under_forces_at_rest_is_that_of_the_strained_continuum") {
  Assembly assembly = GENERATE(periodic_hexagonal(3, 4), periodic_square(3, 3), random_cell(10, 1), random_cell(40, 2));
  const std::size_t strain = GENERATE(0U, 1U, 2U);
  const ContactSprings bare(SpringConstants{2, 0.8});
  const StrainedState at_rest = strained_states(assembly, bare, effective_stiffness(assembly, bare), -0.02).at(strain);
  for (const ContactForce& f : at_rest.forces) {
    assembly.contact_normal_force.push_back(f.normal);
    assembly.contact_tangential_force.push_back(f.tangential);
  }
  const ContactSprings springs = bare.with_prestress(prestress_of(assembly));
  const BlochWaves waves(primitive_cell(assembly, springs), unit_masses(assembly), true);
  const EffectiveStiffness homogenized = effective_stiffness(assembly, springs);
  const BlochWaves unloaded(primitive_cell(assembly, bare), unit_masses(assembly), true);
  double change = 0;
  for (const double angle : {0.0, 0.4, 0.8, 1.3, 2.5}) {
    const Vec2 n{std::cos(angle), std::sin(angle)};
    const auto found = waves.sound_speeds(n);
    const PlaneWaves expected = plane_waves(homogenized.gradient_stiffness, waves.mass_per_area(), n);
    CAPTURE(assembly.kind, assembly.size(), strain, angle);
    CHECK(found.longitudinal_squared == Approx(expected.longitudinal_squared).epsilon(1e-10));
    CHECK(found.transverse_squared == Approx(expected.transverse_squared).epsilon(1e-10));
    const double without = unloaded.sound_speeds(n).transverse_squared;
    change = std::max(change, std::abs(found.transverse_squared / without - 1));
  }
  CHECK(change > 1e-3);
}

TEST_CASE("a_compressed_lattice_buckles_by_the_wave_that_its_forces_outweigh") {
  // Rows along x under N0 < 0: a transverse wave along x has the stiffness 2 (kT + N0/l) (1 - cos ql) where no disc
  // turns.
  Assembly lattice = periodic_square(2, 2);
  constexpr double kT = 0.1, diameter = 2;
  for (const double share : {0.9, 1.1}) {
    lattice.contact_normal_force.clear();
    for (const Contact& contact : lattice.contacts) {
      const bool along_x = std::abs(lattice.branch(contact).x) > 1;
      lattice.contact_normal_force.push_back(along_x ? -share * kT * diameter : 0.0);
    }
    lattice.contact_tangential_force.assign(lattice.contacts.size(), 0.0);
    const ContactSprings springs = ContactSprings({1, kT}).with_prestress(prestress_of(lattice));
    const Stability s = analyze_stability(lattice, springs, {}, {.rotation = Rotation::restrained, .density = 1});
    REQUIRE(s.survey);
    const double mass = s.survey->mass_per_area * lattice.area() / static_cast<double>(lattice.size());
    const double at_edge = 4 * kT * (share - 1) / mass;
    CAPTURE(share, s.survey->growing.value, at_edge, s.survey->growing.at.name);
    CHECK(s.status() == (share > 1 ? "unstable" : "stable"));
    CHECK_FALSE(s.survey->ratio_sought);
    if (share > 1) {
      CHECK(s.survey->growing.value == Approx(at_edge).epsilon(1e-9));
      CHECK(s.growth_rate() == Approx(std::sqrt(at_edge)).epsilon(1e-9));
    }
  }
}

TEST_CASE("waves_and_continuum_of_one_analysis_have_one_mass_and_one_sound") {
  constexpr double density = 2600;
  const Assembly cell = GENERATE(periodic_hexagonal(3, 4), random_cell(12, 4));
  const Stability s = analyze_stability(cell, ContactSprings(SpringConstants{1e9, 0.4e9}), {}, {.density = density});
  double discs = 0;
  for (const double radius : cell.radii) discs += std::numbers::pi * radius * radius;
  CAPTURE(cell.size(), s.mass_per_area, s.no_continuum);
  CHECK(s.mass_per_area == Approx(density * discs / cell.area()).epsilon(1e-12));
  REQUIRE(s.survey);
  REQUIRE(s.sound.size() == s.survey->sound.size());
  for (std::size_t k = 0; k < s.sound.size(); ++k) {
    const BlochWaves::SoundSpeeds& waves = s.survey->sound[k].speeds;
    CAPTURE(s.survey->sound[k].angle, waves.longitudinal_squared, waves.transverse_squared);
    CHECK(s.sound[k].longitudinal_squared == Approx(waves.longitudinal_squared).epsilon(1e-8));
    CHECK(s.sound[k].transverse_squared == Approx(waves.transverse_squared).epsilon(1e-8));
  }
}

TEST_CASE("spins_that_grow_where_kT_is_negative_are_no_buckling_under_forces_at_rest") {
  const Assembly lattice = periodic_hexagonal(3, 4);
  const ContactSprings springs = under_forces(lattice, ContactSprings({1, -0.05}), 0.001);
  const Stability s = analyze_stability(lattice, springs, {}, {.density = 1});
  CAPTURE(s.inertia.unstable_modes.value_or(-1), s.growth_rate());
  CHECK(s.inertia.unstable_modes == 0);
  CHECK(s.growth_rate() > 0);
  CHECK(s.status() == "stable");
}

TEST_CASE("the_survey_of_a_lattice_says_what_closed_forms_say") {
  const double kT = GENERATE(-0.2, 0.5);
  const ContactSprings springs(SpringConstants{1, kT});
  const Assembly assembly = periodic_hexagonal(8, 8);
  const WaveSurvey survey =
      survey_waves(primitive_cell(assembly, springs), unit_masses(assembly), Rotation::from_scene);
  CHECK(std::abs(survey.critical.value + 1.0 / 3) < 1e-13);
  CHECK(survey.critical.at.name == "M");
  CHECK(*survey.squared_rotational_gap == Approx(24 * kT).epsilon(1e-12));
  CHECK(survey.highest.value == Approx(std::max(6 + 2 * kT, 24 * kT)).epsilon(1e-12));
  if (kT < 0) CHECK(survey.growing.value == Approx(-24 * kT).epsilon(1e-12));

  // The path runs through the points of symmetry, in even steps of each side.
  std::string names;
  for (const PathPoint& point : survey.path) names += point.at.name.empty() ? "" : point.at.name + " ";
  CHECK(names == "Gamma M K Gamma ");
  for (std::size_t k = 0; k + 1 < survey.path.size(); ++k) {
    const PathPoint &here = survey.path[k], &next = survey.path[k + 1];
    CHECK(norm(next.at.q - here.at.q) == Approx(next.along - here.along).epsilon(1e-9));
    CHECK(here.squared_frequencies.size() == 3);
    CHECK(here.critical_ratio <= survey.critical.value + 1e-13);
  }
}

// A mean strain is held in the cell itself, but follows in a long wave: which may lose stability first.
TEST_CASE("no_wave_gives_way_before_the_one_that_the_survey_names") {
  const Assembly assembly = random_cell(GENERATE(8, 30), GENERATE(1, 2));
  const ContactSprings springs(SpringConstants{1, 0.5});
  const PrimitiveCell cell = primitive_cell(assembly, springs);
  const WaveSurvey survey = survey_waves(cell, unit_masses(assembly), Rotation::free);
  const BlochWaves waves(cell, unit_masses(assembly), true);
  CAPTURE(assembly.size(), survey.critical.value, survey.critical.at.name);
  // For long waves q is a short wave vector along their direction.
  const bool long_waves = survey.critical.at.name == long_waves_name;
  CHECK(waves.critical_ratio(survey.critical.at.q) == Approx(survey.critical.value).epsilon(long_waves ? 1e-4 : 1e-12));
  if (long_waves) CHECK(survey.critical.value == waves.long_wave_loss().ratio);
  Random random(17);
  for (int k = 0; k < 40; ++k) {
    const Vec2 q =
        random.uniform(-0.5, 0.5) * survey.zone.reciprocal[0] + random.uniform(-0.5, 0.5) * survey.zone.reciprocal[1];
    CAPTURE(q.x, q.y);
    CHECK(waves.critical_ratio(q) <= survey.critical.value + 1e-9);
  }
}

TEST_CASE("rattlers_make_no_waves") {
  Assembly assembly = periodic_hexagonal(4, 4);
  assembly.centres.push_back({0.1, 0.1});
  assembly.radii.push_back(0.01);
  assembly.cell_areas.clear();
  const ContactSprings springs(SpringConstants{1, 0.5});
  const BlochWaves waves(primitive_cell(assembly, springs), unit_masses(assembly), true);
  CHECK(waves.size() == 3 * 16);
  CHECK(waves.squared_frequencies({0.3, 0.2}).front() > 0.01);
}

// Motions that differ from cell to cell, which one cell cannot show.
TEST_CASE("waves_that_cost_nothing_are_mechanisms_of_the_infinite_assembly") {
  const auto free_waves = [](const Assembly& assembly, double kT) {
    const ContactSprings springs(SpringConstants{1e9, kT * 1e9});
    return survey_waves(primitive_cell(assembly, springs), unit_masses(assembly), Rotation::from_scene)
        .free_waves.size();
  };
  for (const double kT : {1e-12, 0.5, -0.2}) {
    CAPTURE(kT);
    CHECK(free_waves(periodic_hexagonal(2, 2), kT) == 0);
    CHECK(free_waves(periodic_square(1, 1), kT) == 1);  // M: neighbours turn like gears
    CHECK(free_waves(random_cell(12, 3), kT) == 0);
  }
  CHECK(free_waves(periodic_hexagonal(2, 2), 0) == 0);
  CHECK(free_waves(periodic_square(1, 1), 0) == 24 + 47);  // rows slide: all of Gamma-X; half of the zone is searched
  Assembly chain = periodic_square(1, 1);
  std::erase_if(chain.contacts, [](const Contact& c) { return c.shift_y != 0; });
  chain.facet_lengths.clear();
  CHECK(free_waves(chain, 0.5) >= 24);  // q along y: chains past chains
}
