// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/packing/overlaps.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/progress.hpp"

namespace equidem {

const std::vector<DiscPair>& PairFinder::within(const PackingBox& box, std::span<const Vec2> centres,
                                                std::span<const double> radii, double margin) {
  const std::size_t count = centres.size();
  circles_.clear();
  owner_.clear();
  shift_.clear();
  double largest = 0;
  for (std::size_t k = 0; k < count; ++k) {
    circles_.push_back({centres[k], radii[k]});
    owner_.push_back(static_cast<std::int32_t>(k));
    shift_.push_back({});
    largest = std::max(largest, radii[k]);
  }
  if (box.periodic()) {
    for (std::size_t k = 0; k < count; ++k) {
      const double reach = radii[k] + largest + margin;
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
          const Vec2 shift = {x * box.size.x, y * box.size.y};
          const Vec2 place = centres[k] + shift;
          const bool near =
              place.x > -reach && place.x < box.size.x + reach && place.y > -reach && place.y < box.size.y + reach;
          if ((x == 0 && y == 0) || !near) continue;
          circles_.push_back({place, radii[k]});
          owner_.push_back(static_cast<std::int32_t>(k));
          shift_.push_back(shift);
        }
      }
    }
  }
  const NeighbourList& list = finder_.within(circles_, margin);
  pairs_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::int64_t p = list.begin[i]; p < list.begin[i + 1]; ++p) {
      const auto q = static_cast<std::size_t>(list.partner[static_cast<std::size_t>(p)]);
      const std::int32_t j = owner_[q];
      // Of the two that see each other across a side, the first counts.
      if (q >= count && j <= static_cast<std::int32_t>(i)) continue;
      pairs_.push_back({static_cast<std::int32_t>(i), j, shift_[q]});
    }
  }
  return pairs_;
}

namespace {

/// Forces of all overlaps, in units of the mean radius.
struct Forces {
  std::vector<Vec2> force;
  double sum = 0;  ///< of all contact forces
  double largest = 0;
  std::int64_t contacts = 0;

  void count(double overlap) {
    sum += overlap;
    largest = std::max(largest, overlap);
    ++contacts;
  }
};

void push_from_walls(const PackingBox& box, std::span<const Vec2> centres, std::span<const double> radii, Forces& out) {
  const bool lid = box.sides == PackingBox::Sides::walls;
  for (std::size_t k = 0; k < centres.size(); ++k) {
    const Vec2 x = centres[k];
    const double r = radii[k];
    const double below = r - x.y, left = r - x.x, right = x.x + r - box.size.x, above = lid ? x.y + r - box.size.y : 0;
    if (below > 0) out.force[k].y += below, out.count(below);
    if (left > 0) out.force[k].x += left, out.count(left);
    if (right > 0) out.force[k].x -= right, out.count(right);
    if (above > 0) out.force[k].y -= above, out.count(above);
  }
}

void evaluate(const PackingBox& box, std::span<const Vec2> centres, std::span<const double> radii,
              std::span<const DiscPair> pairs, std::span<const Vec2> weights, Forces& out) {
  out.force.assign(weights.begin(), weights.end());
  out.sum = out.largest = 0;
  out.contacts = 0;
  for (const DiscPair& pair : pairs) {
    const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j);
    const Vec2 branch = centres[j] + pair.shift - centres[i];
    const double reach = radii[i] + radii[j], square = dot(branch, branch);
    if (square >= reach * reach) continue;
    const double distance = std::sqrt(square), overlap = reach - distance;
    const Vec2 push = (distance > 0 ? overlap / distance : 0) * branch;
    out.force[i] -= push;
    out.force[j] += push;
    out.count(overlap);
  }
  if (!box.periodic()) push_from_walls(box, centres, radii, out);
}

}  // namespace

PushingReport push_apart(const PackingBox& box, std::span<const double> radii, const PushingOptions& options,
                         PairFinder& finder, std::vector<Vec2>& centres) {
  double mean_radius = 0, mean_square = 0;
  for (const double radius : radii) mean_radius += radius, mean_square += radius * radius;
  const auto count = static_cast<double>(radii.size());
  mean_radius /= count;
  mean_square /= count;
  std::vector<Vec2> weights(radii.size());
  for (std::size_t k = 0; k < radii.size(); ++k)
    weights[k] = (radii[k] * radii[k] / mean_square * mean_radius) * options.weight;

  // Time in units of sqrt(m/k) = 1.
  constexpr double first_step = 0.1, longest_step = 0.6, keep = 0.1, shrink = 0.99;
  constexpr int patience = 5;
  const double margin = 0.3 * mean_radius, longest_way = 0.1 * mean_radius;
  double step = first_step, mixing = keep, moved = 0;
  int downhill = 0;
  std::vector<Vec2> velocities(radii.size());
  Forces forces;
  PushingReport report;
  const std::vector<DiscPair>* pairs = &finder.within(box, centres, radii, margin);
  for (;;) {
    evaluate(box, centres, radii, *pairs, weights, forces);
    ++report.evaluations;
    if (report.evaluations % 16 == 0) stop_if_interrupted();
    double residual = 0, power = 0, speed2 = 0, force2 = 0;
    for (std::size_t k = 0; k < velocities.size(); ++k) {
      const double f2 = dot(forces.force[k], forces.force[k]);
      residual += std::sqrt(f2);
      force2 += f2;
      power += dot(forces.force[k], velocities[k]);
      speed2 += dot(velocities[k], velocities[k]);
    }
    const double contacts = static_cast<double>(std::max<std::int64_t>(forces.contacts, 1));
    report.largest_overlap = forces.largest / mean_radius;
    report.mean_overlap = forces.sum / contacts / mean_radius;
    report.unbalanced = forces.sum > 0 ? residual / count / (forces.sum / contacts) : 0;
    const bool weightless = options.weight == Vec2{};
    report.apart = weightless && report.largest_overlap <= options.overlap;
    report.balanced = forces.sum > 0 && report.unbalanced <= options.unbalanced;
    if (report.apart || report.balanced || report.evaluations >= options.most) return report;

    if (power > 0) {
      if (++downhill > patience) {
        step = std::min(1.1 * step, longest_step);
        mixing *= shrink;
      }
    } else {
      downhill = 0;
      step *= 0.5;
      mixing = keep;
      std::fill(velocities.begin(), velocities.end(), Vec2{});
      speed2 = 0;
    }
    const double turn = force2 > 0 ? mixing * std::sqrt(speed2 / force2) : 0;
    double fastest2 = 0;
    for (std::size_t k = 0; k < velocities.size(); ++k) {
      velocities[k] = (1 - mixing) * velocities[k] + (turn + step) * forces.force[k];
      fastest2 = std::max(fastest2, dot(velocities[k], velocities[k]));
    }
    double way = std::sqrt(fastest2) * step;
    double scale = step;
    if (way > longest_way) {
      scale *= longest_way / way;
      way = longest_way;
    }
    for (std::size_t k = 0; k < centres.size(); ++k) centres[k] += scale * velocities[k];
    moved += way;
    if (2 * moved > margin) {
      if (box.periodic()) {
        for (Vec2& x : centres) {
          x.x -= box.size.x * std::floor(x.x / box.size.x);
          x.y -= box.size.y * std::floor(x.y / box.size.y);
        }
      }
      pairs = &finder.within(box, centres, radii, margin);
      moved = 0;
    }
  }
}

}  // namespace equidem
