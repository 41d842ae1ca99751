// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sukegawa2010/sukegawa2010.hpp"

namespace equidem::sukegawa2010 {
namespace {

constexpr double first_part = 0.1;  // s
constexpr std::size_t profile_layers = 10;

/// Grains in the order of their height, by number.
std::vector<std::size_t> by_height(const std::vector<Grain>& grains) {
  std::vector<std::size_t> order(grains.size());
  for (std::size_t g = 0; g < order.size(); ++g) order[g] = g;
  std::ranges::sort(order, {}, [&](std::size_t g) { return std::pair(grains[g].position.y, g); });
  return order;
}

}  // namespace

void GrainMovement::add(const std::vector<Grain>& grains, double left, double time) {
  std::vector<Grain> now = grains;
  for (Grain& grain : now) grain.position.x -= left;
  if (last_.empty()) {
    start_ = now;
    ways_.resize(now.size());
  } else {
    for (std::size_t g = 0; g < now.size(); ++g) {
      const Vec2 moved = now[g].position - last_[g].position;
      Way& way = ways_[g];
      way.all += norm(moved);
      way.along_x += std::abs(moved.x);
      if (time < 1.001 * first_part) way.first += norm(moved);
      way.turned += std::abs(now[g].angle - last_[g].angle);
    }
  }
  last_ = std::move(now);
}

void GrainMovement::tell(Outcome& outcome, double width) const {
  const auto number = static_cast<double>(start_.size());
  outcome.path = outcome.path_x = outcome.first_path = outcome.turn = 0;
  for (const Way& way : ways_) {
    outcome.path += way.all / number;
    outcome.path_x += way.along_x / number;
    outcome.first_path += way.first / number;
    outcome.turn += way.turned / number;
  }
  double squares = 0, inward = 0, outer = 0, sunk = 0;
  std::array<double, profile_layers> sums{}, members{};
  const std::vector<std::size_t> order = by_height(start_);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::size_t g = order[k];
    const Vec2 moved = last_[g].position - start_[g].position;
    const double from_middle = start_[g].position.x - 0.5 * width;
    if (std::abs(from_middle) > width / 6) {
      inward += from_middle > 0 ? -moved.x : moved.x;
      outer += 1;
    }
    squares += squared(moved.x);
    sunk -= moved.y;
    sums[k * profile_layers / order.size()] += moved.x;
    members[k * profile_layers / order.size()] += 1;
  }
  double in_common = 0;
  for (std::size_t layer = 0; layer < profile_layers; ++layer)
    in_common += squared(sums[layer]) / std::max(1.0, members[layer]);
  outcome.displaced_x = std::sqrt(squares / number);
  outcome.inward = outer > 0 ? inward / outer : 0;
  outcome.sunk = sunk / number;
  outcome.layered = squares > 0 ? in_common / squares : 0;
}

}  // namespace equidem::sukegawa2010
