// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/packing/packing_shape.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

namespace {

/// The lever of a unit body from its longest arm (UnitBody::lever). While bodies are pushed apart, moments are divided
/// by it: its lower bound of a tenth of the reach keeps the small moments on nearly round bodies from turning them far,
/// and so from coming to rest; bodies that are round up to rounding do not turn.
double lever_of(double arm, double reach) {
  constexpr double rounding = 1e-12, shortest = 0.1;
  return arm <= rounding * reach ? 0 : std::max(arm, shortest * reach);
}

UnitBody unit_ellipse(double aspect) {
  constexpr double longest = 1000;
  if (!(aspect >= 1 && aspect <= longest)) {
    bad_input(fmt::format("the aspect of the ellipses is {}", aspect),
              fmt::format("it is the long half-axis over the short one, from 1 to {}", longest), "Correct it");
  }
  const double a = std::sqrt(aspect), b = 1 / a;
  return {.a = a,
          .b = b,
          .reach = a,
          .lever = lever_of(a - b, a),
          .area = std::numbers::pi,
          .gyration = 0.25 * (a * a + b * b)};
}

/// Discs tied rigidly, in any place and unit, scaled to an area.
UnitBody unit_clump(std::vector<Clump::Disc> discs, double area) {
  Clump clump = centred_clump(std::move(discs));
  const DiscUnion whole = union_of(clump.discs);
  const double scale = std::sqrt(area / whole.area);
  UnitBody body{
      .discs = std::move(clump.discs), .area = area, .gyration = area * whole.polar_moment / (whole.area * whole.area)};
  for (Clump::Disc& disc : body.discs) disc = {scale * disc.offset, scale * disc.radius};
  body.reach = reach_of(body.outline(1, 0));
  body.lever = lever_of(longest_lever(body.outline(1, 0)), body.reach);
  return body;
}

}  // namespace

UnitBody unit_body_of(const PackingShape& shape) {
  switch (shape.kind) {
    case PackingShape::Kind::ellipse:
      return unit_ellipse(shape.aspect);
    case PackingShape::Kind::bonded_pair:
    case PackingShape::Kind::rigid_pair:  // two equal discs that touch
      return unit_clump({{{-1, 0}, 1}, {{1, 0}, 1}}, 2 * std::numbers::pi);
    case PackingShape::Kind::clump:
      return unit_clump(shape.discs, std::numbers::pi);
    case PackingShape::Kind::disc:
      break;
  }
  return {.area = std::numbers::pi, .gyration = 0.5};
}

double area_of(const PackingShape& shape, std::span<const double> radii) {
  double squares = 0;
  for (const double radius : radii) squares += radius * radius;
  return unit_body_of(shape).area * squares;
}

}  // namespace equidem
