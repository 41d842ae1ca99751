// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Abe (1996), eqs. (11), (21), (22), on random assemblies: where the mean field is exact, how its error grows, and the
/// effect of its correction.
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/material/spring_relations.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

constexpr double kN = 2e8;
constexpr std::array weightings{SpringWeighting::uniform, SpringWeighting::contact_density, SpringWeighting::voronoi,
                                SpringWeighting::local_contact_density};

Assembly random_cell(PointProcess points, double disorder, std::uint64_t seed, double largest_radius = 0.005) {
  return delaunay_assembly({.discs = 200,
                            .points = points,
                            .disorder = disorder,
                            .seed = seed,
                            .radii = {.smallest = 0.005, .largest = largest_radius},
                            .periodic = true});
}

/// The points moved to (1.2 x, y/1.2), then triangulated: contacts and branches depend on direction.
Assembly stretched_cell(std::uint64_t seed) {
  Assembly cell = random_cell(PointProcess::poisson_disc, 0, seed);
  const auto stretched = [](Vec2 v) { return Vec2{1.2 * v.x, v.y / 1.2}; };
  for (Vec2& centre : cell.centres) centre = stretched(centre);
  cell.period = stretched(*cell.period);
  triangulate(cell);
  return cell;
}

EffectiveModuli exact_moduli(const Assembly& cell, double ratio, SpringWeighting weighting,
                             Rotation rotation = Rotation::from_scene) {
  const ContactSprings springs = contact_springs(cell, {kN, ratio * kN}, weighting);
  return effective_moduli(effective_stiffness(cell, springs, {.rotation = rotation, .solver = {}}).stiffness);
}

/// Eqs. (21), (22) with phi and psi = z/(2 pi) measured; springs k/psi make psi k = k.
ElasticModuli mean_field(const Assembly& cell, double ratio, SpringWeighting weighting) {
  IsotropicMeasures measures{.solid_fraction = cell.solid_fraction(),
                             .contact_density = cell.coordination_number() / (2 * std::numbers::pi)};
  if (weighting != SpringWeighting::uniform) measures.contact_density = 1;
  return moduli_of({kN, ratio * kN}, isotropic_relation, measures);
}

template <typename Item>
MeanEstimate mean_over_seeds(int seeds, const Item& item) {
  std::vector<double> values;
  for (int seed = 1; seed <= seeds; ++seed) values.push_back(item(static_cast<std::uint64_t>(seed)));
  return estimate_mean(values, 0.997);  // three standard deviations
}

}  // namespace

TEST_CASE("without_disorder_the_mean_field_is_exact") {
  const SpringWeighting weighting =
      GENERATE(SpringWeighting::uniform, SpringWeighting::contact_density, SpringWeighting::local_contact_density);
  const Assembly cell = random_cell(PointProcess::perturbed_hexagonal, 0, 1);
  for (const double ratio : {0.0, 0.1, 0.5, 1.0}) {
    const EffectiveModuli exact = exact_moduli(cell, ratio, weighting);
    const ElasticModuli expected = mean_field(cell, ratio, weighting);
    CAPTURE(to_string(weighting), ratio, exact.shear_modulus, expected.shear_modulus);
    CHECK(exact.shear_modulus == Approx(expected.shear_modulus).epsilon(1e-12));
    CHECK(exact.bulk_modulus_2d == Approx(expected.bulk_modulus_2d()).epsilon(1e-12));
    CHECK(exact.poisson_strain == Approx(expected.poisson_ratio).margin(1e-12));
    CHECK(exact.anisotropy < 1e-12);
  }
}

TEST_CASE("errors_of_the_mean_field_grow_as_the_square_of_the_disorder") {
  // To first order in the displacements of points the stiffness changes by sums of differences along closed paths.
  const SpringWeighting weighting = GENERATE(from_range(weightings));
  const double ratio = GENERATE(0.0, 0.4);
  const auto errors = [&](double disorder) {
    const EffectiveModuli none = exact_moduli(random_cell(PointProcess::perturbed_hexagonal, 0, 7), ratio, weighting);
    const EffectiveModuli some =
        exact_moduli(random_cell(PointProcess::perturbed_hexagonal, disorder, 7), ratio, weighting);
    return std::array{some.shear_modulus / none.shear_modulus - 1, some.poisson_strain - none.poisson_strain};
  };
  const auto small = errors(0.01), twice = errors(0.02);
  for (std::size_t k = 0; k < small.size(); ++k) {
    CAPTURE(to_string(weighting), ratio, k, small[k], twice[k]);
    CHECK(std::abs(small[k]) > 1e-6);
    CHECK(twice[k] / small[k] == Approx(4).epsilon(0.05));
  }
}

TEST_CASE("the_bulk_modulus_of_springs_h_over_l_is_half_kN_on_every_assembly") {
  // An isotropic strain e loads a disc with forces kN e h n on its facets; around a closed cell sum h n = 0, so every
  // disc follows the uniform strain without rotation.
  const PointProcess points =
      GENERATE(PointProcess::perturbed_hexagonal, PointProcess::poisson_disc, PointProcess::uniform);
  const Rotation rotation = GENERATE(Rotation::from_scene, Rotation::restrained);
  const double largest_radius = GENERATE(0.005, 0.007);
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Assembly cell = random_cell(points, 0.4, seed, largest_radius);
    for (const double ratio : {0.0, 0.3, 1.0, 3.0}) {
      const double bulk = exact_moduli(cell, ratio, SpringWeighting::voronoi, rotation).bulk_modulus_2d;
      CAPTURE(to_string(points), largest_radius, seed, ratio, bulk / kN);
      CHECK(bulk == Approx(kN / 2).epsilon(1e-12));
    }
  }
}

TEST_CASE("nu_of_at_most_one_quarter_is_a_limit_of_the_mean_field_and_not_of_assemblies") {
  const PointProcess points = GENERATE(PointProcess::poisson_disc, PointProcess::uniform);
  const auto nu = [&](SpringWeighting weighting) {
    return mean_over_seeds(12, [&](std::uint64_t seed) {
      return exact_moduli(random_cell(points, 0, seed), 0, weighting).poisson_strain;
    });
  };
  const double limit = poisson_ratio_of_ratio(0);
  const MeanEstimate equal = nu(SpringWeighting::uniform), facets = nu(SpringWeighting::voronoi);
  CAPTURE(to_string(points), limit, equal.mean, equal.half_width, facets.mean, facets.half_width);
  CHECK(equal.high() < limit);
  CHECK(facets.low() > limit);
}

TEST_CASE("the_correction_by_contact_density_lowers_the_anisotropy_of_stretched_assemblies_without_removing_it") {
  // Branches are also longer along the stretch, which (11) does not take into account.
  for (const double ratio : {0.0, 0.5}) {
    const MeanEstimate gain = mean_over_seeds(12, [&](std::uint64_t seed) {
      const Assembly cell = stretched_cell(seed);
      return exact_moduli(cell, ratio, SpringWeighting::uniform).anisotropy -
             exact_moduli(cell, ratio, SpringWeighting::contact_density).anisotropy;
    });
    const MeanEstimate left = mean_over_seeds(12, [&](std::uint64_t seed) {
      return exact_moduli(stretched_cell(seed), ratio, SpringWeighting::contact_density).anisotropy -
             exact_moduli(random_cell(PointProcess::poisson_disc, 0, seed), ratio, SpringWeighting::contact_density)
                 .anisotropy;
    });
    CAPTURE(ratio, gain.mean, gain.half_width, left.mean, left.half_width);
    CHECK(gain.low() > 0);
    CHECK(left.low() > 0);
  }
}

TEST_CASE("on_isotropic_assemblies_the_correction_by_contact_density_removes_no_tenth_of_the_error_of_nu") {
  const PointProcess points = GENERATE(PointProcess::poisson_disc, PointProcess::uniform);
  for (const double ratio : {0.0, 0.5}) {
    const MeanEstimate change = mean_over_seeds(20, [&](std::uint64_t seed) {
      const Assembly cell = random_cell(points, 0, seed);
      return exact_moduli(cell, ratio, SpringWeighting::contact_density).poisson_strain -
             exact_moduli(cell, ratio, SpringWeighting::uniform).poisson_strain;
    });
    const MeanEstimate error = mean_over_seeds(20, [&](std::uint64_t seed) {
      return exact_moduli(random_cell(points, 0, seed), ratio, SpringWeighting::uniform).poisson_strain -
             poisson_ratio_of_ratio(ratio);
    });
    CAPTURE(to_string(points), ratio, change.mean, change.half_width, error.mean, error.half_width);
    CHECK(std::abs(error.mean) > error.half_width);
    CHECK(std::abs(change.mean) + change.half_width < 0.1 * std::abs(error.mean));
  }
}

TEST_CASE("a_local_contact_density_halves_the_error_of_nu_on_isotropic_assemblies") {
  const PointProcess points =
      GENERATE(PointProcess::perturbed_hexagonal, PointProcess::poisson_disc, PointProcess::uniform);
  for (const double ratio : {0.0, 0.25}) {
    const auto error = [&](SpringWeighting weighting) {
      return mean_over_seeds(20, [&](std::uint64_t seed) {
        return poisson_ratio_of_ratio(ratio) -
               exact_moduli(random_cell(points, 0.4, seed), ratio, weighting).poisson_strain;
      });
    };
    const MeanEstimate equal = error(SpringWeighting::uniform), local = error(SpringWeighting::local_contact_density);
    CAPTURE(to_string(points), ratio, equal.mean, equal.half_width, local.mean, local.half_width);
    CHECK(equal.low() > 0);
    CHECK(local.mean + local.half_width < 0.7 * equal.mean);
  }
}
