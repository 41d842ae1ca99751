// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Waves of bodies that touch off the lines of their centres.
#include <cmath>
#include <numbers>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/waves/vibration.hpp"
#include "equidem/waves/wave_survey.hpp"

#include "support/catch.hpp"
#include "support/off_line_networks.hpp"
#include "waves/networks.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// The cell twice along x, every other contact named from its other end.
Assembly doubled(const Assembly& cell) {
  const auto n = static_cast<std::int32_t>(cell.size());
  Assembly all = cell;
  all.contacts.clear(), all.contact_arms.clear(), all.cell_areas.clear();
  all.period->x *= 2;
  for (std::int32_t d = 0; d < n; ++d) {
    all.centres.push_back(cell.centres[d] + Vec2{cell.period->x, 0});
    all.radii.push_back(cell.radii[d]);
    all.sections.push_back(cell.sections[d]);
  }
  for (int x = 0; x < 2; ++x) {
    for (std::size_t c = 0; c < cell.contacts.size(); ++c) {
      const Contact& k = cell.contacts[c];
      const ContactArms& arms = cell.contact_arms[c];
      const int to = x + k.shift_x, turns = to >= 0 ? to / 2 : -((1 - to) / 2);
      Contact image{x * n + k.i, (to - 2 * turns) * n + k.j, turns, k.shift_y, k.lever_i, k.lever_j};
      ContactArms seen = arms;
      if (c % 2 == 1) {
        image = {image.j, image.i, -image.shift_x, -image.shift_y, image.lever_j, image.lever_i};
        seen = {-arms.normal, arms.offset_j, arms.offset_i};
      }
      all.contacts.push_back(image);
      all.contact_arms.push_back(seen);
    }
  }
  return all;
}

Assembly cell_of(std::uint64_t seed, std::int64_t bodies = 12) {
  return off_line(random_cell(bodies, seed), seed);
}

}  // namespace

TEST_CASE("no_assembly_of_bodies_vibrates_faster_than_its_element_bound") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Assembly assembly = cell_of(seed, 30);
    Random random(seed);
    std::vector<SpringConstants> each(assembly.contacts.size());
    for (SpringConstants& k : each) k = {std::pow(10, random.uniform(-1, 1)), std::pow(10, random.uniform(-3, 1))};
    if (seed % 4 == 0) each.assign(each.size(), {1, 0});
    const ContactSprings springs(each);
    const auto inertia = inertia_of(assembly, 2000, Body::disc);
    CHECK(inertia[3].mass == 2000 * assembly.sections[3].area);
    CHECK(inertia[3].moment == 2000 * assembly.sections[3].polar_moment);
    const Effects effects = derive_effects(assembly, springs, Rotation::from_scene);
    REQUIRE(effects.rotation);
    const double found = extreme_squared_frequency(assembly, springs, number_unknowns(assembly, springs, effects, {}),
                                                   inertia, SpectrumEnd::largest)
                             .value;
    const double bound = element_bound(assembly, springs, inertia, true);
    CAPTURE(seed, found, bound);
    CHECK(found <= bound * (1 + 1e-12));
    CHECK(found > 0.05 * bound);
  }
}

TEST_CASE("a_cell_of_bodies_is_found_in_its_repetitions_with_the_same_waves") {
  const Assembly cell = cell_of(3);
  const ContactSprings springs(SpringConstants{1, 0.4});
  const Assembly twice = doubled(cell);
  check(twice);
  const PrimitiveCell found = primitive_cell(twice, springs);
  REQUIRE(found.size() == cell.size());
  CHECK(found.copies == 2);
  const BlochWaves waves(found, inertia_of(twice, 1, Body::disc), true),
      given(given_cell(cell, springs), inertia_of(cell, 1, Body::disc), true);
  for (const Vec2 q : {Vec2{}, Vec2{0.1, 0.05}, Vec2{-0.3, 0.2}}) {
    const auto a = waves.squared_frequencies(q), b = given.squared_frequencies(q);
    REQUIRE(a.size() == b.size());
    CAPTURE(q.x, q.y);
    for (std::size_t k = 0; k < a.size(); ++k) CHECK(a[k] == Approx(b[k]).margin(1e-12 * b.back()));
  }
  // A body that is only a little heavier is another one.
  Assembly other = twice;
  other.sections[2].polar_moment *= 1.001;
  CHECK(primitive_cell(other, springs).size() == twice.size());
}

TEST_CASE("long_waves_of_bodies_run_as_the_homogenized_continuum_says") {
  const std::uint64_t seed = GENERATE(4, 5);
  const double kT = GENERATE(0.5, 0.05);
  const Assembly cell = cell_of(seed);
  const ContactSprings springs(SpringConstants{1, kT});
  const BlochWaves waves(given_cell(cell, springs), inertia_of(cell, 2, Body::disc), true);
  const Matrix4 c = effective_stiffness(cell, springs).gradient_stiffness;
  for (const double angle : {0.0, 0.6, 1.9}) {
    const Vec2 n{std::cos(angle), std::sin(angle)};
    const auto sound = waves.sound_speeds(n);
    const PlaneWaves plane = plane_waves(c, waves.mass_per_area(), n);
    CAPTURE(seed, kT, angle);
    CHECK(sound.longitudinal_squared == Approx(plane.longitudinal_squared).epsilon(1e-9));
    CHECK(sound.transverse_squared == Approx(plane.transverse_squared).epsilon(1e-9));
  }
}

TEST_CASE("a_survey_of_bodies_seeks_no_critical_ratio") {
  const Assembly cell = cell_of(6, 4);
  const ContactSprings springs(SpringConstants{1, 0.3});
  const auto inertia = inertia_of(cell, 1, Body::disc);
  const WaveSurvey survey = survey_waves(primitive_cell(cell, springs), inertia, Rotation::from_scene);
  CHECK_FALSE(survey.ratio_sought);
  CHECK(survey.critical.on_grid.empty());
  CHECK(survey.highest.value <= element_bound(cell, springs, inertia, true) * (1 + 1e-12));
  CHECK(std::isnan(survey.path.front().critical_ratio));
}
