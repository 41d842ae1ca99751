// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Where an effective stiffness ends: sizes of springs, limits of stability, networks that no continuum is like.

#include "equidem/homogenize/effective_stiffness.hpp"

#include "homogenize/samples.hpp"
#include "homogenize/tensors.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace samples;

namespace {

Assembly random_cell(std::uint64_t seed, std::int64_t discs = 30) {
  return delaunay_assembly({.discs = discs, .seed = seed, .periodic = true});
}

EffectiveStiffness stiffness_of(const Assembly& cell, SpringConstants k, Boundary boundary = Boundary::periodic) {
  return effective_stiffness(cell, ContactSprings(k), {.boundary = boundary, .rotation = {}, .solver = {}});
}

}  // namespace

TEST_CASE("a_mean_strain_that_releases_energy_counts_as_an_unstable_mode") {
  int by_strain_alone = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const EffectiveStiffness c = stiffness_of(random_cell(seed), {1, -0.3});
    const auto values = eigenstrains(c.stiffness).values;
    const auto negative = std::count_if(values.begin(), values.end(), [](double v) { return v < 0; });
    CAPTURE(seed, values[0], values[1], values[2], c.unstable_modes);
    CHECK(c.unstable_strains == negative);
    CHECK(c.unstable_modes >= negative);
    if (negative > 0 && c.unstable_modes == negative) ++by_strain_alone;
    // Inertia is that of motions and mean strain together: the boundary that holds them both is no more unstable.
    if (c.unstable_modes == 0)
      CHECK(stiffness_of(random_cell(seed), {1, -0.3}, Boundary::displacement).unstable_modes == 0);
  }
  CHECK(by_strain_alone > 0);  // else no cell would be unstable by mean strain alone
}

TEST_CASE("bounds_do_not_depend_on_how_equal_springs_are_given") {
  const int discs = GENERATE(1, 2);
  const Boundary boundary = GENERATE(Boundary::periodic, Boundary::displacement, Boundary::traction);
  const Assembly cell = square_lattice({.columns = discs, .rows = 1, .radius = 0.5, .periodic = true});
  const SpringConstants k{1, 0.5};
  const HomogenizeOptions options{.boundary = boundary, .rotation = {}, .solver = {}};
  const ContactSprings each(std::vector<SpringConstants>(cell.contacts.size(), k));
  CAPTURE(discs, to_string(boundary));
  CHECK(effective_stiffness(cell, each, options).stiffness ==
        effective_stiffness(cell, ContactSprings(k), options).stiffness);
}
