// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <optional>

#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/packing/packing.hpp"
#include "equidem/packing/placed_bodies.hpp"

namespace equidem {

namespace {

/// Place one body after the other.
/// \param insert tries a place for a body of a radius; its attempts at each are counted from 0
/// \param hopeless whether no further attempt is worth it
/// \param doing, room, limit for reports
template <class Insert, class Hopeless>
void place_all(const PackingOptions& options, GrainPacking& packing, const PlacedBodies& placed, const Insert& insert,
               const Hopeless& hopeless, const char* doing, const char* room, const char* limit) {
  std::vector<double> radii = options.radii;
  // Large bodies first, since they find less room later; where not all need to fit, the order given decides which stay.
  if (!options.as_dense_as_possible) std::sort(radii.begin(), radii.end(), std::greater<>());
  Progress progress(doing);
  keep_failure(packing, [&] {
    for (std::size_t k = 0; k < radii.size(); ++k) {
      if (k % 64 == 0) progress.update(static_cast<double>(k) / static_cast<double>(radii.size()));
      bool found = false;
      std::int64_t attempt = 0;
      for (; attempt < options.attempts && !found && !hopeless(attempt); ++attempt) {
        if (++packing.work % 4096 == 0) stop_if_interrupted();
        found = insert(radii[k], attempt);
      }
      if (found) continue;
      if (options.as_dense_as_possible) continue;
      computation_failed(
          fmt::format("{} of {} {}s found a {}, {:.4g} of the box", k, radii.size(), noun_of(options.shape.kind), room,
                      area_of(options.shape, placed.bodies().radii) / options.box.area()),
          fmt::format("{} attempts to place the next one failed{}", attempt, limit),
          "Ask for less, for more attempts, or use growth");
    }
  });
  make_grains(options.shape, placed.bodies(), options.settling.density, packing);
}

}  // namespace

/// Random sequential adsorption. Equal discs approach 0.5471 as attempts^(-1/2) (Feder 1980).
void fill_by_rejection(const PackingOptions& options, GrainPacking& packing) {
  Random random(options.seed);
  PlacedBodies placed(options.box, unit_body_of(options.shape), options.radii);
  const auto insert = [&](double radius, std::int64_t) {
    const Placement there = placement_at_random(options, placed.shape(), radius, random);
    if (!placed.has_room(there.place, radius, there.turns)) return false;
    placed.add(there.place, radius, there.turns);
    return true;
  };
  place_all(
      options, packing, placed, insert, [](std::int64_t) { return false; }, "placing", "place",
      "; equal discs placed at random never cover more than 0.547");
}

namespace {

/// Rounding of tangent places, of the radius.
constexpr double rounding = 1e-9;

/// The centre of a disc at the distances `from_a` from a and `from_b` from b, on the left or right of the way between
/// them.
std::optional<Vec2> tangent_place(Vec2 a, Vec2 way, double from_a, double from_b, bool left) {
  const double length = norm(way);
  if (!(length > 0) || length > from_a + from_b || length < std::abs(from_a - from_b)) return {};
  const double along = 0.5 * (length + (from_a * from_a - from_b * from_b) / length);
  const double across = std::sqrt(std::max(from_a * from_a - along * along, 0.0));
  const Vec2 unit = way / length;
  return a + along * unit + (left ? across : -across) * perpendicular(unit);
}

/// Distance of the centre of b from that of a, along a unit vector, when b comes from far away and first touches a.
/// The gap between convex parts is a convex function of the way, so that Newton's method comes nearer from outside and
/// never passes.
double touching_distance(const Outline& a, const Outline& b, double far, Vec2 along) {
  double way = far;
  for (int k = 0; k < 60; ++k) {
    double next = 0;
    for_touches(a, b, way * along, INFINITY, [&](const Touch& touch) {
      const double approach = dot(touch.normal, along);
      if (approach > 0) next = std::max(next, way + touch.overlap / approach);
    });
    if (way - next <= 0.1 * rounding * far) break;
    way = next;
  }
  return way;
}

/// Tries gaps beside bodies that lie already.
class Inserter {
 public:
  static constexpr std::int64_t anywhere_first = 30;  ///< places for each body

  explicit Inserter(const PackingOptions& options)
      : options_(options), placed_(options.box, unit_body_of(options.shape), options.radii), random_(options.seed) {}

  [[nodiscard]] const PlacedBodies& placed() const { return placed_; }

  /// Anywhere at first, so that the box fills evenly; then beside a body.
  /// \param attempt from 0 for each body
  bool insert(double radius, std::int64_t attempt) {
    if (attempt < anywhere_first || placed_.bodies().size() == 0) return add(anywhere(radius), radius);
    if (attempt == anywhere_first) passes_ = 0;
    if (open_.empty()) {
      ++passes_;
      for (std::size_t k = 0; k < placed_.bodies().size(); ++k) open_.push_back({static_cast<std::int32_t>(k), 0});
    }
    const auto pick = static_cast<std::size_t>(random_.below(open_.size()));
    const auto beside = static_cast<std::size_t>(open_[pick].body);
    if (add(options_.shape.is_disc() ? between(beside, radius) : around(beside, radius), radius)) return true;
    constexpr int enough = 12;
    if (++open_[pick].failures == enough) {
      open_[pick] = open_.back();
      open_.pop_back();
    }
    return false;
  }

  /// Whether places beside every body were tried without success; for shapes other than discs, whose places are
  /// expensive to find.
  [[nodiscard]] bool hopeless() const { return !options_.shape.is_disc() && passes_ > 1; }

 private:
  /// A body beside which there may still be a gap.
  struct Open {
    std::int32_t body = 0;
    int failures = 0;
  };
  static constexpr Placement nowhere{.place = {INFINITY, INFINITY}};

  bool add(const Placement& at, double radius) {
    if (!std::isfinite(at.place.x) || !placed_.has_room(at.place, radius, at.turns, rounding * radius)) return false;
    open_.push_back({static_cast<std::int32_t>(placed_.bodies().size()), 0});
    placed_.add(at.place, radius, at.turns);
    return true;
  }

  Placement anywhere(double radius) {
    if (!options_.shape.is_disc()) return placement_at_random(options_, placed_.shape(), radius, random_);
    const double margin = options_.box.periodic() ? 0 : radius;
    const double x = random_.uniform(margin, options_.box.size.x - margin);
    return {.place = {x, random_.uniform(margin, options_.box.size.y - margin)}};
  }

  /// Where a body, turned at random, touches body a and the first other one, or wall, that it meets on its way around
  /// a.
  Placement around(std::size_t a, double radius) {
    constexpr int directions = 16, halvings = 32;
    const double turns = random_.uniform(), start = random_.uniform(),
                 step = (random_.below(2) == 0 ? 1.0 : -1.0) / directions;
    const Outline fixed = placed_.shape().outline(placed_.radius(a), placed_.turns(a));
    const Outline moved = placed_.shape().outline(radius, turns);
    const double far = placed_.shape().reach * (placed_.radius(a) + radius);
    const auto at = [&](double direction) {
      const Vec2 along = axis_of_turns(direction);
      return placed_.wrapped(placed_.centre(a) + touching_distance(fixed, moved, far, along) * along);
    };
    const auto room_at = [&](double direction) {
      return placed_.has_room(at(direction), radius, turns, rounding * radius);
    };
    double last = start;
    const bool room_first = room_at(start);
    for (int k = 1; k <= directions; ++k) {
      const double next = start + k * step;
      if (room_at(next) == room_first) {
        last = next;
        continue;
      }
      double open = room_first ? last : next, taken = room_first ? next : last;
      for (int h = 0; h < halvings; ++h) {
        const double middle = 0.5 * (open + taken);
        (room_at(middle) ? open : taken) = middle;
      }
      return {.place = at(open), .turns = turns};
    }
    return nowhere;
  }

  /// A place where the disc touches disc a and one that it reaches from there, or a wall.
  Placement between(std::size_t a, double radius) {
    const Vec2 centre = placed_.centre(a);
    const double from_a = (placed_.radius(a) + radius) * (1 + 0.5 * rounding);
    partners_.clear();
    placed_.any_near(centre, placed_.radius(a) + 2 * radius, [&](std::int32_t other) {
      const auto b = static_cast<std::size_t>(other);
      if (b != a && norm(placed_.branch(centre, placed_.centre(b))) < from_a + placed_.radius(b) + radius)
        partners_.push_back(other);
      return false;
    });
    const std::uint64_t walls = options_.box.periodic() ? 0 : 4;
    if (partners_.empty() && walls == 0) return nowhere;
    const std::uint64_t pick = random_.below(partners_.size() + walls);
    const bool left = random_.below(2) == 0;
    if (pick < partners_.size()) {
      const auto b = static_cast<std::size_t>(partners_[pick]);
      const double from_b = (placed_.radius(b) + radius) * (1 + 0.5 * rounding);
      const auto place = tangent_place(centre, placed_.branch(centre, placed_.centre(b)), from_a, from_b, left);
      return place ? Placement{.place = placed_.wrapped(*place)} : nowhere;
    }
    return at_wall(static_cast<int>(pick - partners_.size()), centre, from_a, radius, left);
  }

  [[nodiscard]] Placement at_wall(int wall, Vec2 centre, double from_a, double radius, bool left) const {
    const bool vertical = wall < 2;
    const double length = vertical ? options_.box.size.x : options_.box.size.y;
    const double at = wall % 2 == 0 ? radius : length - radius;
    const double across = at - (vertical ? centre.x : centre.y);
    if (std::abs(across) > from_a) return nowhere;
    const double along = std::sqrt(from_a * from_a - across * across) * (left ? 1 : -1);
    return {.place = vertical ? Vec2{at, centre.y + along} : Vec2{centre.x + along, at}};
  }

  const PackingOptions& options_;
  PlacedBodies placed_;
  Random random_;
  std::vector<std::int32_t> partners_;
  std::vector<Open> open_;
  int passes_ = 0;  ///< over all bodies, for the one to be inserted
};

}  // namespace

void fill_by_insertion(const PackingOptions& options, GrainPacking& packing) {
  Inserter inserter(options);
  place_all(
      options, packing, inserter.placed(),
      [&](double radius, std::int64_t attempt) { return inserter.insert(radius, attempt); },
      [&](std::int64_t attempt) { return attempt > Inserter::anywhere_first && inserter.hopeless(); }, "inserting",
      "gap", "");
}

}  // namespace equidem
