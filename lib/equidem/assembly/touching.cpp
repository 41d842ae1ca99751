// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/touching.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>

#include "equidem/assembly/sites.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// Gaps up to this share of the smaller radius are rounding of the centres.
constexpr double rounding_gap = 1e-9;
/// Discs wider than this many periods are taken for a mistake.
constexpr int most_periods = 16;

/// Discs sorted into squares at least one largest diameter wide, so that touching discs lie in squares that touch.
class Grid {
 public:
  Grid(const Assembly& assembly, double gap_tolerance) : assembly_(assembly) {
    const double reach = 2 * (1 + std::max(gap_tolerance, rounding_gap)) *
                         *std::max_element(assembly.radii.begin(), assembly.radii.end());
    low_ = high_ = assembly.centres.front();
    for (const Vec2 x : assembly.centres) {
      low_ = {std::min(low_.x, x.x), std::min(low_.y, x.y)};
      high_ = {std::max(high_.x, x.x), std::max(high_.y, x.y)};
    }
    if (assembly.period) {
      const double narrow = std::min(assembly.period->x, assembly.period->y);
      if (reach > most_periods * narrow) {
        bad_input(fmt::format("the largest disc, of diameter {:.6g} m, spans more than {} periods of {:.6g} m", reach,
                              most_periods, narrow),
                  "it would touch itself that many times", "Correct the radii or the cell");
      }
      low_ = {0, 0};
      high_ = *assembly.period;
    }
    // No more squares than discs along either direction: few discs far apart need no fine grid.
    const auto most = static_cast<double>(assembly.size());
    columns_ = static_cast<std::int64_t>(std::clamp(std::floor((high_.x - low_.x) / reach), 1.0, most));
    rows_ = static_cast<std::int64_t>(std::clamp(std::floor((high_.y - low_.y) / reach), 1.0, most));
    while (columns_ * rows_ > 4 * static_cast<std::int64_t>(assembly.size()) + 16) {
      columns_ = (columns_ + 1) / 2;
      rows_ = (rows_ + 1) / 2;
    }
    width_ = (high_.x - low_.x) / static_cast<double>(columns_);
    height_ = (high_.y - low_.y) / static_cast<double>(rows_);
    // A free sample may be as flat as one likes: its discs lie in neighbouring squares at most.
    const double farthest = assembly.period ? std::numeric_limits<std::int32_t>::max() : 1;
    reach_x_ = width_ > 0 ? static_cast<std::int64_t>(std::min(std::ceil(reach / width_), farthest)) : 0;
    reach_y_ = height_ > 0 ? static_cast<std::int64_t>(std::min(std::ceil(reach / height_), farthest)) : 0;
    sort_discs();
  }

  /// Call body(other disc, shift_x, shift_y) for the images of discs near a disc, itself among them.
  template <typename Body>
  void for_each_near(std::size_t disc, const Body& body) const {
    const Place at = places_[disc];
    for (std::int64_t y = at.row - reach_y_; y <= at.row + reach_y_; ++y) {
      for (std::int64_t x = at.column - reach_x_; x <= at.column + reach_x_; ++x) {
        std::int64_t sx = 0;
        std::int64_t sy = 0;
        if (assembly_.period) {
          sx = static_cast<std::int64_t>(std::floor(static_cast<double>(x) / static_cast<double>(columns_)));
          sy = static_cast<std::int64_t>(std::floor(static_cast<double>(y) / static_cast<double>(rows_)));
        } else if (x < 0 || x >= columns_ || y < 0 || y >= rows_) {
          continue;
        }
        const auto square = static_cast<std::size_t>((y - sy * rows_) * columns_ + (x - sx * columns_));
        for (std::size_t k = first_[square]; k < first_[square + 1]; ++k) {
          const std::int32_t other = sorted_[k];
          body(other, static_cast<std::int32_t>(sx + at.moved_x - places_[other].moved_x),
               static_cast<std::int32_t>(sy + at.moved_y - places_[other].moved_y));
        }
      }
    }
  }

 private:
  /// The square of a disc, and the periods by which its centre lies outside the cell.
  struct Place {
    std::int64_t column = 0;
    std::int64_t row = 0;
    std::int64_t moved_x = 0;
    std::int64_t moved_y = 0;
  };

  [[nodiscard]] Place place(std::size_t disc) const {
    Vec2 x = assembly_.centres[disc];
    Place p;
    if (assembly_.period) {
      p.moved_x = periods_below(x.x, assembly_.period->x, disc);
      p.moved_y = periods_below(x.y, assembly_.period->y, disc);
      x -= Vec2{static_cast<double>(p.moved_x) * assembly_.period->x,
                static_cast<double>(p.moved_y) * assembly_.period->y};
    }
    if (width_ > 0) {
      p.column = std::clamp<std::int64_t>(static_cast<std::int64_t>((x.x - low_.x) / width_), 0, columns_ - 1);
    }
    if (height_ > 0) {
      p.row = std::clamp<std::int64_t>(static_cast<std::int64_t>((x.y - low_.y) / height_), 0, rows_ - 1);
    }
    return p;
  }

  void sort_discs() {
    first_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
    for (std::size_t disc = 0; disc < assembly_.size(); ++disc) {
      places_.push_back(place(disc));
      ++first_[square_of(places_.back()) + 1];
    }
    for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
    std::vector<std::size_t> next = first_;
    sorted_.resize(assembly_.size());
    for (std::size_t disc = 0; disc < assembly_.size(); ++disc) {
      sorted_[next[square_of(places_[disc])]++] = static_cast<std::int32_t>(disc);
    }
  }

  [[nodiscard]] std::size_t square_of(const Place& p) const {
    return static_cast<std::size_t>(p.row * columns_ + p.column);
  }

  const Assembly& assembly_;
  Vec2 low_;
  Vec2 high_;
  std::int64_t columns_ = 1;
  std::int64_t rows_ = 1;
  double width_ = 0;
  double height_ = 0;
  std::int64_t reach_x_ = 0;
  std::int64_t reach_y_ = 0;
  std::vector<Place> places_;
  std::vector<std::size_t> first_;
  std::vector<std::int32_t> sorted_;
};

}  // namespace

std::vector<Contact> touching_discs(const Assembly& assembly, double gap_tolerance) {
  const Grid grid(assembly, gap_tolerance);
  std::vector<Contact> contacts;
  for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
    const std::size_t first = contacts.size();
    const auto i = static_cast<std::int32_t>(disc);
    grid.for_each_near(disc, [&](std::int32_t j, std::int32_t shift_x, std::int32_t shift_y) {
      if (std::tuple(i, 0, 0) >= std::tuple(j, shift_x, shift_y)) return;
      Contact contact{.i = i, .j = j, .shift_x = shift_x, .shift_y = shift_y};
      const double distance = norm(assembly.branch(contact));
      const double ri = assembly.radii[i], rj = assembly.radii[j];
      if (distance - ri - rj > std::max(rounding_gap * std::min(ri, rj), gap_tolerance * (ri + rj))) return;
      contact.lever_i = contact.lever_j = 0.5 * distance;
      contacts.push_back(contact);
    });
    std::sort(contacts.begin() + static_cast<std::ptrdiff_t>(first), contacts.end(),
              [](const Contact& a, const Contact& b) {
                return std::tie(a.j, a.shift_x, a.shift_y) < std::tie(b.j, b.shift_x, b.shift_y);
              });
  }
  return contacts;
}

std::vector<BondCount> bond_counts(std::span<const double> gaps, std::size_t bodies) {
  std::vector<BondCount> counts;
  for (const double tolerance : {0.0, 0.01, 0.02, 0.05, 0.1, 0.2, largest_counted_gap}) {
    const std::int64_t found = std::ranges::count_if(gaps, [&](double gap) { return gap <= tolerance; });
    counts.push_back({tolerance, found, 2 * static_cast<double>(found) / static_cast<double>(bodies)});
  }
  return counts;
}

std::vector<BondCount> bond_counts(const Assembly& discs) {
  std::vector<double> gaps;
  for (const Contact& c : touching_discs(discs, largest_counted_gap)) {
    const double sum = discs.radii[static_cast<std::size_t>(c.i)] + discs.radii[static_cast<std::size_t>(c.j)];
    const double gap = norm(discs.branch(c)) / sum - 1;
    gaps.push_back(gap <= rounding_gap ? std::min(gap, 0.0) : gap);
  }
  return bond_counts(gaps, discs.size());
}

std::string suggested_tolerance(std::span<const BondCount> counts, double tolerance) {
  constexpr double wanted = 4;
  const BondCount* best = nullptr;
  std::int64_t now = 0;
  for (const BondCount& count : counts) {
    if (count.gap_tolerance <= tolerance) {
      now = count.contacts;
    } else if (best == nullptr || best->coordination < wanted) {
      best = &count;
    }
  }
  if (best == nullptr || best->contacts <= now) return {};
  return fmt::format("gap_tolerance = {} would find {} (z = {:.3g})", best->gap_tolerance,
                     counted(best->contacts, "contact"), best->coordination);
}

std::string by_larger_tolerance(const Assembly& assembly) {
  return assembly.gap_tolerance ? fmt::format(" by a gap_tolerance above {:g}", *assembly.gap_tolerance) : "";
}

void check_found_contacts(const Assembly& assembly) {
  if (!assembly.gap_tolerance) return;
  // The edges of a triangulation of many points in the plane: six of each.
  constexpr double most = 6;
  const double tolerance = *assembly.gap_tolerance, coordination = assembly.coordination_number();
  if (assembly.contacts.empty()) {
    const std::string larger = suggested_tolerance(bond_counts(assembly), tolerance);
    bad_input(fmt::format("gap_tolerance = {} joins none of the {}", tolerance,
                          counted(std::ssize(assembly.centres), "body", "bodies")),
              "without contacts nothing resists a deformation",
              larger.empty() ? "Pack them denser, or correct the radii" : "Take a larger one: " + larger);
  }
  if (tolerance == 0 || coordination <= most) return;
  std::string smaller = "Take a smaller one";
  for (const BondCount& count : bond_counts(assembly))
    if (count.coordination <= most && count.gap_tolerance < tolerance)
      smaller = fmt::format("Take a smaller one: gap_tolerance = {} finds {} (z = {:.3g})", count.gap_tolerance,
                            counted(count.contacts, "contact"), count.coordination);
  bad_input(fmt::format("gap_tolerance = {} finds {}, {:.3g} of each body", tolerance,
                        counted(std::ssize(assembly.contacts), "contact"), coordination),
            "above six contacts cross: they join bodies with others between them", smaller);
}

}  // namespace equidem
