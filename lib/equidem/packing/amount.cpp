// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/packing/amount.hpp"

#include <cmath>
#include <string>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/packing/methods.hpp"

namespace equidem {
namespace {

/// Those of grains and box that are not given.
std::vector<std::string> missing_amounts(const PackingAmount& amount) {
  std::vector<std::string> missing;
  if (!amount.grains) missing.emplace_back("grains");
  if (!amount.box) missing.emplace_back("box");
  return missing;
}

/// Says that sizes and box do not fit together, and that one of them is probably in mm.
[[noreturn]] void refuse_number(double wanted, Vec2 box, double diameter) {
  constexpr double few = 1, many = 1e7;
  const std::string number = wanted < few ? "less than one body" : fmt::format("{:.3g} bodies", wanted);
  bad_input_at("box",
               fmt::format("{} of {:.3g} m in diameter would fill the box of {:.4g} m by {:.4g} m", number, diameter,
                           box.x, box.y),
               fmt::format("they are {} to {}", few, many),
               fmt::format("Change the box or the radii: all lengths are in m, and {} may be in mm",
                           wanted < few ? "the radii or sieves" : "the box"));
}

void check(const PackingAmount& amount, const PackingOptions& options) {
  const bool falls = entry_of(options.method).open_top, dense = options.as_dense_as_possible;
  if (falls && options.box.periodic())
    bad_input_at("sides", "bodies fall into a periodic box", "they would never come to rest",
                 "Take walls, or another method");
  if (falls && (amount.solid_fraction || dense))
    bad_input_at("solid_fraction", "a solid fraction is asked for falling bodies",
                 "it results from the fall, lower with more friction", "Remove it");
  if (dense && !entry_of(options.method).as_dense_as_possible)
    bad_input_at("solid_fraction", fmt::format("solid_fraction = \"auto\" with {}", to_string(options.method)),
                 "the method has no rule to stop", "Give a number, or take growth");
  const int given =
      int{amount.grains.has_value()} + int{amount.box.has_value()} + int{amount.solid_fraction.has_value()};
  if (given > 2)
    bad_input("grains, box and solid_fraction are all given",
              falls || dense ? "grains and box give the amount" : "two of them give the third", "Remove one of them");
  if (given < 2 && dense)
    bad_input_at("solid_fraction",
                 fmt::format("solid_fraction = \"auto\" without {}", listed(missing_amounts(amount), " and ")),
                 "as dense as the method gets is no amount: grains and box give it",
                 "Add them, or give solid_fraction a number");
  if (given < 2)
    bad_input("the amount to pack is missing",
              falls || dense ? "grains and box give it" : "two of grains, box and solid_fraction give it",
              "Give two of them");
  if (amount.box && !(is_size(amount.box->x) && is_size(amount.box->y)))
    bad_input_at("box", fmt::format("the box is {} m by {} m", amount.box->x, amount.box->y),
                 "width and height are positive, from 1e-60 to 1e60 m, so that its area is a number", "Correct it");
}

}  // namespace

void set_amount(const PackingAmount& amount, const SizeDistribution& sizes, PackingOptions& options) {
  check(amount, options);
  Random random(~options.seed);  // sizes are independent of places
  if (amount.box) options.box.size = *amount.box;
  std::int64_t count = amount.grains.value_or(0);
  if (!amount.grains) {
    const double mean_area = unit_body_of(options.shape).area * moments_of(sizes).mean_square;
    const double wanted = std::round(*amount.solid_fraction * options.box.area() / mean_area);
    if (!(wanted >= 1 && wanted <= 1e7))
      refuse_number(wanted, options.box.size, 2 * std::sqrt(moments_of(sizes).mean_square));
    count = static_cast<std::int64_t>(wanted);
  }
  options.radii = draw_radii(sizes, count, random);
  if (!amount.box) {
    const double area = area_of(options.shape, options.radii) / *amount.solid_fraction;
    options.box.size = {std::sqrt(area * amount.aspect), std::sqrt(area / amount.aspect)};
  } else if (!amount.grains) {
    const double scale = std::sqrt(*amount.solid_fraction * options.box.area() / area_of(options.shape, options.radii));
    for (double& radius : options.radii) radius *= scale;
  }
}

ScalablePacking resized(ScalablePacking packing, std::int64_t grains, std::uint64_t seed) {
  PackingAmount& amount = packing.amount;
  if (amount.box && amount.grains) {
    *amount.box *= std::sqrt(static_cast<double>(grains) / static_cast<double>(*amount.grains));
  } else if (amount.box) {
    amount.aspect = amount.box->x / amount.box->y;
    amount.box.reset();
  }
  amount.grains = grains;
  packing.seed = seed;
  set_amount(amount, packing.sizes, packing);
  return packing;
}

}  // namespace equidem
