// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <optional>

#include "equidem/core/error.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/packing/packing.hpp"
#include "equidem/packing/placed_bodies.hpp"

namespace equidem {
namespace {

/// Rounding of tangent places, of the radius.
constexpr double rounding = 1e-9;

/// The centre of a disc at the distances `from_a` from a and `from_b` from b, on the left or right of the way between them.
std::optional<Vec2> tangent_place(Vec2 a, Vec2 way, double from_a, double from_b, bool left) {
  const double length = norm(way);
  if (!(length > 0) || length > from_a + from_b || length < std::abs(from_a - from_b)) return {};
  const double along = 0.5 * (length + (from_a * from_a - from_b * from_b) / length);
  const double across = std::sqrt(std::max(from_a * from_a - along * along, 0.0));
  const Vec2 unit = way / length;
  return a + along * unit + (left ? across : -across) * perpendicular(unit);
}

/// Tries gaps beside discs that lie already.
class Inserter {
 public:
  explicit Inserter(const PackingOptions& options)
      : box_(options.box), placed_(options.box, unit_body_of(options.shape), options.radii), random_(options.seed) {}

  [[nodiscard]] const PlacedBodies& placed() const { return placed_; }

  /// Anywhere at first, so that the box fills evenly; then beside a disc.
  bool insert(double radius, std::int64_t attempt) {
    constexpr std::int64_t anywhere_first = 30;
    if (attempt < anywhere_first || placed_.bodies().size() == 0) return add(anywhere(radius), radius);
    if (open_.empty()) {
      for (std::size_t k = 0; k < placed_.bodies().size(); ++k) open_.push_back({static_cast<std::int32_t>(k), 0});
    }
    const auto pick = static_cast<std::size_t>(random_.below(open_.size()));
    if (add(beside(static_cast<std::size_t>(open_[pick].disc), radius), radius)) return true;
    constexpr int enough = 12;
    if (++open_[pick].failures == enough) {
      open_[pick] = open_.back();
      open_.pop_back();
    }
    return false;
  }

 private:
  /// A disc beside which there may still be a gap.
  struct Open {
    std::int32_t disc = 0;
    int failures = 0;
  };
  static constexpr Vec2 nowhere = {INFINITY, INFINITY};

  bool add(Vec2 place, double radius) {
    if (!std::isfinite(place.x) || !placed_.has_room(place, radius, 0, rounding * radius)) return false;
    open_.push_back({static_cast<std::int32_t>(placed_.bodies().size()), 0});
    placed_.add(place, radius, 0);
    return true;
  }

  Vec2 anywhere(double radius) {
    const double margin = box_.periodic() ? 0 : radius;
    const double x = random_.uniform(margin, box_.size.x - margin);
    return {x, random_.uniform(margin, box_.size.y - margin)};
  }

  /// A place where the disc touches disc a and one that it reaches from there, or a wall.
  Vec2 beside(std::size_t a, double radius) {
    const Vec2 centre = placed_.centre(a);
    const double from_a = (placed_.radius(a) + radius) * (1 + 0.5 * rounding);
    partners_.clear();
    placed_.any_near(centre, placed_.radius(a) + 2 * radius, [&](std::int32_t other) {
      const auto b = static_cast<std::size_t>(other);
      if (b != a && norm(placed_.branch(centre, placed_.centre(b))) < from_a + placed_.radius(b) + radius)
        partners_.push_back(other);
      return false;
    });
    const std::uint64_t walls = box_.periodic() ? 0 : 4;
    if (partners_.empty() && walls == 0) return nowhere;
    const std::uint64_t pick = random_.below(partners_.size() + walls);
    const bool left = random_.below(2) == 0;
    if (pick < partners_.size()) {
      const auto b = static_cast<std::size_t>(partners_[pick]);
      const double from_b = (placed_.radius(b) + radius) * (1 + 0.5 * rounding);
      const auto place = tangent_place(centre, placed_.branch(centre, placed_.centre(b)), from_a, from_b, left);
      return place ? placed_.wrapped(*place) : nowhere;
    }
    return at_wall(static_cast<int>(pick - partners_.size()), centre, from_a, radius, left);
  }

  [[nodiscard]] Vec2 at_wall(int wall, Vec2 centre, double from_a, double radius, bool left) const {
    const bool vertical = wall < 2;
    const double length = vertical ? box_.size.x : box_.size.y;
    const double at = wall % 2 == 0 ? radius : length - radius;
    const double across = at - (vertical ? centre.x : centre.y);
    if (std::abs(across) > from_a) return nowhere;
    const double along = std::sqrt(from_a * from_a - across * across) * (left ? 1 : -1);
    return vertical ? Vec2{at, centre.y + along} : Vec2{centre.x + along, at};
  }

  PackingBox box_;
  PlacedBodies placed_;
  Random random_;
  std::vector<std::int32_t> partners_;
  std::vector<Open> open_;
};

}  // namespace

void fill_by_insertion(const PackingOptions& options, GrainPacking& packing) {
  std::vector<double> radii = options.radii;
  if (!options.as_dense_as_possible) std::sort(radii.begin(), radii.end(), std::greater<>());
  Inserter inserter(options);
  Progress progress("inserting");
  for (std::size_t k = 0; k < radii.size(); ++k) {
    if (k % 64 == 0) progress.update(static_cast<double>(k) / static_cast<double>(radii.size()));
    bool found = false;
    for (std::int64_t attempt = 0; attempt < options.attempts && !found; ++attempt) {
      ++packing.work;
      found = inserter.insert(radii[k], attempt);
    }
    if (found) continue;
    packing.complete = false;
    if (options.as_dense_as_possible) continue;
    computation_failed(format("{} of {} discs found a gap, {:.4g} of the box", k, radii.size(),
                              area_of(options.shape, inserter.placed().bodies().radii) / options.box.area()),
                       format("for the next one {} gaps were all too small", options.attempts),
                       "Ask for less, for more attempts, or use growth");
  }
  make_grains(options.shape, inserter.placed().bodies(), options.settling.density, packing);
}

}  // namespace equidem
