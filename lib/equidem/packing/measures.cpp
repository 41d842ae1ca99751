// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/packing/measures.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/packing/outline.hpp"

namespace equidem {
namespace {

constexpr double touching_gap = 1e-8;  // of the smaller radius

/// Inverse of the distance from a point that lies `sunk` below the surface to the centre of curvature of the place that
/// reaches farthest along n.
double curvature(const Ellipse& part, Vec2 n, double sunk) {
  return 1 / (support(part, n).radius - sunk);
}

double radius_of(const GrainPacking& packing, std::int32_t grain) {
  return packing.radii[packing.body_of(static_cast<std::size_t>(grain))];
}

}  // namespace

std::vector<char> rattlers_of(const std::vector<std::vector<std::int32_t>>& partners, std::size_t needed) {
  std::vector<std::size_t> left;
  std::vector<std::int32_t> loose;
  for (std::size_t k = 0; k < partners.size(); ++k) {
    left.push_back(partners[k].size());
    if (left[k] < needed) loose.push_back(static_cast<std::int32_t>(k));
  }
  std::vector<char> out(partners.size(), 0);
  while (!loose.empty()) {
    const auto k = static_cast<std::size_t>(loose.back());
    loose.pop_back();
    if (out[k]) continue;
    out[k] = 1;
    for (const std::int32_t other : partners[k]) {
      const auto j = static_cast<std::size_t>(other);
      if (other >= 0 && !out[j] && --left[j] < needed) loose.push_back(other);
    }
  }
  return out;
}

std::vector<PackingContact> contacts_of(const GrainPacking& packing, double gap_tolerance) {
  std::vector<PackingContact> contacts;
  std::vector<Outline> outlines;
  std::vector<Circle> circles;
  for (const Grain& grain : packing.grains) {
    outlines.push_back(outline_of(grain, packing.clumps));
    circles.push_back({grain.position, grain.radius});
  }
  const auto gap_of = [&](double r, double s) {
    return std::max(touching_gap * std::min(r, s), gap_tolerance * (r + s));
  };
  const double largest = *std::max_element(packing.radii.begin(), packing.radii.end());
  const double margin = gap_of(largest, largest);
  for (const CirclePair& pair : pairs_within(circles, packing.box.periods(), margin)) {
    const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j.body);
    if (i == j || (packing.body_of(i) == packing.body_of(j) && pair.shift == Vec2{})) continue;
    const Vec2 branch = circles[j].centre + pair.shift - circles[i].centre;
    const double gap = gap_of(radius_of(packing, pair.i), radius_of(packing, pair.j.body));
    for_touches(outlines[i], outlines[j], branch, gap, [&](const Touch& touch) {
      // Midway between the points of the two surfaces, then nearer to the smaller one.
      const Vec2 middle = 0.5 * (touch.arm_i + touch.arm_j + branch);
      const double sunk_i = touch.share * touch.overlap, sunk_j = touch.overlap - sunk_i;
      contacts.push_back({pair.i, pair.j.body, pair.j.a, pair.j.b, touch.overlap, touch.normal,
                          middle + (0.5 - touch.share) * touch.overlap * touch.normal,
                          curvature(outlines[i].part(touch.part_i), touch.normal, sunk_i),
                          curvature(outlines[j].part(touch.part_j), -touch.normal, sunk_j)});
    });
  }
  for (std::size_t k = 0; k < circles.size(); ++k) {
    const auto grain = static_cast<std::int32_t>(k);
    for_wall_touches(outlines[k], circles[k].centre, packing.box,
                     std::max(touching_gap, gap_tolerance) * radius_of(packing, grain),
                     [&](int wall, const Touch& touch) {
                       contacts.push_back({grain, ~wall, 0, 0, touch.overlap, touch.normal,
                                           touch.arm_i - touch.overlap * touch.normal,
                                           curvature(outlines[k].part(touch.part_i), touch.normal, touch.overlap), 0});
                     });
  }
  return contacts;
}

std::vector<BondCount> bond_counts(const GrainPacking& packing) {
  std::vector<double> gaps;
  for (const PackingContact& contact : contacts_of(packing, largest_counted_gap)) {
    if (contact.j < 0) continue;
    const double r = radius_of(packing, contact.i), s = radius_of(packing, contact.j);
    gaps.push_back(-contact.overlap <= touching_gap * std::min(r, s) ? 0 : -contact.overlap / (r + s));
  }
  return bond_counts(gaps, packing.size());
}

Rectangle measured_region(const GrainPacking& packing) {
  const Rectangle whole = {{0, 0}, packing.box.size};
  if (packing.box.periodic()) return whole;
  const GrainBox box{.inside = whole, .lid = packing.box.sides != PackingBox::Sides::open_top};
  return measured_region(packing.grains, packing.clumps, box).value_or(whole);
}

namespace {

/// Area of the bodies, m²; in a periodic box also of the images that reach in across its sides.
double covered_area(const GrainPacking& packing, const Rectangle& region) {
  const int images = packing.box.periodic() ? 1 : 0;
  double covered = 0;
  for (int y = -images; y <= images; ++y) {
    for (int x = -images; x <= images; ++x) {
      const Vec2 shift = {x * packing.box.size.x, y * packing.box.size.y};
      covered += clipped_area(packing.grains, packing.clumps, {region.low - shift, region.high - shift});
    }
  }
  return covered;
}

}  // namespace

void check_region(const PackingBox& box, const Rectangle& region) {
  const Vec2 size = box.size, sides = region.high - region.low;
  if (!(sides.x > 0 && sides.y > 0)) {
    bad_input(fmt::format("the region measured is {} m wide and {} m high", sides.x, sides.y), "it has no area",
              "Give its lower left corner first");
  }
  const bool inside = region.low.x >= 0 && region.low.y >= 0 && region.high.x <= size.x && region.high.y <= size.y;
  if (box.periodic() && !inside) {
    bad_input("the region measured reaches out of the periodic box",
              fmt::format("the box is {:.6g} m by {:.6g} m, from the origin", size.x, size.y), "Give one within it");
  }
}

PackingMeasures measure(const GrainPacking& packing, std::optional<Rectangle> region) {
  PackingMeasures result;
  result.region = region ? *region : measured_region(packing);
  check_region(packing.box, result.region);
  double covered = 0;
  if (packing.box.periodic() && !region) {
    for (const Grain& grain : packing.grains) covered += area_of(grain, packing.clumps);
  } else {
    covered = covered_area(packing, result.region);
  }
  if (region && !(covered > 0)) {
    bad_input("no body reaches into the region measured", "it has no void ratio", "Give one that holds some bodies");
  }
  static_cast<SolidMeasures&>(result) = solid_measures(covered, result.region);

  std::vector<std::vector<std::int32_t>> partners(packing.size());
  for (const PackingContact& contact : contacts_of(packing)) {
    const std::size_t i = packing.body_of(static_cast<std::size_t>(contact.i));
    double smaller = packing.radii[i];
    if (contact.j >= 0) {
      const std::size_t j = packing.body_of(static_cast<std::size_t>(contact.j));
      partners[i].push_back(static_cast<std::int32_t>(j));
      partners[j].push_back(static_cast<std::int32_t>(i));
      smaller = std::min(smaller, packing.radii[j]);
      ++result.contacts;
    } else {
      partners[i].push_back(contact.j);
      ++result.wall_contacts;
    }
    result.largest_overlap = std::max(result.largest_overlap, contact.overlap / smaller);
  }
  // Two contacts carry a body that lies under its weight; without weight and friction three are needed.
  const std::vector<char> rattles = rattlers_of(partners, packing.box.sides == PackingBox::Sides::open_top ? 2 : 3);
  result.rattlers = std::count(rattles.begin(), rattles.end(), 1);
  double ends = 0, ends_without_rattlers = 0;
  for (std::size_t k = 0; k < partners.size(); ++k) {
    ends += static_cast<double>(partners[k].size());
    if (rattles[k]) continue;
    ends_without_rattlers +=
        static_cast<double>(std::count_if(partners[k].begin(), partners[k].end(), [&](std::int32_t other) {
          return other < 0 || !rattles[static_cast<std::size_t>(other)];
        }));
  }
  const double count = static_cast<double>(partners.size()), rest = count - static_cast<double>(result.rattlers);
  result.coordination = ends / count;
  result.coordination_without_rattlers = rest > 0 ? ends_without_rattlers / rest : 0;
  return result;
}

}  // namespace equidem
