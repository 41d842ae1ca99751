// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/sites.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/assembly/space_filling_curve.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// Margin of images at first, in mean spacings: empty circles of random points are seldom wider.
constexpr double first_margin = 4;
/// Images beyond this many per disc, and this many at all, are refused: thousands on one line take seconds.
constexpr double most_images_per_disc = 24;
constexpr double most_images = 2e3;

}  // namespace

std::int32_t periods_below(double x, double period, std::size_t disc) {
  const double periods = std::floor(x / period);
  if (std::abs(periods) > 1e9) {
    bad_input(fmt::format("disc {} lies {} periods away from the periodic cell", disc, periods),
              "its place within the cell is lost to rounding", "Give it a centre near the cell");
  }
  return static_cast<std::int32_t>(periods);
}

Sites::Sites(const Assembly& assembly)
    : discs_(static_cast<std::int32_t>(assembly.size())), positions_(assembly.centres) {
  if (std::any_of(assembly.radii.begin(), assembly.radii.end(),
                  [&](double r) { return r != assembly.radii.front(); })) {
    for (const double r : assembly.radii) weights_.push_back(r * r);
    largest_weight_ = *std::max_element(weights_.begin(), weights_.end());
  }
  if (assembly.periodic()) {
    period_ = *assembly.period;
    margin_ = first_margin * std::sqrt(period_.x * period_.y / static_cast<double>(discs_));
    moved_.reserve(positions_.size());
    for (std::size_t disc = 0; disc < positions_.size(); ++disc) {
      Vec2& x = positions_[disc];
      const std::int32_t kx = periods_below(x.x, period_.x, disc);
      const std::int32_t ky = periods_below(x.y, period_.y, disc);
      moved_.push_back({.disc = static_cast<std::int32_t>(disc), .shift_x = kx, .shift_y = ky});
      x -= Vec2{kx * period_.x, ky * period_.y};
    }
    surround();
  }
  sort();
}

void Sites::widen() {
  margin_ *= 2;
  surround();
  sort();
}

void Sites::surround() {
  const auto n = static_cast<double>(discs_);
  const double expected = n * ((period_.x + 2 * margin_) / period_.x * ((period_.y + 2 * margin_) / period_.y) - 1);
  if (expected > most_images_per_disc * n + most_images) {
    bad_input(fmt::format("the periodic cell of {} m by {} m needs more than {:.3g} images around it to find the "
                          "neighbours of "
                          "its {}",
                          period_.x, period_.y, most_images_per_disc * n + most_images, counted(discs_, "disc")),
              "it is too narrow, or its discs leave too wide a gap",
              "Repeat the cell along its narrow side, or fill the gap");
  }
  images_.clear();
  positions_.resize(static_cast<std::size_t>(discs_));
  if (weighted()) weights_.resize(positions_.size());
  const auto kx = static_cast<std::int32_t>(std::ceil(margin_ / period_.x));
  const auto ky = static_cast<std::int32_t>(std::ceil(margin_ / period_.y));
  const Rectangle all = region();
  for (std::int32_t sy = -ky; sy <= ky; ++sy) {
    for (std::int32_t sx = -kx; sx <= kx; ++sx) {
      if (sx == 0 && sy == 0) continue;
      for (std::int32_t disc = 0; disc < discs_; ++disc) {
        const Vec2 x = positions_[disc] + Vec2{sx * period_.x, sy * period_.y};
        if (x.x < all.low.x || x.x > all.high.x || x.y < all.low.y || x.y > all.high.y) continue;
        images_.push_back({.disc = disc, .shift_x = sx, .shift_y = sy});
        positions_.push_back(x);
        if (weighted()) weights_.push_back(weights_[disc]);
      }
    }
  }
}

void Sites::sort() {
  order_ = hilbert_order(positions_);
  for (std::size_t k = 1; k < order_.size(); ++k) {
    const std::int32_t a = image(order_[k - 1]).disc;
    const std::int32_t b = image(order_[k]).disc;
    if (a == b || positions_[order_[k - 1]] != positions_[order_[k]]) continue;
    bad_input(fmt::format("discs {} and {} have the same centre, ({}, {}) m", std::min(a, b), std::max(a, b),
                          positions_[a].x, positions_[a].y),
              "no direction joins them, and their cells cannot be separated", "Move or remove one of them");
  }
}

Contact Sites::contact(std::int32_t a, std::int32_t b) const {
  const Image other = image(b);
  Contact contact{.i = a, .j = other.disc, .shift_x = other.shift_x, .shift_y = other.shift_y};
  if (!moved_.empty()) {
    contact.shift_x += moved_[a].shift_x - moved_[other.disc].shift_x;
    contact.shift_y += moved_[a].shift_y - moved_[other.disc].shift_y;
  }
  return contact;
}

}  // namespace equidem
