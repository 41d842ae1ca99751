// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Where an effective stiffness ends: sizes of springs, limits of stability, networks that no continuum is like.
#include <cmath>
#include <optional>

#include "equidem/homogenize/bounds.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"

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

struct Refused {
  ErrorKind kind;
  std::string message;
};
template <typename Call>
std::optional<Refused> refusal(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return Refused{error.kind(), error.what()};
  }
  return {};
}

/// One spring for contacts along x, another one for the others.
ContactSprings by_direction(const Assembly& cell, SpringConstants along_x, SpringConstants others) {
  std::vector<SpringConstants> each;
  for (const Contact& c : cell.contacts) {
    const Vec2 l = cell.branch(c);
    each.push_back(std::abs(l.y) < 1e-9 * norm(l) ? along_x : others);
  }
  return ContactSprings(std::move(each));
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

TEST_CASE("springs_of_any_size_have_the_stiffness_of_others_times_that_size") {
  const Boundary boundary = GENERATE(Boundary::periodic, Boundary::displacement, Boundary::traction);
  const double size = GENERATE(1e-300, 1e-160, 1e9, 1e160, 1e300);
  const Assembly cell = random_cell(1);
  const EffectiveStiffness one = stiffness_of(cell, {1, 0.5}, boundary),
                           other = stiffness_of(cell, {size, 0.5 * size}, boundary);
  CAPTURE(to_string(boundary), size, other.stiffness[0][0], other.error_bound);
  CHECK(relative_difference((1 / size) * other.stiffness, one.stiffness) < 1e-13);
  CHECK(relative_difference((1 / size) * other.tangential_part, one.tangential_part) < 1e-13);
  CHECK(other.error_bound / size < 1e-12);
  const ContactSprings unit(SpringConstants{1, 0.5}), sized(SpringConstants{size, 0.5 * size});
  CHECK(relative_difference((1 / size) * uniform_stress_estimate(cell, sized), uniform_stress_estimate(cell, unit)) <
        1e-13);
  const EffectiveModuli m = effective_moduli(one.stiffness), n = effective_moduli(other.stiffness);
  CHECK(n.anisotropy == Approx(m.anisotropy));
  CHECK(n.poisson_stress == Approx(m.poisson_stress));
  CHECK(n.young_stress / size == Approx(m.young_stress));
}

TEST_CASE("tangential_springs_next_to_nothing_are_as_good_as_none") {
  const double ratio = GENERATE(1e-13, 1e-20, 1e-109, 1e-200, 1e-300);
  const Assembly cell = random_cell(2, 60);
  const EffectiveStiffness none = stiffness_of(cell, {1, 0}), nearly = stiffness_of(cell, {1, ratio});
  CAPTURE(ratio, nearly.condition, nearly.error_bound);
  CHECK(relative_difference(nearly.stiffness, none.stiffness) < 1e-12 + 10 * ratio);
  CHECK(nearly.error_bound < 1e-10);
}

TEST_CASE("at_its_limit_of_stability_a_network_is_not_called_floppy") {
  // From both sides to the ratio at which a motion of the cell first has no energy: C has a pole there.
  const Assembly cell = random_cell(GENERATE(1, 2, 3), 12);
  double stable = 0, lost = -0.5;
  std::optional<Refused> last;
  while (stable - lost > 1e-16 * -lost) {
    const double middle = (stable + lost) / 2;
    if (middle == stable || middle == lost) break;
    bool is_stable = false;
    const auto refused = refusal([&] {
      const EffectiveStiffness c = stiffness_of(cell, {1, middle});
      is_stable = c.unstable_modes == c.unstable_strains;  // the cell itself stands
    });
    (is_stable ? stable : lost) = middle;
    if (!refused) continue;
    last = refused;
    CAPTURE(middle, refused->message);
    CHECK_FALSE(contains(refused->message, "floppy"));
    CHECK_FALSE(contains(refused->message, "Add contacts"));
    CHECK(refused->kind == ErrorKind::computation_failed);
  }
  CAPTURE(stable, lost);
  CHECK(stable < 0);
  CHECK(last);  // the pole was met
}

TEST_CASE("springs_too_far_apart_are_told_from_a_floppy_network") {
  const LatticeOptions options{.columns = 6, .rows = 6, .radius = 0.5, .periodic = true};
  const double weak = GENERATE(1e-16, 1e-20, 1e-60, 1e-100);
  CAPTURE(weak);
  SECTION("a rigid lattice") {
    const Assembly cell = hexagonal_lattice(options);
    const auto refused = refusal([&] {
      static_cast<void>(effective_stiffness(cell, by_direction(cell, {1, 0.5}, {weak, 0.5 * weak})));
    });
    REQUIRE(refused);
    CAPTURE(refused->message);
    CHECK(contains(refused->message, "differ by a factor"));
    CHECK(refused->kind == ErrorKind::bad_input);
  }
  SECTION("a lattice that is floppy whatever its springs") {
    const Assembly cell = square_lattice(options);
    const auto refused = refusal([&] {
      static_cast<void>(effective_stiffness(cell, by_direction(cell, {1, 0}, {weak, 0})));
    });
    REQUIRE(refused);
    CAPTURE(refused->message);
    CHECK((contains(refused->message, "floppy") || contains(refused->message, "differ by a factor")));
    CHECK(refused->kind == ErrorKind::bad_input);
  }
}

TEST_CASE("levers_that_do_not_add_up_to_their_branch_are_refused_where_discs_turn") {
  Assembly cell = square_lattice({.columns = 3, .rows = 3, .radius = 0.5, .periodic = true});
  static_cast<void>(stiffness_of(cell, {1, 0.5}));
  const double off = GENERATE(1e-7, 0.1, -0.3);
  cell.contacts[4].lever_i += off;
  CAPTURE(off);
  const auto refused = refusal([&] { static_cast<void>(stiffness_of(cell, {1, 0.5})); });
  REQUIRE(refused);
  CAPTURE(refused->message);
  CHECK(contains(refused->message, "contact 4, of discs"));
  CHECK(refused->kind == ErrorKind::bad_input);
  const HomogenizeOptions restrained{.boundary = {}, .rotation = Rotation::restrained, .solver = {}};
  CHECK(relative_difference(effective_stiffness(cell, ContactSprings(SpringConstants{1, 0.5}), restrained).stiffness,
                            {{{1, 0, 0}, {0, 1, 0}, {0, 0, 0.25}}}) < 1e-12);
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
