// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/geometry/neighbours.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <tuple>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

constexpr int digit_bits = 11;  ///< the counters of one digit stay in the first-level cache
constexpr int most_row_bits = 44;
constexpr std::size_t size_classes = 513;  ///< one for each power of four
constexpr std::size_t bodies_per_task = 8192;

/// Largest distance of a body from another whose radius is at most `radius`, plus an allowance for the rounding of
/// distances.
double far_reach(double radius_a, double radius, double margin) {
  return (radius_a + radius + margin) * (1 + 1e-14);
}

/// The one criterion, the same bits for (a, b) and (b, a).
bool come_near(Vec2 branch, double radius_a, double radius_b, double margin) {
  const double reach = radius_a + radius_b + margin;
  return dot(branch, branch) < reach * reach;
}

void check(std::span<const Circle> circles, [[maybe_unused]] double margin) {
  assert(circles.size() < static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()));
  assert(margin >= 0 && std::isfinite(margin));
  for (const Circle& c : circles) {
    assert(!(c.radius < 0));
    if (std::isfinite(c.centre.x) && std::isfinite(c.centre.y) && std::isfinite(c.radius)) continue;
    computation_failed(fmt::format("body {} of radius {:.6g} m is at ({:.6g}, {:.6g}) m", &c - circles.data(), c.radius,
                                   c.centre.x, c.centre.y),
                       "a position that is no finite number has no neighbours", "Take a smaller time step");
  }
}

/// The power of four by which a body reaches less far than the largest, the last one for no reach at all.
std::size_t size_class(double largest_reach, double reach) {
  const auto exponent = (std::bit_cast<std::uint64_t>(largest_reach / reach) >> 52) & 2047;
  return (std::clamp<std::size_t>(exponent, 1023, 2047) - 1023) / 2;
}

/// The whole part of a number >= 0, at most `most`; that too for what is no number. Never falls where `value` grows.
std::uint64_t whole_part(double value, std::uint64_t most) {
  return value < static_cast<double>(most) ? static_cast<std::uint64_t>(value) : most;
}

/// All images that come near a body or could: those nearer to the box of all centres than their radius, the largest
/// radius and the margin together. Ascending.
std::vector<PeriodicImage> images_near(std::span<const Circle> circles, const Periods& periods, double margin) {
  std::vector<PeriodicImage> images;
  if (circles.empty()) return images;
  Vec2 low = circles[0].centre, high = low;
  double largest = 0;
  for (const Circle& circle : circles) {
    low = {std::min(low.x, circle.centre.x), std::min(low.y, circle.centre.y)};
    high = {std::max(high.x, circle.centre.x), std::max(high.y, circle.centre.y)};
    largest = std::max(largest, circle.radius);
  }
  // a hundred roundings more than nothing, so that a body on the edge of the box has its image
  const double more = largest + margin + 1e-13 * (norm(low) + norm(high));
  const auto first = [](double from, double period) { return static_cast<std::int32_t>(std::ceil(from / period)); };
  const auto last = [](double to, double period) { return static_cast<std::int32_t>(std::floor(to / period)); };
  for (std::size_t k = 0; k < circles.size(); ++k) {
    const auto [centre, radius] = circles[k];
    const double reach = radius + more;
    const bool rows = periods.b.y > 0;
    const std::int32_t lowest = rows ? first(low.y - reach - centre.y, periods.b.y) : 0;
    const std::int32_t highest = rows ? last(high.y + reach - centre.y, periods.b.y) : 0;
    for (std::int32_t b = lowest; b <= highest; ++b) {
      const double x = centre.x + b * periods.b.x;
      const std::int32_t right = last(high.x + reach - x, periods.a.x);
      for (std::int32_t a = first(low.x - reach - x, periods.a.x); a <= right; ++a)
        if (a != 0 || b != 0) images.push_back({static_cast<std::int32_t>(k), b, a});
    }
  }
  return images;
}

}  // namespace

struct NeighbourFinder::Memory {
  /// A circle at its place in a row.
  struct SortedBody {
    double x, y, radius;
    std::int32_t index;
  };

  /// Bodies begin .. end by ascending x: all of their size class with y in [low, high].
  struct Row {
    std::size_t begin = 0, end = 0;
    double low = 0, high = 0, largest_radius = 0;
  };

  /// Rows begin .. end by ascending y.
  struct SizeClass {
    std::size_t begin, end;
    double largest_radius;
  };

  struct Pair {
    std::int32_t i, j;
  };

  /// Pairs found by one thread: the first `count`.
  struct Found {
    std::vector<Pair> pairs;
    std::size_t count = 0;
  };

  /// Rows begin .. end of one size class, for one thread.
  struct Task {
    std::size_t size_class, begin, end;
  };

  /// Place of a body: row, and within the row a column that is coarser than x.
  struct Key {
    std::uint64_t place;
    std::int32_t index;
  };

  std::vector<std::int32_t> by_class;
  std::vector<Key> keys, other_keys;
  std::vector<SortedBody> bodies;
  std::vector<Row> rows;
  std::vector<SizeClass> classes;
  std::vector<Task> tasks;
  std::vector<Found> found;
  NeighbourList list;

  /// Stable radix sort by the lowest bits of the place.
  static void sort_by_place(std::vector<Key>& keys, std::vector<Key>& other, int bits) {
    constexpr std::uint64_t last_digit = (1U << digit_bits) - 1;
    if (keys.size() <= last_digit / 8) {
      std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) { return a.place < b.place; });
      return;
    }
    other.resize(keys.size());
    for (int shift = 0; shift < bits; shift += digit_bits) {
      std::array<std::uint32_t, last_digit + 2> begin{};
      for (const Key& key : keys) ++begin[((key.place >> shift) & last_digit) + 1];
      for (std::size_t k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
      for (const Key& key : keys) other[begin[(key.place >> shift) & last_digit]++] = key;
      keys.swap(other);
    }
  }

  /// The first body from `begin` on that is not left of x; by doubling steps, as it is mostly near.
  static const SortedBody* first_from(const SortedBody* begin, const SortedBody* end, double x) {
    std::ptrdiff_t step = 1;
    while (step < end - begin && begin[step].x < x) {
      begin += step;
      step *= 2;
    }
    return std::lower_bound(begin, std::min(begin + std::min(step, end - begin), end), x,
                            [](const SortedBody& body, double bound) { return body.x < bound; });
  }

  /// The pairs of body a with those from b to `end` that are not right of x = `right`.
  static void meet(const SortedBody& a, const SortedBody* b, const SortedBody* end, double right, double margin,
                   Found& result) {
    for (; b != end && b->x <= right; ++b) {
      if (result.count == result.pairs.size()) result.pairs.resize(std::max<std::size_t>(2 * result.count, 4096));
      // Written in any case, then kept or not: a branch would be mispredicted every other time.
      result.pairs[result.count] = {std::min(a.index, b->index), std::max(a.index, b->index)};
      result.count += come_near({a.x - b->x, a.y - b->y}, a.radius, b->radius, margin) ? 1 : 0;
    }
  }

  void divide_into_classes(std::span<const Circle> circles, double margin);
  void divide_into_rows(std::span<const Circle> circles, std::span<const std::int32_t> members, double margin);
  void search_rows(double margin);
  void search(const Task& task, double margin, Found& result) const;
  void sweep(const Row& a, const Row& b, double margin, Found& result) const;
  void order_pairs(std::size_t bodies);
};

void NeighbourFinder::Memory::divide_into_classes(std::span<const Circle> circles, double margin) {
  const auto reach = [&](const Circle& c) { return c.radius + 0.5 * margin; };
  double largest = 0;
  for (const Circle& c : circles) largest = std::max(largest, reach(c));
  std::array<std::size_t, size_classes + 1> begin{};
  for (const Circle& c : circles) ++begin[size_class(largest, reach(c)) + 1];
  for (std::size_t k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
  by_class.resize(circles.size());
  auto next = begin;
  for (std::size_t k = 0; k < circles.size(); ++k) {
    by_class[next[size_class(largest, reach(circles[k]))]++] = static_cast<std::int32_t>(k);
  }
  bodies.clear();
  rows.clear();
  classes.clear();
  for (std::size_t k = 0; k < size_classes; ++k) {
    if (begin[k] < begin[k + 1]) {
      divide_into_rows(circles, std::span(by_class).subspan(begin[k], begin[k + 1] - begin[k]), margin);
    }
  }
}

void NeighbourFinder::Memory::divide_into_rows(std::span<const Circle> circles, std::span<const std::int32_t> members,
                                               double margin) {
  Vec2 low = circles[members[0]].centre;
  Vec2 high = low;
  double largest_radius = 0;
  for (const std::int32_t k : members) {
    const auto& [centre, radius] = circles[k];
    low = {std::min(low.x, centre.x), std::min(low.y, centre.y)};
    high = {std::max(high.x, centre.x), std::max(high.y, centre.y)};
    largest_radius = std::max(largest_radius, radius);
  }
  const Vec2 extent = high - low;
  const std::uint64_t most_rows = std::uint64_t{1} << most_row_bits;
  const double height = std::max(2 * largest_radius + margin, extent.y / static_cast<double>(most_rows));
  const double rows_per_length = height > 0 ? 1 / height : 0;
  const int row_bits = std::bit_width(whole_part(extent.y * rows_per_length, most_rows));
  // Columns a quarter as wide as rows are high, and narrower where that costs no further digit.
  const int wanted_bits = row_bits + std::bit_width(whole_part(extent.x * rows_per_length, most_rows)) + 2;
  const int bits = std::min((wanted_bits + digit_bits - 1) / digit_bits * digit_bits, 64);
  const int column_bits = bits - row_bits;
  const std::uint64_t last_column = (std::uint64_t{1} << column_bits) - 1;
  const double columns_per_length = extent.x > 0 ? static_cast<double>(last_column) / extent.x : 0;

  keys.resize(members.size());
  for (std::size_t k = 0; k < members.size(); ++k) {
    const Vec2 from_low = circles[members[k]].centre - low;
    const std::uint64_t row = whole_part(from_low.y * rows_per_length, most_rows);
    const std::uint64_t column = whole_part(from_low.x * columns_per_length, last_column);
    keys[k] = {row << column_bits | column, members[k]};
  }
  sort_by_place(keys, other_keys, bits);

  const std::size_t first_row = rows.size();
  const auto left_of = [](const SortedBody& a, const SortedBody& b) { return a.x < b.x; };
  for (std::size_t k = 0; k < keys.size();) {
    const std::uint64_t row_number = keys[k].place >> column_bits;
    Row row{.begin = bodies.size(), .low = high.y, .high = low.y};
    while (k < keys.size() && keys[k].place >> column_bits == row_number) {
      const std::size_t first = bodies.size();
      for (const std::uint64_t place = keys[k].place; k < keys.size() && keys[k].place == place; ++k) {
        const auto& [centre, radius] = circles[keys[k].index];
        bodies.push_back({centre.x, centre.y, radius, keys[k].index});
        row.low = std::min(row.low, centre.y);
        row.high = std::max(row.high, centre.y);
        row.largest_radius = std::max(row.largest_radius, radius);
      }
      if (bodies.size() - first > 1) {
        std::sort(bodies.begin() + static_cast<std::ptrdiff_t>(first), bodies.end(), left_of);
      }
    }
    row.end = bodies.size();
    rows.push_back(row);
  }
  classes.push_back({first_row, rows.size(), largest_radius});
}

void NeighbourFinder::Memory::search_rows(double margin) {
  tasks.clear();
  for (std::size_t c = 0; c < classes.size(); ++c) {
    for (std::size_t row = classes[c].begin; row < classes[c].end;) {
      Task task{c, row, row + 1};
      while (task.end < classes[c].end && rows[task.end].end - rows[row].begin < bodies_per_task) ++task.end;
      row = task.end;
      tasks.push_back(task);
    }
  }
  found.resize(static_cast<std::size_t>(thread_count()));
  for (Found& f : found) f.count = 0;
  parallel_tasks(tasks.size(), [&](std::size_t task, int worker) { search(tasks[task], margin, found[worker]); });
}

/// Each row with itself, the rows above it, and the near rows of all larger classes.
void NeighbourFinder::Memory::search(const Task& task, double margin, Found& result) const {
  for (std::size_t c = 0; c <= task.size_class; ++c) {
    const double reach = far_reach(classes[task.size_class].largest_radius, classes[c].largest_radius, margin);
    for (std::size_t r = task.begin; r < task.end; ++r) {
      const Row& row = rows[r];
      std::size_t other = r + 1;
      if (c == task.size_class) {
        const SortedBody* end = bodies.data() + row.end;
        for (const SortedBody* body = bodies.data() + row.begin; body != end; ++body) {
          const double right = body->x + far_reach(body->radius, row.largest_radius, margin);
          meet(*body, body + 1, end, right, margin, result);
        }
      } else {
        const auto first = rows.begin() + static_cast<std::ptrdiff_t>(classes[c].begin);
        const auto last = rows.begin() + static_cast<std::ptrdiff_t>(classes[c].end);
        const auto below = [&](const Row& larger) { return larger.high < row.low - reach; };
        other = static_cast<std::size_t>(std::partition_point(first, last, below) - rows.begin());
      }
      for (; other < classes[c].end && rows[other].low <= row.high + reach; ++other) {
        const bool shorter = row.end - row.begin < rows[other].end - rows[other].begin;
        sweep(shorter ? row : rows[other], shorter ? rows[other] : row, margin, result);
      }
    }
  }
}

/// The pairs of a body of the short row a and one of b.
void NeighbourFinder::Memory::sweep(const Row& a, const Row& b, double margin, Found& result) const {
  const double reach = far_reach(a.largest_radius, b.largest_radius, margin);
  const SortedBody* first = bodies.data() + b.begin;
  const SortedBody* end = bodies.data() + b.end;
  for (std::size_t k = a.begin; k < a.end && first != end; ++k) {
    const SortedBody& body = bodies[k];
    const double own_reach = far_reach(body.radius, b.largest_radius, margin);
    if (body.y + own_reach < b.low || body.y - own_reach > b.high) continue;
    first = first_from(first, end, body.x - reach);
    meet(body, first, end, body.x + own_reach, margin, result);
  }
}

/// Counting sort of all pairs by i, then the partners of each body.
void NeighbourFinder::Memory::order_pairs(std::size_t count) {
  auto& [begin, partner] = list;
  // begin[i + 1] is first the place of the next partner of i: behind the last one it is what it is meant to be.
  begin.assign(count + 2, 0);
  for (const Found& f : found) {
    for (const Pair& pair : std::span(f.pairs).first(f.count)) ++begin[static_cast<std::size_t>(pair.i) + 2];
  }
  for (std::size_t k = 3; k < begin.size(); ++k) begin[k] += begin[k - 1];
  partner.resize(static_cast<std::size_t>(begin.back()));
  for (const Found& f : found) {
    for (const Pair& pair : std::span(f.pairs).first(f.count)) {
      partner[begin[static_cast<std::size_t>(pair.i) + 1]++] = pair.j;
    }
  }
  begin.pop_back();
  parallel_ranges(count, bodies_per_task, [this](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      std::sort(list.partner.begin() + list.begin[k], list.partner.begin() + list.begin[k + 1]);
    }
  });
}

NeighbourFinder::NeighbourFinder() : memory_(std::make_unique<Memory>()) {}
NeighbourFinder::~NeighbourFinder() = default;
NeighbourFinder::NeighbourFinder(NeighbourFinder&&) noexcept = default;
NeighbourFinder& NeighbourFinder::operator=(NeighbourFinder&&) noexcept = default;

const NeighbourList& NeighbourFinder::within(std::span<const Circle> circles, double margin) {
  check(circles, margin);
  memory_->divide_into_classes(circles, margin);
  memory_->search_rows(margin);
  memory_->order_pairs(circles.size());
  return memory_->list;
}

NeighbourList neighbours_within(std::span<const Circle> circles, double margin) {
  NeighbourFinder finder;
  return finder.within(circles, margin);
}

PeriodicImage image_inside(const Periods& periods, Vec2 centre, Vec2 position) {
  PeriodicImage image;
  if (periods.b.y > 0) image.b = static_cast<std::int32_t>(-std::floor((position.y - centre.y) / periods.b.y + 0.5));
  const double x = position.x + image.b * periods.b.x - centre.x;
  image.a = static_cast<std::int32_t>(-std::floor(x / periods.a.x + 0.5));
  return image;
}

const std::vector<CirclePair>& PairFinder::within(std::span<const Circle> circles,
                                                  const std::optional<Periods>& periods, double margin) {
  const std::size_t count = circles.size();
  circles_.assign(circles.begin(), circles.end());
  std::vector<PeriodicImage> images;
  if (periods) images = images_near(circles, *periods, margin);
  for (const PeriodicImage& image : images) {
    const Circle& body = circles[image.body];
    circles_.push_back({body.centre + periods->shift(image), body.radius});
  }
  const NeighbourList& list = finder_.within(circles_, margin);
  pairs_.clear();
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::int32_t>(k);
    for (std::int64_t p = list.begin[k]; p < list.begin[k + 1]; ++p) {
      const auto partner = static_cast<std::size_t>(list.partner[p]);
      const PeriodicImage j = partner < count ? PeriodicImage{list.partner[p]} : images[partner - count];
      // A pair with an image is found from both ends; it counts at the first.
      if (partner >= count && std::tuple(j.body, j.a, j.b) < std::tuple(i, 0, 0)) continue;
      pairs_.push_back({i, j, periods ? periods->shift(j) : Vec2{}});
    }
  }
  return pairs_;
}

std::vector<CirclePair> pairs_within(std::span<const Circle> circles, const std::optional<Periods>& periods,
                                     double margin) {
  PairFinder finder;
  return finder.within(circles, periods, margin);
}

}  // namespace equidem
