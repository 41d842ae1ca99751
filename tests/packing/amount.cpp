// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Box and radii from two of number, box and solid fraction, without a case file.
#include "equidem/packing/amount.hpp"

#include <string>

#include "equidem/core/error.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

const SizeDistribution radii_of_amounts{.smallest = 0.005, .largest = 0.01};

PackingOptions filled(const PackingAmount& amount, PackingOptions options = {}) {
  set_amount(amount, radii_of_amounts, options);
  return options;
}

double solid_fraction(const PackingOptions& options) {
  return area_of(options.shape, options.radii) / options.box.area();
}

/// The option that an error names.
std::string fault_of_amount(const PackingAmount& amount, PackingOptions options = {}) {
  try {
    set_amount(amount, radii_of_amounts, options);
  } catch (const Error& error) {
    return error.where();
  }
  return "none";
}

}  // namespace

TEST_CASE("two_amounts_fix_box_and_radii") {
  const PackingOptions no_fraction = filled({.grains = 50, .box = Vec2{0.2, 0.1}});
  CHECK(no_fraction.radii.size() == 50);
  CHECK(no_fraction.box.size == Vec2{0.2, 0.1});
  const PackingOptions no_box = filled({.grains = 50, .solid_fraction = 0.7});
  CHECK(no_box.box.size.x == no_box.box.size.y);
  CHECK(solid_fraction(no_box) == Approx(0.7).epsilon(1e-13));
  const PackingOptions no_number = filled({.box = Vec2{0.2, 0.1}, .solid_fraction = 0.7});
  CHECK(solid_fraction(no_number) == Approx(0.7).epsilon(1e-13));
  CHECK(no_box.radii == no_fraction.radii);
}

TEST_CASE("errors_of_amounts_name_the_fault_of_amount") {
  const PackingAmount good{.grains = 50, .box = Vec2{0.2, 0.1}};
  PackingOptions falling;
  falling.method = PackingMethod::falling;
  falling.box.sides = PackingBox::Sides::open_top;
  CHECK(fault_of_amount(good) == "none");
  CHECK(fault_of_amount(good, falling) == "none");
  CHECK(fault_of_amount({.grains = 50}).empty());
  CHECK(fault_of_amount({.grains = 50, .box = Vec2{0.2, 0.1}, .solid_fraction = 0.5}).empty());
  CHECK(fault_of_amount({.grains = 50, .box = Vec2{0.2, -0.1}}) == "box");
  CHECK(fault_of_amount({.grains = 50, .solid_fraction = 0.5}, falling) == "solid_fraction");
  falling.box.sides = PackingBox::Sides::periodic;
  CHECK(fault_of_amount(good, falling) == "sides");
}
