// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Strain from the motion of discs: gauges and the fitted displacement gradient.
#include <string>
#include <vector>

#include "equidem/homogenize/tension_test.hpp"

#include "homogenize/samples.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace samples;

namespace {

bool everywhere(std::size_t) {
  return true;
}

std::vector<DiscMotion> affine_motions(const Assembly& assembly, const Tensor2& gradient, Vec2 rigid) {
  std::vector<DiscMotion> motions(assembly.size());
  for (std::size_t disc = 0; disc < motions.size(); ++disc) motions[disc].u = rigid + gradient * assembly.centres[disc];
  return motions;
}

Assembly discs_at(const std::vector<Vec2>& centres, const std::vector<double>& areas) {
  Assembly assembly;
  assembly.centres = centres;
  assembly.radii.assign(centres.size(), 1.0);
  assembly.cell_areas = areas;
  return assembly;
}

}  // namespace

TEST_CASE("fit_and_gauges_find_a_uniform_gradient_under_any_rigid_motion") {
  // 100 times the block in translation and in distance from the origin: two digits may go.
  const double far = GENERATE(0.0, 10.0);
  Random random(11);
  for (const auto& [name, assembly] : assemblies(false)) {
    const Tensor2 gradient = random_tensor(random);
    Assembly moved = assembly;
    for (Vec2& x : moved.centres) x += Vec2{far, -far};
    const auto motions = affine_motions(moved, gradient, {far, 2 * far});
    const double tolerance = far == 0 ? 1e-13 : 1e-11;
    const Tensor2 whole = fitted_displacement_gradient(moved, motions, everywhere);
    double middle = 0;
    for (const Vec2 x : moved.centres) middle += x.x / static_cast<double>(moved.size());
    const Tensor2 half =
        fitted_displacement_gradient(moved, motions, [&](std::size_t disc) { return moved.centres[disc].x < middle; });
    CAPTURE(name, far, shown(gradient), shown(whole), shown(half));
    CHECK(difference(whole, gradient) < tolerance);
    CHECK(difference(half, gradient) < 4 * tolerance);

    // A gauge reads n . e n, e the symmetric part: the rotation in the gradient elongates nothing.
    const StrainGauge gauge{.first = 1, .second = static_cast<std::int32_t>(moved.size()) - 2};
    const Vec2 l = moved.centres[gauge.second] - moved.centres[gauge.first];
    const Vec2 n = l / norm(l);
    const double expected = gradient.xx * n.x * n.x + (gradient.xy + gradient.yx) * n.x * n.y + gradient.yy * n.y * n.y;
    CHECK(std::abs(gauge_strain(moved, motions, gauge) - expected) < tolerance);
    CHECK(std::abs(gauge_strain(moved, motions, {.first = gauge.second, .second = gauge.first}) - expected) <
          tolerance);
  }
}

TEST_CASE("fit_leaves_no_gradient_in_what_it_does_not_explain") {
  // Normal equations: sum w (u - mean u - h dx) dx = 0 for motions of any shape.
  for (const auto& [name, assembly] : assemblies(false)) {
    Random random(12);
    std::vector<DiscMotion> motions(assembly.size());
    for (DiscMotion& m : motions) {
      m.u.x = random.uniform(-1, 1);
      m.u.y = random.uniform(-1, 1);
    }
    const Tensor2 h = fitted_displacement_gradient(assembly, motions, everywhere);
    Vec2 centre, mean;
    for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
      centre += assembly.cell_areas[disc] / assembly.area() * assembly.centres[disc];
      mean += assembly.cell_areas[disc] / assembly.area() * motions[disc].u;
    }
    Tensor2 left_over, scale;
    for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
      const Vec2 dx = assembly.centres[disc] - centre;
      left_over += assembly.cell_areas[disc] * outer(motions[disc].u - mean - h * dx, dx);
      scale.xx += assembly.cell_areas[disc] * norm(dx);
    }
    CAPTURE(name, shown(h), largest(left_over) / scale.xx);
    CHECK(largest(left_over) < 1e-13 * scale.xx);
  }
}

TEST_CASE("a_cell_of_twice_the_area_counts_as_two_discs") {
  const std::vector<Vec2> centres = {{0, 0}, {1, 0}, {0, 1}, {1.2, 1.1}};
  std::vector<DiscMotion> motions(4);
  motions[0].u = {0.1, 0.2};
  motions[1].u = {-0.3, 0.4};
  motions[2].u = {0.5, 0.1};
  motions[3].u = {0.2, -0.6};
  const Assembly heavy = discs_at(centres, {1, 1, 1, 2});
  const Tensor2 weighted = fitted_displacement_gradient(heavy, motions, everywhere);

  auto twice = centres;
  twice.push_back(centres[3]);
  auto motions_twice = motions;
  motions_twice.push_back(motions[3]);
  const Assembly doubled = discs_at(twice, {});
  CHECK(difference(weighted, fitted_displacement_gradient(doubled, motions_twice, everywhere)) < 1e-15);
  CHECK(difference(weighted, fitted_displacement_gradient(discs_at(centres, {}), motions, everywhere)) > 1e-3);
}

TEST_CASE("no_gradient_can_be_fitted_to_discs_on_one_line") {
  const Vec2 direction = GENERATE(Vec2{1, 0}, Vec2{0, 1}, Vec2{1, 0.3}, Vec2{-0.7, 1});
  for (const int discs : {0, 1, 2, 3, 1000}) {
    std::vector<Vec2> centres;
    for (int k = 0; k < discs; ++k) centres.push_back(Vec2{0.1, 5} + 0.01 * k * direction);
    const Assembly line = discs_at(centres, {});
    CAPTURE(discs, direction.x, direction.y);
    const std::string message = message_of([&] {
      static_cast<void>(fitted_displacement_gradient(line, std::vector<DiscMotion>(centres.size()), everywhere));
    });
    CAPTURE(message);
    CHECK(contains(message, "a displacement gradient cannot be fitted to " + std::to_string(discs) + " disc"));
  }
}

TEST_CASE("two_rows_of_discs_are_enough_for_a_gradient_however_long") {
  const Assembly strip = hexagonal_lattice({.columns = 20000, .rows = 2, .radius = 0.005, .periodic = false});
  const Tensor2 gradient{0.1, -0.2, 0.3, 0.4};
  const Tensor2 found = fitted_displacement_gradient(strip, affine_motions(strip, gradient, {}), everywhere);
  CAPTURE(shown(found));
  CHECK(difference(found, gradient) < 1e-7);  // the strip is 1e4 times longer than high
}
