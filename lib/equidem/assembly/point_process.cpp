// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/point_process.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

constexpr double sqrt3 = std::numbers::sqrt3;

/// The rectangle of the wanted aspect with room for the wanted count.
Vec2 wanted_extent(const PointOptions& options) {
  const double area = 0.5 * sqrt3 * options.spacing * options.spacing * static_cast<double>(options.count);
  const double height = std::sqrt(area / options.aspect);
  return {area / height, height};
}

/// Uniform in the disc of radius 1, by rejection.
Vec2 in_unit_disc(Random& random) {
  for (;;) {
    const double x = random.uniform(-1, 1);
    const double y = random.uniform(-1, 1);
    if (x * x + y * y <= 1) return {x, y};
  }
}

/// x moved by whole periods into [0, length).
double wrapped(double x, double length) {
  if (x < 0) x += length;
  if (x >= length) x -= length;
  return x;
}

/// x mirrored at the nearer end into [0, length].
double mirrored(double x, double length) {
  if (x < 0) x = -x;
  if (x > length) x = 2 * length - x;
  return x;
}

/// The whole number >= least nearest to x of those that `step` apart.
std::int64_t nearest_multiple(double x, std::int64_t step, std::int64_t least) {
  return std::max(least, step * static_cast<std::int64_t>(std::floor(x / static_cast<double>(step) + 0.5)));
}

}  // namespace

PointSet uniform_points(const PointOptions& options, Random& random) {
  PointSet set;
  set.extent = wanted_extent(options);
  set.points.resize(static_cast<std::size_t>(options.count));
  for (Vec2& point : set.points) {
    point.x = random.uniform() * set.extent.x;
    point.y = random.uniform() * set.extent.y;
  }
  return set;
}

PointSet perturbed_hexagonal_points(const PointOptions& options, double disorder, Random& random) {
  const double s = options.spacing;
  const double row_distance = 0.5 * sqrt3 * s;
  const Vec2 wanted = wanted_extent(options);
  const std::int64_t step = options.periodic ? 2 : 1;
  const std::int64_t rows = nearest_multiple(wanted.y / row_distance, step, step);
  const std::int64_t columns = nearest_multiple(static_cast<double>(options.count) / static_cast<double>(rows), 1, 1);
  PointSet set;
  set.extent = {static_cast<double>(columns) * s, static_cast<double>(rows) * row_distance};
  set.points.reserve(static_cast<std::size_t>(rows * columns));
  for (std::int64_t row = 0; row < rows; ++row) {
    for (std::int64_t column = 0; column < columns; ++column) {
      const Vec2 site = {(static_cast<double>(column) + (row % 2 == 0 ? 0.25 : 0.75)) * s,
                         (static_cast<double>(row) + 0.5) * row_distance};
      const Vec2 moved = site + disorder * s * in_unit_disc(random);
      set.points.push_back(options.periodic ? Vec2{wrapped(moved.x, set.extent.x), wrapped(moved.y, set.extent.y)}
                                            : Vec2{mirrored(moved.x, set.extent.x), mirrored(moved.y, set.extent.y)});
    }
  }
  return set;
}

namespace {

/// Area that points r apart take of the plane once no more fit, over r²: the discs of diameter r then cover 0.547070
/// of it (Zhang & Torquato 2013, Phys. Rev. E 88, 053312).
constexpr double saturation_density = 4 * 0.547070 / std::numbers::pi;
/// A free side is crowded: nothing outside takes space from it. It counts as if it were this share of r further out
/// (measured on samples of this generator; only the closeness to the wanted count depends on it).
constexpr double side_gain = 1.0 / 3;

/// A square of the 2^level-th part of a base square of the grid.
struct Square {
  std::uint32_t x;
  std::uint32_t y;
};

/// Random numbers of a dart: one of the squares, and the place in it.
struct Throw {
  std::uint64_t square;
  Vec2 place;  ///< in [0, 1)²
};

/// A trial point in a square.
struct Dart {
  Vec2 point;
  std::int32_t column;  ///< of the base square
  std::int32_t row;
};

enum class Verdict : std::uint8_t { rejected, accepted, open };

/// Random sequential adsorption on a grid of base squares so small that each holds at most one point.
class Adsorption {
 public:
  Adsorption(Vec2 extent, double distance, bool periodic)
      : extent_(extent), periodic_(periodic), distance_(distance), squared_distance_(distance * distance) {
    const double widest = distance / std::numbers::sqrt2;
    columns_ = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(extent.x / widest)));
    rows_ = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(extent.y / widest)));
    size_ = {extent.x / static_cast<double>(columns_), extent.y / static_cast<double>(rows_)};
    reach_y_ = static_cast<std::int64_t>(std::ceil(distance / size_.y));
    points_.assign(static_cast<std::size_t>(columns_ * rows_), {nothing, nothing});
    open_in_.assign(points_.size(), none);
  }

  std::vector<Vec2> saturate(Random& random) {
    std::vector<Square> squares;
    squares.reserve(points_.size());
    for (std::int64_t y = 0; y < rows_; ++y) {
      for (std::int64_t x = 0; x < columns_; ++x) {
        squares.push_back({static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)});
      }
    }
    // After twenty halvings the squares that are left are negligible.
    for (int level = 0; level <= 20 && !squares.empty(); ++level) {
      throw_darts(squares, level, random);
      squares = halved(squares, level);
    }
    return std::move(found_);
  }

 private:
  static constexpr double nothing = std::numeric_limits<double>::infinity();
  static constexpr std::int32_t none = -1;
  static constexpr std::int64_t block_width = 64;  ///< base squares
  static constexpr std::size_t piece = 16384;      ///< of squares and throws, for one task
  static constexpr std::int64_t most_bands = 16;

  /// Base squares from `first` to `last`, both included, along one direction.
  struct Range {
    std::int64_t first, last;
  };

  /// A few throws for every square, each into any of them, so that points stay uniform in the free space. The throws
  /// of a round are made block by block, in which they keep their order: neighbouring blocks then stay in the cache,
  /// and only throws of one round on both sides of a block's border may change places in time.
  void throw_darts(std::vector<Square>& squares, int level, Random& random) {
    for (int round = 0; round < 6 && !squares.empty(); ++round) {
      stop_if_interrupted();
      throws_.resize((squares.size() + 7) / 8);
      for (Throw& one : throws_) {
        one.square = random.below(squares.size());
        one.place.x = random.uniform();
        one.place.y = random.uniform();
      }
      sort_by_block(squares, level);
      accept(sorted_);
      erase_taken(squares, level);
    }
  }

  /// Set `sorted_`, the darts of the throws, block by block (stable counting sort), and `first_of_row_`, the number of
  /// the first dart of every row of blocks.
  void sort_by_block(const std::vector<Square>& squares, int level) {
    const double part = 1.0 / static_cast<double>(1U << level);
    const std::int64_t blocks_in_row = (columns_ + block_width - 1) / block_width;
    const std::int64_t block_rows = (rows_ + block_width - 1) / block_width;
    const auto blocks = static_cast<std::size_t>(block_rows * blocks_in_row);
    const std::size_t tasks = std::clamp<std::size_t>(throws_.size() / piece, 1, 32);
    const auto first_throw = [&](std::size_t task) { return throws_.size() * task / tasks; };
    darts_.resize(throws_.size());
    sorted_.resize(throws_.size());
    const auto block = [&](const Dart& dart) {
      return static_cast<std::size_t>(dart.row / block_width * blocks_in_row + dart.column / block_width);
    };
    std::vector<std::size_t> place(tasks * blocks, 0);  // of the next dart of each task in each block
    parallel_tasks(tasks, [&](std::size_t task, int) {
      for (std::size_t k = first_throw(task); k < first_throw(task + 1); ++k) {
        const auto [x, y] = squares[throws_[k].square];
        const Vec2 at = throws_[k].place;
        darts_[k] = {.point = {(x + at.x) * part * size_.x, (y + at.y) * part * size_.y},
                     .column = static_cast<std::int32_t>(x >> level),
                     .row = static_cast<std::int32_t>(y >> level)};
        ++place[task * blocks + block(darts_[k])];
      }
    });
    first_of_row_.clear();
    std::size_t next = 0;
    for (std::size_t b = 0; b < blocks; ++b) {
      if (b % static_cast<std::size_t>(blocks_in_row) == 0) first_of_row_.push_back(next);
      for (std::size_t task = 0; task < tasks; ++task) next += std::exchange(place[task * blocks + b], next);
    }
    first_of_row_.push_back(next);
    parallel_tasks(tasks, [&](std::size_t task, int) {
      for (std::size_t k = first_throw(task); k < first_throw(task + 1); ++k)
        sorted_[place[task * blocks + block(darts_[k])]++] = darts_[k];
    });
  }

  /// Add the darts that hit free places, as if one after the other. Bands of block rows are worked on at the same time:
  /// a dart that a dart of another band may decide stays open, as does one that an open dart before it may decide;
  /// open darts then have their turn, in order, so that the points are those of a single pass.
  void accept(const std::vector<Dart>& darts) {
    const auto block_rows = std::ssize(first_of_row_) - 1;
    const std::int64_t bands = darts.size() < piece ? 1 : std::min<std::int64_t>(block_rows / 2, most_bands);
    std::vector<Verdict> verdicts(darts.size(), Verdict::open);
    if (bands > 1) {
      next_open_.assign(darts.size(), none);
      parallel_tasks(static_cast<std::size_t>(bands), [&](std::size_t band, int) {
        const std::int64_t begin = block_rows * static_cast<std::int64_t>(band) / bands;
        const std::int64_t end = block_rows * (static_cast<std::int64_t>(band) + 1) / bands;
        accept_band(darts, begin, end, verdicts);
      });
    }
    for (std::size_t k = 0; k < darts.size(); ++k) {
      if (verdicts[k] == Verdict::open) {
        open_in_[index(darts[k].column, darts[k].row)] = none;
        if (is_free(darts[k])) {
          add(darts[k]);
          verdicts[k] = Verdict::accepted;
        }
      }
      if (verdicts[k] == Verdict::accepted) found_.push_back(darts[k].point);
    }
  }

  /// Verdicts on the darts of block rows [begin, end) that depend on these rows alone.
  void accept_band(const std::vector<Dart>& darts, std::int64_t begin, std::int64_t end,
                   std::vector<Verdict>& verdicts) {
    const Range inner = {begin * block_width + reach_y_, std::min(end * block_width, rows_) - 1 - reach_y_};
    const std::int64_t middle = (inner.first + inner.last) / 2;
    Range sure = inner;  // rows further in than all open darts
    for (std::size_t k = first_of_row_[static_cast<std::size_t>(begin)];
         k < first_of_row_[static_cast<std::size_t>(end)]; ++k) {
      const Dart& dart = darts[k];
      const bool is_inner = dart.row >= inner.first && dart.row <= inner.last;
      if (is_inner && !is_free(dart)) {
        verdicts[k] = Verdict::rejected;
        continue;
      }
      const bool is_sure = dart.row - reach_y_ >= sure.first && dart.row + reach_y_ <= sure.last;
      if (is_sure || (is_inner && !meets_open(darts, dart))) {
        add(dart);
        verdicts[k] = Verdict::accepted;
        continue;
      }
      next_open_[k] = std::exchange(open_in_[index(dart.column, dart.row)], static_cast<std::int32_t>(k));
      if (dart.row <= middle) {
        sure.first = std::max<std::int64_t>(sure.first, dart.row + 1);
      } else {
        sure.last = std::min<std::int64_t>(sure.last, dart.row - 1);
      }
    }
  }

  /// Whether one of the open darts, if accepted, would keep this one out.
  [[nodiscard]] bool meets_open(const std::vector<Dart>& darts, const Dart& dart) const {
    return any_square_near(around(dart.point.x, size_.x), around(dart.point.y, size_.y),
                           [&](std::size_t square, Vec2 shift) {
                             for (std::int32_t k = open_in_[square]; k != none; k = next_open_[k]) {
                               const Vec2 d = darts[k].point + shift - dart.point;
                               if (square == index(dart.column, dart.row) || dot(d, d) < squared_distance_) return true;
                             }
                             return false;
                           });
  }

  void add(const Dart& dart) { points_[index(dart.column, dart.row)] = dart.point; }

  [[nodiscard]] bool taken(std::int64_t column, std::int64_t row) const {
    return points_[index(column, row)].x != nothing;
  }

  [[nodiscard]] std::size_t index(std::int64_t column, std::int64_t row) const {
    return static_cast<std::size_t>(row * columns_ + column);
  }

  /// Leave out the squares whose base square has a point.
  void erase_taken(std::vector<Square>& squares, int level) const {
    const std::size_t tasks = (squares.size() + piece - 1) / piece;
    std::vector<std::size_t> kept(tasks);
    parallel_tasks(tasks, [&](std::size_t task, int) {
      const auto begin = squares.begin() + static_cast<std::ptrdiff_t>(task * piece);
      const auto end = squares.begin() + static_cast<std::ptrdiff_t>(std::min(squares.size(), (task + 1) * piece));
      kept[task] = static_cast<std::size_t>(
          std::remove_if(begin, end, [&](const Square& s) { return taken(s.x >> level, s.y >> level); }) - begin);
    });
    auto last = squares.begin();
    for (std::size_t task = 0; task < tasks; ++task) {
      const auto begin = squares.begin() + static_cast<std::ptrdiff_t>(task * piece);
      last = std::move(begin, begin + static_cast<std::ptrdiff_t>(kept[task]), last);
    }
    squares.erase(last, squares.end());
  }

  /// The base squares that can have points nearer than the distance to a place x, some further out for rounding; where
  /// free they may lie beyond the sides.
  [[nodiscard]] Range around(double x, double size) const {
    const double reach = (1 + 1e-6) * distance_;
    return {static_cast<std::int64_t>(std::floor((x - reach) / size)),
            static_cast<std::int64_t>(std::floor((x + reach) / size))};
  }

  /// Call body(base square, shift of its image) for the base squares in these columns, row by row until it returns
  /// true.
  template <typename Body>
  bool any_square_near(Range columns, Range rows, const Body& body) const {
    if (columns.first >= 0 && columns.last < columns_ && rows.first >= 0 && rows.last < rows_) {
      for (std::int64_t y = rows.first; y <= rows.last; ++y) {
        bool found = false;
        for (std::int64_t x = columns.first; x <= columns.last; ++x) found |= body(index(x, y), Vec2{});
        if (found) return true;
      }
      return false;
    }
    for (std::int64_t y = rows.first; y <= rows.last; ++y) {
      Vec2 shift;
      const std::int64_t wy = periodic_ ? wrapped(y, rows_, extent_.y, shift.y) : y;
      if (wy < 0 || wy >= rows_) continue;
      for (std::int64_t x = columns.first; x <= columns.last; ++x) {
        const std::int64_t wx = periodic_ ? wrapped(x, columns_, extent_.x, shift.x) : x;
        if (wx < 0 || wx >= columns_) continue;
        if (body(index(wx, wy), shift)) return true;
      }
    }
    return false;
  }

  static std::int64_t wrapped(std::int64_t index, std::int64_t count, double length, double& shift) {
    shift = 0;
    for (; index < 0; index += count) shift -= length;
    for (; index >= count; index -= count) shift += length;
    return index;
  }

  [[nodiscard]] bool is_free(const Dart& dart) const {
    if (taken(dart.column, dart.row)) return false;
    return !any_square_near(around(dart.point.x, size_.x), around(dart.point.y, size_.y),
                            [&](std::size_t square, Vec2 shift) {
                              const Vec2 d = points_[square] + shift - dart.point;
                              return dot(d, d) < squared_distance_;
                            });
  }

  /// The quarters of squares that no single point covers whole, in the order of the squares.
  [[nodiscard]] std::vector<Square> halved(const std::vector<Square>& squares, int level) const {
    std::vector<std::vector<Square>> quarters((squares.size() + piece - 1) / piece);
    parallel_tasks(quarters.size(), [&](std::size_t task, int) {
      std::vector<Vec2> near;
      std::size_t near_to = points_.size();  // the base square
      const std::size_t end = std::min(squares.size(), (task + 1) * piece);
      quarters[task].resize(4 * (end - task * piece));
      Square* into = quarters[task].data();
      for (std::size_t k = task * piece; k < end; ++k) {
        const std::int64_t column = squares[k].x >> level, row = squares[k].y >> level;
        if (std::exchange(near_to, index(column, row)) != near_to) find_near(column, row, level, near);
        into = add_quarters(squares[k], level, near, into);
      }
      quarters[task].resize(static_cast<std::size_t>(into - quarters[task].data()));
      quarters[task].shrink_to_fit();
    });
    std::vector<Square> result;
    std::size_t count = 0;
    for (const auto& some : quarters) count += some.size();
    result.reserve(count);
    for (const auto& some : quarters) result.insert(result.end(), some.begin(), some.end());
    return result;
  }

  /// Set `near` to the points that can cover a quarter of a square of this level in a base square.
  void find_near(std::int64_t column, std::int64_t row, int level, std::vector<Vec2>& near) const {
    const double inset = 0.5 / static_cast<double>(1U << level);  // of the centre of the outermost square
    const auto range = [&](std::int64_t base, double size) {
      const auto first = static_cast<double>(base);
      return Range{around((first + inset) * size, size).first, around((first + 1 - inset) * size, size).last};
    };
    const Range columns = range(column, size_.x), rows = range(row, size_.y);
    near.resize(static_cast<std::size_t>((columns.last - columns.first + 1) * (rows.last - rows.first + 1)));
    std::size_t count = 0;
    any_square_near(columns, rows, [&](std::size_t square, Vec2 shift) {
      near[count] = points_[square] + shift;
      count += points_[square].x != nothing ? 1 : 0;
      return false;
    });
    near.resize(count);
  }

  /// Write the quarters of a square that no point covers; four places must be free. \return the end of what it wrote
  Square* add_quarters(const Square& square, int level, const std::vector<Vec2>& near, Square* into) const {
    const Vec2 half = 0.5 / static_cast<double>(2U << level) * size_;
    const auto centre = [](std::uint32_t quarter, double half_size) { return (2.0 * quarter + 1) * half_size; };
    const double left = centre(2 * square.x, half.x), right = centre(2 * square.x + 1, half.x);
    const double lower = centre(2 * square.y, half.y), upper = centre(2 * square.y + 1, half.y);
    const auto squared = [](double x) { return x * x; };
    unsigned covered = 0;  // without branches, of which half would be mispredicted
    for (const Vec2 point : near) {
      const double x[] = {squared(std::abs(point.x - left) + half.x), squared(std::abs(point.x - right) + half.x)};
      const double y[] = {squared(std::abs(point.y - lower) + half.y), squared(std::abs(point.y - upper) + half.y)};
      for (unsigned k = 0; k < 4; ++k) covered |= (x[k & 1U] + y[k >> 1U] < squared_distance_ ? 1U : 0U) << k;
    }
    for (std::uint32_t k = 0; k < 4; ++k) {
      *into = {2 * square.x + (k & 1U), 2 * square.y + (k >> 1U)};
      into += 1 - (covered >> k & 1U);
    }
    return into;
  }

  Vec2 extent_;
  bool periodic_;
  double distance_, squared_distance_;
  std::int64_t columns_ = 0;
  std::int64_t rows_ = 0;
  std::int64_t reach_y_ = 0;  ///< base squares above and below that can hold a point in the way
  Vec2 size_;                 ///< of a base square
  std::vector<Vec2> points_;  ///< of each base square
  std::vector<Vec2> found_;
  std::vector<Throw> throws_;
  std::vector<Dart> darts_, sorted_;
  std::vector<std::size_t> first_of_row_;
  std::vector<std::int32_t> open_in_;    ///< per base square: the last open dart in it
  std::vector<std::int32_t> next_open_;  ///< per dart: the open dart before it in the same base square
};

/// The distance r at which `count` points are expected: count r² = density (width + 2 gain r) (height + 2 gain r).
double distance_for(double count, Vec2 extent, double gain) {
  const double a = count / saturation_density - 4 * gain * gain;
  const double b = 2 * gain * (extent.x + extent.y);
  const double c = extent.x * extent.y;
  return (b + std::sqrt(b * b + 4 * std::max(a, 0.0) * c)) / (2 * std::max(a, 0.1));
}

}  // namespace

PointSet poisson_disc_points(const PointOptions& options, Random& random) {
  const auto count = static_cast<double>(options.count);
  const double area_per_point = 0.5 * std::numbers::sqrt3 * options.spacing * options.spacing;
  // At first in units in which a point has the area 1; the number found decides the scale.
  const double height = std::sqrt(count / options.aspect);
  const Vec2 extent = {count / height, height};
  const double distance = distance_for(count, extent, options.periodic ? 0 : side_gain);
  PointSet set;
  set.points = Adsorption(extent, distance, options.periodic).saturate(random);
  const double scale = std::sqrt(area_per_point * static_cast<double>(set.points.size()) / count);
  for (Vec2& point : set.points) point *= scale;
  set.extent = scale * extent;
  return set;
}

}  // namespace equidem
