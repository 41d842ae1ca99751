// SPDX-License-Identifier: GPL-3.0-or-later

#include "equidem/packing/measures.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"
#include "equidem/packing/overlaps.hpp"

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
  const std::vector<char> heap = heap_of(packing.grains, mean_diameter(packing.grains, packing.clumps));
  return measured_region(packing.grains, packing.clumps, box, heap).value_or(whole);
}

namespace {

/// 1 for the bodies that are left out where those with fewer than `needed` contacts are removed, one after another.
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

/// Centre of mass of a body of the packing, m.
Vec2 centre_of(const GrainPacking& packing, std::size_t body) {
  if (packing.bonds.empty()) return packing.grains[body].position;
  return 0.5 * (packing.grains[2 * body].position + packing.grains[2 * body + 1].position);
}

/// From the centre of its body to that of a grain.
Vec2 place_in_body(const GrainPacking& packing, std::size_t grain) {
  if (packing.bonds.empty()) return {};
  return packing.grains[grain].position - centre_of(packing, packing.body_of(grain));
}

/// Contacts of bodies from those of grains: i and j name bodies, arms begin at their centres.
void name_bodies(const GrainPacking& packing, std::vector<PackingContact>& contacts) {
  for (PackingContact& contact : contacts) {
    const auto i = static_cast<std::size_t>(contact.i);
    contact.arm_i += place_in_body(packing, i);
    contact.i = static_cast<std::int32_t>(packing.body_of(i));
    if (contact.j >= 0) contact.j = static_cast<std::int32_t>(packing.body_of(static_cast<std::size_t>(contact.j)));
  }
}

/// Of each body, one for each contact between bodies; negative: a wall.
std::vector<std::vector<std::int32_t>> partners_in(const std::vector<PackingContact>& contacts, std::size_t bodies) {
  std::vector<std::vector<std::int32_t>> partners(bodies);
  for (const PackingContact& c : contacts) {
    partners[c.i].push_back(c.j);
    if (c.j >= 0) partners[c.j].push_back(c.i);
  }
  return partners;
}

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
  check_area(region, "region measured");
  const Vec2 size = box.size;
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

  std::vector<PackingContact> contacts = contacts_of(packing);
  name_bodies(packing, contacts);
  for (const PackingContact& contact : contacts) {
    const double smaller = std::min(packing.radii[contact.i], packing.radii[contact.j >= 0 ? contact.j : contact.i]);
    result.largest_overlap = std::max(result.largest_overlap, contact.overlap / smaller);
    ++(contact.j >= 0 ? result.contacts : result.wall_contacts);
  }
  const std::vector<std::vector<std::int32_t>> partners = partners_in(contacts, packing.size());
  // Two contacts carry a body that lies under its weight; without weight and friction three are needed.
  const std::vector<char> rattles = rattlers_of(partners, packing.box.sides == PackingBox::Sides::open_top ? 2 : 3);
  result.rattlers = std::count(rattles.begin(), rattles.end(), 1);
  double ends = 0, ends_without_rattlers = 0;
  for (std::size_t k = 0; k < partners.size(); ++k) {
    ends += static_cast<double>(partners[k].size());
    if (rattles[k]) continue;
    ends_without_rattlers += static_cast<double>(std::count_if(
        partners[k].begin(), partners[k].end(), [&](std::int32_t other) { return other < 0 || !rattles[other]; }));
  }
  const double count = static_cast<double>(partners.size()), rest = count - static_cast<double>(result.rattlers);
  result.coordination = ends / count;
  result.coordination_without_rattlers = rest > 0 ? ends_without_rattlers / rest : 0;
  return result;
}

namespace {

/// Bodies that fell carry the forces with which they came to rest; bodies that jammed -kN times the overlap, N/m, for
/// forces of equal springs balance there. Other packings carry none, for their overlaps balance nothing.
/// \param contacts of contacts_of(packing)
/// \param springs of every contact; none: of jammed bodies no forces are known
/// \return one for each contact, on its i (tension positive), or empty
std::vector<ContactForce> carried_forces(const GrainPacking& packing, const std::vector<PackingContact>& contacts,
                                         const std::optional<SpringConstants>& springs) {
  std::vector<ContactForce> forces;
  if (packing.contacts.empty()) {
    if (!packing.jammed || !springs) return forces;
    for (const PackingContact& contact : contacts) forces.push_back({-springs->kN * std::max(contact.overlap, 0.0), 0});
    return forces;
  }
  struct Settled {
    ContactForce force;  // neither component changes where i and j change places
    Vec2 arm;            // of the first body
  };
  std::multimap<std::pair<std::int32_t, std::int32_t>, Settled> settled;
  for (const GrainContact& contact : packing.contacts) {
    const ContactForce force = {-contact.normal_force, -contact.tangential_force};
    if (contact.j >= 0 && contact.j < contact.i) {
      settled.insert({{contact.j, contact.i}, {force, contact.arm_j}});
    } else {
      settled.insert({{contact.i, contact.j}, {force, contact.arm_i}});
    }
  }
  for (const PackingContact& contact : contacts) {
    // Clumps may touch in several places: the nearest counts.
    const auto [first, last] = settled.equal_range({contact.i, contact.j});
    const auto distance = [&](const auto& entry) { return norm(entry.second.arm - contact.arm_i); };
    const auto found =
        std::min_element(first, last, [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
    forces.push_back(contact.overlap > 0 && found != last ? found->second.force : ContactForce{});
  }
  return forces;
}

/// The centre behind a wall of the body that mirrors one at the wall.
Vec2 mirrored(Vec2 centre, const HalfPlane& wall) {
  return centre - 2 * (dot(wall.normal, centre) + wall.offset) * wall.normal;
}

BodySection section_of(const GrainPacking& packing, std::size_t body) {
  BodySection section;
  const std::size_t grains = packing.bonds.empty() ? 1 : 2;
  for (std::size_t k = grains * body; k < grains * (body + 1); ++k) {
    const Grain& grain = packing.grains[k];
    const double area = area_of(grain, packing.clumps);
    const Vec2 place = place_in_body(packing, k);
    section.area += area;
    section.polar_moment += area * (grain.inertia.moment / grain.inertia.mass + dot(place, place));
  }
  return section;
}

void add_body(const GrainPacking& packing, std::size_t body, Vec2 centre, Assembly& assembly) {
  assembly.centres.push_back(centre);
  if (packing.shape == PackingShape::Kind::disc) {
    assembly.radii.push_back(packing.radii[body]);
    return;
  }
  assembly.sections.push_back(section_of(packing, body));
  assembly.radii.push_back(std::sqrt(assembly.sections.back().area / std::numbers::pi));
}

/// The smallest rectangle along the walls that holds all bodies.
Rectangle outline_of_all(const GrainPacking& packing) {
  Rectangle box{.low = {INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY}};
  for (const Grain& grain : packing.grains) {
    const Outline outline = outline_of(grain, packing.clumps);
    const auto reach = [&](Vec2 direction) { return reach_along(outline, direction); };
    const Vec2 x = grain.position;
    box.low = {std::min(box.low.x, x.x - reach({-1, 0})), std::min(box.low.y, x.y - reach({0, -1}))};
    box.high = {std::max(box.high.x, x.x + reach({1, 0})), std::max(box.high.y, x.y + reach({0, 1}))};
  }
  return box;
}

/// \param found between bodies of the assembly
/// \param force that it carries at rest; null: not known
/// \param has_walls whether some contacts of the assembly are with walls, which are flat
void add_contact(PackingShape::Kind shape, const PackingContact& found, const ContactForce* force, bool has_walls,
                 const std::optional<SpringConstants>& springs, Assembly& assembly) {
  Contact contact{.i = found.i, .j = found.j, .shift_x = found.shift_x, .shift_y = found.shift_y};
  const Vec2 branch = assembly.branch(contact);
  if (shape == PackingShape::Kind::disc) {
    const double distance = norm(branch), ri = assembly.radii[contact.i];
    contact.lever_i = distance * ri / (ri + assembly.radii[contact.j]);
    contact.lever_j = distance - contact.lever_i;
  } else {
    const Vec2 n = found.normal, s = perpendicular(n), rest = branch - found.arm_i;
    const double round_off = 1e-12 * (norm(found.arm_i) + norm(rest));
    const auto offset = [&](Vec2 arm) { return std::abs(dot(arm, s)) > round_off ? dot(arm, s) : 0.0; };
    contact.lever_i = dot(found.arm_i, n);
    contact.lever_j = dot(rest, n);
    assembly.contact_arms.push_back({n, offset(found.arm_i), offset(rest)});
  }
  assembly.contacts.push_back(contact);
  if (force != nullptr) {
    assembly.contact_normal_force.push_back(force->normal);
    assembly.contact_tangential_force.push_back(force->tangential);
    if (!assembly.contact_arms.empty() || has_walls) {
      assembly.contact_curvature_i.push_back(found.curvature_i);
      assembly.contact_curvature_j.push_back(found.curvature_j);
    }
  }
  if (!springs) return;
  assembly.contact_kN.push_back(springs->kN);
  assembly.contact_kT.push_back(springs->kT);
}

/// \param walls whether contacts with walls count, as held_network_of says, and bodies that could roll are left out
HeldNetwork network(const GrainPacking& packing, const NetworkOptions& options, bool walls) {
  std::vector<PackingContact> contacts = contacts_of(packing, options.gap_tolerance);
  const std::vector<ContactForce> forces = carried_forces(packing, contacts, options.springs);
  name_bodies(packing, contacts);
  std::vector<char> left_out(packing.size(), 0);
  if (walls) left_out = rattlers_of(partners_in(contacts, packing.size()), 2);
  HeldNetwork result;
  Assembly& assembly = result.assembly;
  assembly.kind = "packing";
  if (packing.box.periodic()) assembly.period = packing.box.size;
  std::vector<std::int32_t> number(packing.size(), -1);
  for (std::size_t k = 0; k < packing.size(); ++k) {
    if (left_out[k]) continue;
    number[k] = static_cast<std::int32_t>(assembly.size());
    add_body(packing, k, centre_of(packing, k), assembly);
    result.bodies.push_back(static_cast<std::int32_t>(k));
  }
  DiscGroup at_walls;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> mirrors;  // of a body at a wall: it may touch it twice
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    PackingContact found = contacts[c];
    const auto i = static_cast<std::size_t>(found.i);
    if (left_out[i] || (found.j >= 0 ? left_out[found.j] != 0 : !walls)) continue;
    if (found.j >= 0) {
      found.j = number[found.j];
    } else {
      const auto [mirror, is_new] = mirrors.try_emplace({found.i, found.j}, static_cast<std::int32_t>(assembly.size()));
      if (is_new) {
        at_walls.discs.push_back(mirror->second);
        add_body(packing, i, mirrored(centre_of(packing, i), sides_of(packing.box)[~found.j]), assembly);
      }
      found.j = mirror->second;
    }
    found.i = number[i];
    add_contact(packing.shape, found, forces.empty() ? nullptr : &forces[c], walls, options.springs, assembly);
  }
  if (!at_walls.discs.empty()) assembly.groups["walls"] = at_walls;
  return result;
}

}  // namespace

Assembly network_of(const GrainPacking& packing, const NetworkOptions& options) {
  Assembly assembly = network(packing, options, false).assembly;
  assembly.gap_tolerance = options.gap_tolerance;
  if (!packing.box.periodic()) assembly.box = outline_of_all(packing);
  return assembly;
}

HeldNetwork held_network_of(const GrainPacking& packing, const NetworkOptions& options) {
  return network(packing, options, true);
}

}  // namespace equidem
