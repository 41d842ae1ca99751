// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/packing/placed_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace equidem {
namespace {

constexpr double class_factor = 4;

std::size_t class_index(double radius, double largest) {
  std::size_t index = 0;
  for (double bound = largest / class_factor; radius <= bound; bound /= class_factor) ++index;
  return index;
}

}  // namespace

Placement placement_at_random(const PackingOptions& options, const UnitBody& shape, double radius, Random& random) {
  Placement there;
  Vec2 low, high = options.box.size;
  if (!options.shape.is_disc()) there.turns = random.uniform();
  if (!options.box.periodic()) {
    const Outline outline = shape.outline(radius, there.turns);
    // The distance from each side is the reach of the body towards it; the middle where it does not fit.
    for_wall_touches(outline, {}, {{}, PackingBox::Sides::walls}, std::numeric_limits<double>::infinity(),
                     [&](int side, const Touch& touch) {
                       if (side == 0) low.y = std::max(low.y, touch.overlap);
                       if (side == 1) low.x = std::max(low.x, touch.overlap);
                       if (side == 2) high.x = std::min(high.x, options.box.size.x - touch.overlap);
                       if (side == 3) high.y = std::min(high.y, options.box.size.y - touch.overlap);
                     });
    if (low.x > high.x) low.x = high.x = 0.5 * (low.x + high.x);
    if (low.y > high.y) low.y = high.y = 0.5 * (low.y + high.y);
  }
  const double x = random.uniform(low.x, high.x);
  there.place = {x, random.uniform(low.y, high.y)};
  return there;
}

PlacedBodies::PlacedBodies(const PackingBox& box, const UnitBody& shape, std::span<const double> radii)
    : box_(box), shape_(shape), largest_(*std::max_element(radii.begin(), radii.end())) {
  for (const double radius : radii) {
    const std::size_t index = class_index(radius, largest_);
    if (index >= classes_.size()) classes_.resize(index + 1);
    ++classes_[index].bodies;
    classes_[index].largest = std::max(classes_[index].largest, radius);
  }
  for (SizeClass& sizes : classes_) {
    if (sizes.bodies == 0) continue;
    // The width of a square is at least the reach of the bodies, and there are at most as many squares as bodies.
    const double width =
        std::max(2 * shape_.reach * sizes.largest, std::sqrt(box.area() / static_cast<double>(sizes.bodies)));
    sizes.columns = std::max<std::int64_t>(1, static_cast<std::int64_t>(box.size.x / width));
    sizes.rows = std::max<std::int64_t>(1, static_cast<std::int64_t>(box.size.y / width));
    sizes.cells.resize(static_cast<std::size_t>(sizes.columns * sizes.rows));
    sizes.bodies = 0;
  }
}

Vec2 PlacedBodies::wrapped(Vec2 place) const {
  if (!box_.periodic()) return place;
  const auto into = [](double x, double length) {
    x -= length * std::floor(x / length);
    return x < length ? x : 0;
  };
  return {into(place.x, box_.size.x), into(place.y, box_.size.y)};
}

PlacedBodies::Span PlacedBodies::span_of(double x, double reach, double length, std::int64_t count) const {
  const double width = length / static_cast<double>(count);
  const auto first = static_cast<std::int64_t>(std::floor((x - reach) / width));
  const auto last = static_cast<std::int64_t>(std::floor((x + reach) / width));
  if (!box_.periodic()) return {std::max<std::int64_t>(first, 0), std::min(last, count - 1)};
  return last - first < count - 1 ? Span{first, last} : Span{0, count - 1};
}

PlacedBodies::SizeClass& PlacedBodies::class_of(double radius) {
  return classes_[class_index(radius, largest_)];
}

std::vector<std::int32_t>& PlacedBodies::cell(SizeClass& sizes, Vec2 place) {
  return sizes
      .cells[cell_of(place.y, box_.size.y, sizes.rows) * sizes.columns + cell_of(place.x, box_.size.x, sizes.columns)];
}

void PlacedBodies::add(Vec2 place, double radius, double angle) {
  SizeClass& sizes = class_of(radius);
  ++sizes.bodies;
  cell(sizes, place).push_back(static_cast<std::int32_t>(bodies_.size()));
  bodies_.centres.push_back(place);
  bodies_.radii.push_back(radius);
  if (!shape_.is_disc()) bodies_.turns.push_back(angle);
}

void PlacedBodies::move(std::int32_t body, Vec2 place, double angle) {
  const auto k = static_cast<std::size_t>(body);
  SizeClass& sizes = class_of(bodies_.radii[k]);
  auto& from = cell(sizes, bodies_.centres[k]);
  auto& to = cell(sizes, place);
  if (&from != &to) {
    from.erase(std::find(from.begin(), from.end(), body));
    to.push_back(body);
  }
  bodies_.centres[k] = place;
  if (!shape_.is_disc()) bodies_.turns[k] = angle;
}

}  // namespace equidem
