// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/packing/measures.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/packing/overlaps.hpp"

namespace equidem {
namespace {

constexpr double touching_gap = 1e-8;  // of the smaller radius

/// Signed area that the circle around the origin shares with the triangle (0, a, b).
double sector_or_triangle(Vec2 a, Vec2 b, double radius) {
  const auto sector = [&](Vec2 from, Vec2 to) {
    return 0.5 * radius * radius * std::atan2(cross(from, to), dot(from, to));
  };
  const Vec2 way = b - a;
  const double length2 = dot(way, way);
  if (!(length2 > 0)) return 0;
  // The circle is entered and left at a + t way.
  const double middle = -dot(a, way) / length2;
  const double square = middle * middle - (dot(a, a) - radius * radius) / length2;
  if (square <= 0) return sector(a, b);
  const double half = std::sqrt(square), first = middle - half, last = middle + half;
  if (last <= 0 || first >= 1) return sector(a, b);
  const Vec2 in = a + std::max(first, 0.0) * way, out = a + std::min(last, 1.0) * way;
  double area = 0.5 * cross(in, out);
  if (first > 0) area += sector(a, in);
  if (last < 1) area += sector(out, b);
  return area;
}

double mean_diameter(const DiscPacking& packing) {
  return 2 * std::accumulate(packing.radii.begin(), packing.radii.end(), 0.0) / static_cast<double>(packing.size());
}

/// The lowest top of all columns.
double lowest_surface(const DiscPacking& packing) {
  const double width = 4 * *std::max_element(packing.radii.begin(), packing.radii.end());
  const auto columns = std::max<std::size_t>(1, static_cast<std::size_t>(packing.box.size.x / width));
  std::vector<double> tops(columns, 0);
  for (std::size_t k = 0; k < packing.size(); ++k) {
    const double share = std::clamp(packing.centres[k].x / packing.box.size.x, 0.0, 1.0);
    double& top = tops[std::min(columns - 1, static_cast<std::size_t>(share * static_cast<double>(columns)))];
    top = std::max(top, packing.centres[k].y + packing.radii[k]);
  }
  return *std::min_element(tops.begin(), tops.end());
}

void add_wall_contacts(const DiscPacking& packing, std::vector<PackingContact>& contacts) {
  const Vec2 size = packing.box.size;
  const bool lid = packing.box.sides == PackingBox::Sides::walls;
  for (std::size_t k = 0; k < packing.size(); ++k) {
    const Vec2 x = packing.centres[k];
    const double gaps[] = {x.y, x.x, size.x - x.x, lid ? size.y - x.y : INFINITY};
    for (int w = 0; w < 4; ++w) {
      const double overlap = packing.radii[k] - gaps[w];
      if (overlap >= -touching_gap * packing.radii[k])
        contacts.push_back({static_cast<std::int32_t>(k), ~w, 0, 0, overlap});
    }
  }
}

}  // namespace

double clipped_area(Vec2 centre, double radius, const Region& region) {
  const Vec2 a = region.low - centre, c = region.high - centre;
  const Vec2 corners[] = {a, {c.x, a.y}, c, {a.x, c.y}};
  double area = 0;
  for (int k = 0; k < 4; ++k) area += sector_or_triangle(corners[k], corners[(k + 1) % 4], radius);
  return area;
}

std::vector<PackingContact> contacts_of(const DiscPacking& packing) {
  std::vector<PackingContact> contacts;
  const double largest = *std::max_element(packing.radii.begin(), packing.radii.end());
  PairFinder finder;
  for (const DiscPair& pair : finder.within(packing.box, packing.centres, packing.radii, touching_gap * largest)) {
    const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j);
    const double overlap =
        packing.radii[i] + packing.radii[j] - norm(packing.centres[j] + pair.shift - packing.centres[i]);
    if (overlap < -touching_gap * std::min(packing.radii[i], packing.radii[j])) continue;
    const auto whole = [](double shift, double period) {
      return period > 0 ? static_cast<std::int32_t>(std::lround(shift / period)) : 0;
    };
    contacts.push_back(
        {pair.i, pair.j, whole(pair.shift.x, packing.box.size.x), whole(pair.shift.y, packing.box.size.y), overlap});
  }
  if (!packing.box.periodic()) add_wall_contacts(packing, contacts);
  return contacts;
}

Region measured_region(const DiscPacking& packing) {
  const Vec2 size = packing.box.size;
  const Region whole = {{0, 0}, size};
  if (packing.box.periodic()) return whole;
  const double diameter = mean_diameter(packing);
  const bool open = packing.box.sides == PackingBox::Sides::open_top;
  const double top = open ? lowest_surface(packing) - 3 * diameter : size.y - 2 * diameter;
  const Region region = {{2 * diameter, 2 * diameter}, {size.x - 2 * diameter, top}};
  const bool large = region.high.x - region.low.x > 2 * diameter && region.high.y - region.low.y > 2 * diameter;
  return large ? region : whole;
}

PackingMeasures measure(const DiscPacking& packing, std::optional<Region> region) {
  PackingMeasures result;
  result.region = region ? *region : measured_region(packing);
  const Vec2 sides = result.region.high - result.region.low;
  if (!(sides.x > 0 && sides.y > 0)) {
    bad_input(format("the region measured is {} m wide and {} m high", sides.x, sides.y), "it has no area",
              "Give its lower left corner first");
  }
  double covered = 0;
  if (packing.box.periodic() && !region) {
    covered = area_of_discs(packing.radii);
  } else {
    for (std::size_t k = 0; k < packing.size(); ++k)
      covered += clipped_area(packing.centres[k], packing.radii[k], result.region);
  }
  result.solid_fraction = covered / result.region.area();
  result.porosity = 1 - result.solid_fraction;
  result.void_ratio = result.porosity / result.solid_fraction;

  const auto contacts = contacts_of(packing);
  std::vector<std::vector<std::int32_t>> partners(packing.size());
  for (const PackingContact& contact : contacts) {
    const auto i = static_cast<std::size_t>(contact.i);
    partners[i].push_back(contact.j);
    double smaller = packing.radii[i];
    if (contact.j >= 0) {
      partners[static_cast<std::size_t>(contact.j)].push_back(contact.i);
      smaller = std::min(smaller, packing.radii[static_cast<std::size_t>(contact.j)]);
      ++result.contacts;
    } else {
      ++result.wall_contacts;
    }
    result.largest_overlap = std::max(result.largest_overlap, contact.overlap / smaller);
  }
  // Two contacts carry a disc that lies under its weight; without weight and friction three are needed.
  const std::size_t needed = packing.box.sides == PackingBox::Sides::open_top ? 2 : 3;
  std::vector<std::size_t> held(packing.size());
  std::vector<std::int32_t> loose;
  std::size_t ends = 0;
  for (std::size_t k = 0; k < held.size(); ++k) {
    held[k] = partners[k].size();
    ends += held[k];
    if (held[k] < needed) loose.push_back(static_cast<std::int32_t>(k));
  }
  result.coordination = static_cast<double>(ends) / static_cast<double>(held.size());
  std::vector<char> out(held.size(), 0);
  while (!loose.empty()) {
    const auto k = static_cast<std::size_t>(loose.back());
    loose.pop_back();
    if (out[k]) continue;
    out[k] = 1;
    ++result.rattlers;
    for (const std::int32_t other : partners[k]) {
      if (other < 0) continue;
      const auto j = static_cast<std::size_t>(other);
      if (!out[j] && --held[j] < needed) loose.push_back(other);
    }
  }
  ends = 0;
  for (std::size_t k = 0; k < held.size(); ++k) ends += out[k] ? 0 : held[k];
  const auto rest = static_cast<std::int64_t>(held.size()) - result.rattlers;
  result.coordination_without_rattlers = rest > 0 ? static_cast<double>(ends) / static_cast<double>(rest) : 0;
  return result;
}

}  // namespace equidem
