// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Box and radii from two of number, box and solid fraction, without a case file.
#include <string>

#include "equidem/packing/size_distribution.hpp"

#include "support/catch.hpp"
#include "support/refusal.hpp"

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
  const test::Refusal refused = test::refusal_of([&] { set_amount(amount, radii_of_amounts, options); });
  return refused.message.empty() ? "none" : refused.where;
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

TEST_CASE("a_packing_of_another_number_of_bodies_is_as_dense_in_a_box_of_the_same_shape") {
  struct Given {
    PackingAmount amount;
    bool fraction_is_given;
  };
  const Given given = GENERATE(Given{{.grains = 50, .solid_fraction = 0.7}, true},
                               Given{{.box = Vec2{0.3, 0.1}, .solid_fraction = 0.7}, true},
                               Given{{.grains = 50, .box = Vec2{0.3, 0.1}}, false});
  ScalablePacking packing{{}, given.amount, radii_of_amounts};
  set_amount(packing.amount, packing.sizes, packing);
  const ScalablePacking larger = resized(packing, 200, 7);

  CHECK(larger.radii.size() == 200);
  CHECK(larger.seed == 7);
  CHECK(larger.box.size.x / larger.box.size.y == Approx(packing.box.size.x / packing.box.size.y).epsilon(1e-13));
  if (given.fraction_is_given)
    CHECK(solid_fraction(larger) == Approx(0.7).epsilon(1e-13));
  else
    CHECK(larger.box.area() / 200 == Approx(packing.box.area() / 50).epsilon(1e-13));
  const ScalablePacking again = resized(larger, 200, 7);
  CHECK(again.radii == larger.radii);
  CHECK(again.box.size.x == Approx(larger.box.size.x).epsilon(1e-13));
}
