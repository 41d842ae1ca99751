// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Methods that place bodies one after the other: rejection, insertion, local moves.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/packing/overlaps.hpp"
#include "equidem/packing/packing.hpp"

namespace equidem {
namespace {

struct Placement {
  Vec2 place;        ///< of the centre, m
  double turns = 0;  ///< angle over 2 pi
};

/// Anywhere, in any direction; between walls anywhere that it does not cross them.
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

constexpr double class_factor = 4;

std::size_t class_index(double radius, double largest) {
  std::size_t index = 0;
  for (double bound = largest / class_factor; radius <= bound; bound /= class_factor) ++index;
  return index;
}

/// Grids of squares, one for each class of sizes, a factor of four wide; each square holds the bodies whose centres lie
/// in it.
class PlacedBodies {
 public:
  /// \param radii of all bodies that may come
  PlacedBodies(const PackingBox& box, const UnitBody& shape, std::span<const double> radii)
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

  [[nodiscard]] const Bodies& bodies() const { return bodies_; }
  [[nodiscard]] const UnitBody& shape() const { return shape_; }
  [[nodiscard]] Vec2 centre(std::size_t body) const { return bodies_.centres[body]; }
  [[nodiscard]] double radius(std::size_t body) const { return bodies_.radii[body]; }

  [[nodiscard]] double turns(std::size_t body) const { return bodies_.turn(body); }

  /// The place, moved into the box by whole periods.
  [[nodiscard]] Vec2 wrapped(Vec2 place) const {
    if (!box_.periodic()) return place;
    const auto into = [](double x, double length) {
      x -= length * std::floor(x / length);
      return x < length ? x : 0;
    };
    return {into(place.x, box_.size.x), into(place.y, box_.size.y)};
  }
  /// From a to b, the shortest way.
  [[nodiscard]] Vec2 branch(Vec2 a, Vec2 b) const {
    Vec2 way = b - a;
    if (box_.periodic()) {
      way.x -= box_.size.x * std::nearbyint(way.x / box_.size.x);
      way.y -= box_.size.y * std::nearbyint(way.y / box_.size.y);
    }
    return way;
  }

  /// Call body(k) for the bodies that one of that radius at `place` could touch, and some more, until it returns true.
  template <typename Body>
  bool any_near(Vec2 place, double radius, const Body& body) const {
    return std::any_of(classes_.begin(), classes_.end(), [&](const SizeClass& sizes) {
      if (sizes.bodies == 0) return false;
      const double reach = shape_.reach * (radius + sizes.largest);
      const Span columns = span_of(place.x, reach, box_.size.x, sizes.columns);
      const Span rows = span_of(place.y, reach, box_.size.y, sizes.rows);
      for (std::int64_t row = rows.first; row <= rows.last; ++row) {
        for (std::int64_t column = columns.first; column <= columns.last; ++column) {
          const auto& cell = sizes.cells[remainder(row, sizes.rows) * sizes.columns + remainder(column, sizes.columns)];
          if (std::any_of(cell.begin(), cell.end(), body)) return true;
        }
      }
      return false;
    });
  }

  /// Call body(overlap) for all overlaps of a body at a place with others and with walls, m, until it returns true.
  /// \param angle turns
  /// \param except a body to leave out; -1: none
  template <typename Body>
  bool any_overlap(Vec2 place, double radius, double angle, std::int32_t except, const Body& body) const {
    const Outline self = shape_.outline(radius, angle);
    bool found = false;
    const auto add = [&](const Touch& touch) { found = found || body(touch.overlap); };
    for_wall_touches(self, place, box_, 0, [&](int, const Touch& touch) { add(touch); });
    return found || any_near(place, radius, [&](std::int32_t other) {
             if (other == except) return false;
             const auto k = static_cast<std::size_t>(other);
             const Vec2 way = branch(place, bodies_.centres[k]);
             const double reach = shape_.reach * (radius + bodies_.radii[k]);
             if (dot(way, way) >= reach * reach) return false;
             for_touches(self, shape_.outline(bodies_.radii[k], turns(k)), way, 0, add);
             return found;
           });
  }

  /// Whether a body overlaps nothing by more than `slack`, m.
  [[nodiscard]] bool has_room(Vec2 place, double radius, double angle, double slack = 0) const {
    return !any_overlap(place, radius, angle, -1, [&](double overlap) { return overlap > slack; });
  }

  /// \param angle turns; not kept of what is round
  void add(Vec2 place, double radius, double angle) {
    SizeClass& sizes = class_of(radius);
    ++sizes.bodies;
    cell(sizes, place).push_back(static_cast<std::int32_t>(bodies_.size()));
    bodies_.centres.push_back(place);
    bodies_.radii.push_back(radius);
    if (!shape_.is_disc()) bodies_.turns.push_back(angle);
  }
  void move(std::int32_t body, Vec2 place, double angle) {
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

 private:
  struct SizeClass {
    double largest = 0;  ///< radius, m
    std::int64_t columns = 1, rows = 1, bodies = 0;
    std::vector<std::vector<std::int32_t>> cells;
  };
  struct Span {
    std::int64_t first, last;
  };
  static std::int64_t remainder(std::int64_t k, std::int64_t count) {
    return k < 0 ? k + count : k < count ? k : k - count;
  }
  static std::int64_t cell_of(double x, double length, std::int64_t count) {
    return std::clamp<std::int64_t>(static_cast<std::int64_t>(x / length * static_cast<double>(count)), 0, count - 1);
  }
  /// Cells within reach, each once, across the period where there is one.
  [[nodiscard]] Span span_of(double x, double reach, double length, std::int64_t count) const {
    const double width = length / static_cast<double>(count);
    const auto first = static_cast<std::int64_t>(std::floor((x - reach) / width));
    const auto last = static_cast<std::int64_t>(std::floor((x + reach) / width));
    if (!box_.periodic()) return {std::max<std::int64_t>(first, 0), std::min(last, count - 1)};
    return last - first < count - 1 ? Span{first, last} : Span{0, count - 1};
  }
  SizeClass& class_of(double radius) { return classes_[class_index(radius, largest_)]; }
  std::vector<std::int32_t>& cell(SizeClass& sizes, Vec2 place) {
    return sizes.cells[cell_of(place.y, box_.size.y, sizes.rows) * sizes.columns +
                       cell_of(place.x, box_.size.x, sizes.columns)];
  }

  PackingBox box_;
  UnitBody shape_;
  double largest_ = 0;
  std::vector<SizeClass> classes_;  ///< the largest first
  Bodies bodies_;
};

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

/// Rounding of tangent places, of the radius.
constexpr double tangent_rounding = 1e-9;

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
    if (way - next <= 0.1 * tangent_rounding * far) break;
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
    if (!std::isfinite(at.place.x) || !placed_.has_room(at.place, radius, at.turns, tangent_rounding * radius))
      return false;
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
      return placed_.has_room(at(direction), radius, turns, tangent_rounding * radius);
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
    const double from_a = (placed_.radius(a) + radius) * (1 + 0.5 * tangent_rounding);
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
      const double from_b = (placed_.radius(b) + radius) * (1 + 0.5 * tangent_rounding);
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

/// Overlaps of a body at a place with others and walls: sum of squares, m², and the largest one, m.
struct Crowding {
  double squares = 0, largest = 0;
};

Crowding crowding(const PlacedBodies& placed, std::int32_t body, Placement there) {
  Crowding sum;
  const auto add = [&](double overlap) {
    if (overlap > 0) sum.squares += overlap * overlap;
    sum.largest = std::max(sum.largest, overlap);
    return false;
  };
  placed.any_overlap(there.place, placed.radius(static_cast<std::size_t>(body)), there.turns, body, add);
  return sum;
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

void fill_by_insertion(const PackingOptions& options, GrainPacking& packing) {
  Inserter inserter(options);
  place_all(
      options, packing, inserter.placed(),
      [&](double radius, std::int64_t attempt) { return inserter.insert(radius, attempt); },
      [&](std::int64_t attempt) { return attempt > Inserter::anywhere_first && inserter.hopeless(); }, "inserting",
      "gap", "");
}

/// Monte Carlo without temperature: a random move of a body that overlaps is taken where it overlaps less afterwards,
/// one that lies free is shaken. Discs are larger by a little than they should be, so that they end apart.
void fill_by_local_moves(const PackingOptions& options, GrainPacking& packing) {
  const bool discs = options.shape.is_disc();
  const double spare = discs ? std::max(options.overlap, 1e-4) : 0;
  const double smallest = *std::min_element(options.radii.begin(), options.radii.end());
  Random random(options.seed);
  std::vector<double> radii = options.radii;
  for (double& radius : radii) radius *= 1 + spare;
  PlacedBodies placed(options.box, unit_body_of(options.shape), radii);
  for (std::size_t k = 0; k < radii.size(); ++k) {
    const Placement there = placement_at_random(options, placed.shape(), options.radii[k], random);
    placed.add(there.place, radii[k], there.turns);
  }
  Progress progress("moving");
  constexpr double shake = 0.05;  // of the radius
  constexpr int moves = 4;
  double deepest = 0;
  keep_failure(packing, [&] {
    for (std::int64_t sweep = 0; sweep < options.attempts; ++sweep) {
      progress.update(static_cast<double>(sweep) / static_cast<double>(options.attempts));
      ++packing.work;
      deepest = 0;
      std::int64_t overlapping = 0;
      for (std::size_t k = 0; k < radii.size(); ++k) {
        const auto body = static_cast<std::int32_t>(k);
        Placement at = {placed.centre(k), placed.turns(k)};
        Crowding here = crowding(placed, body, at);
        const bool lies_free = here.largest <= (discs ? spare * options.radii[k] : options.overlap * smallest);
        if (!lies_free) {
          ++overlapping;
          deepest = std::max(deepest, here.largest / radii[k]);
        }
        // Bodies that lie free are shaken, too: they make room for others.
        const double reach = lies_free ? shake * radii[k] : 1.2 * here.largest;
        for (int move = 0; move < (lies_free ? 1 : moves); ++move) {
          const double dx = random.uniform(-reach, reach);
          Placement there = {placed.wrapped(at.place + Vec2{dx, random.uniform(-reach, reach)}), at.turns};
          if (!discs) {
            const double most = std::min(0.25, reach / (2 * std::numbers::pi * placed.shape().reach * radii[k]));
            there.turns += random.uniform(-most, most);
          }
          const Crowding then = crowding(placed, body, there);
          if (lies_free ? then.squares > 0 : then.squares >= here.squares) continue;
          placed.move(body, there.place, there.turns);
          at = there;
          here = then;
        }
      }
      if (overlapping > 0) continue;
      return;
    }
    computation_failed(
        fmt::format("after {} sweeps {}s still overlap by {:.2g} of a radius at a solid fraction of {:.4g}",
                    options.attempts, noun_of(options.shape.kind), deepest,
                    area_of(options.shape, options.radii) / options.box.area()),
        "small random moves find the way apart ever more slowly as the box fills",
        "Ask for less, for more attempts, or use growth");
  });
  Bodies bodies = placed.bodies();
  bodies.radii = options.radii;
  make_grains(options.shape, bodies, options.settling.density, packing);
}

}  // namespace equidem
