// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/cell/periodic_images.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/neighbours/part_pairs.hpp"

namespace equidem {
namespace {

std::vector<ImagedContact> contacts_with_images(const GrainSystem& system) {
  std::vector<ImagedContact> found;
  const auto add = [&](const Candidate& candidate, const PartPair& parts) {
    ImagedContact& imaged = found.emplace_back(ImagedContact{candidate, parts, {candidate.j}});
    if (!system.is_image(candidate.j)) return;
    imaged.image = system.image(candidate.j);
    imaged.contact.j = imaged.image.body;
    if (!system.shapes.parts.empty()) imaged.parts.j = system.own_part(parts.j);
  };
  for (const PairBlock& block : system.contacts.near.blocks)
    for (std::size_t p = 0; p < block.count; ++p)
      if (block.touching(p))
        add(candidate_of(system, block, p), parts_of_discs(system, block.first(p), block.second(p)));
  each_list_of_parts(system.contacts.near_parts, [&](const NearParts::List& list) {
    for (std::size_t p = 0; p < list.count; ++p) {
      if (!list.touching(p)) continue;
      const auto [candidate, parts] = candidate_of(system, list, p);
      add(candidate, parts);
    }
  });
  return found;
}

/// The shapes of the images behind those of the bodies.
void list_images_of_shapes(GrainSystem& system) {
  Shapes& shapes = system.shapes;
  if (shapes.parts.empty()) return;
  const std::size_t bodies = system.bodies.constants.size();
  const auto own_parts = static_cast<std::size_t>(shapes.first_part[bodies]);
  shapes.first_part.resize(bodies + 1);
  shapes.parts.resize(own_parts);
  shapes.body_of_part.resize(own_parts);
  shapes.axes.resize(bodies + system.cell.images.size());
  for (std::size_t k = 0; k < system.cell.images.size(); ++k) {
    const auto body = static_cast<std::size_t>(system.cell.images[k].body);
    for (auto part = static_cast<std::size_t>(shapes.first_part[body]);
         part < static_cast<std::size_t>(shapes.first_part[body + 1]); ++part) {
      shapes.parts.push_back(GrainPart(shapes.parts[part]));
      shapes.body_of_part.push_back(static_cast<std::int32_t>(bodies + k));
    }
    shapes.first_part.push_back(static_cast<std::int32_t>(shapes.parts.size()));
  }
  turn_images(system);
  NearParts& near = system.contacts.near_parts;
  if (!near.active) return;
  near.bodies.resize(shapes.parts.size());
  near.met.resize(shapes.parts.size());
}

}  // namespace

Periods periods_of(const PeriodicCell& cell) {
  const bool rows = cell.along == PeriodicCell::Along::xy;
  return {{cell.width, 0}, rows ? Vec2{cell.shift, cell.height} : Vec2{}};
}

PeriodicImage image_inside(const Periods& periods, Vec2 centre, Vec2 position) {
  PeriodicImage image;
  if (periods.b.y > 0) image.b = static_cast<std::int32_t>(-std::floor((position.y - centre.y) / periods.b.y + 0.5));
  const double x = position.x + image.b * periods.b.x - centre.x;
  image.a = static_cast<std::int32_t>(-std::floor(x / periods.a.x + 0.5));
  return image;
}

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

void list_contacts(GrainSystem& system, const std::vector<ImagedContact>& contacts) {
  std::vector<Circle> circles;
  for (std::size_t k = 0; k < system.bodies.constants.size(); ++k)
    circles.push_back({system.bodies.motions[k].position, system.bodies.constants[k].radius});
  MovingCell& cell = system.cell;
  cell.images = images_near(circles, cell.now, system.contacts.margin);
  if (system.contacts.near.active) system.contacts.near.bodies.resize(circles.size() + cell.images.size());
  list_images_of_shapes(system);
  std::vector<Candidate> discs;
  std::vector<std::pair<Candidate, PartPair>> parts;
  for (const auto& [contact, pair, image] : contacts) {
    Candidate again = contact;
    PartPair pair_again = pair;
    if (image.a != 0 || image.b != 0) {
      const auto place = std::ranges::lower_bound(cell.images, image);
      if (place == cell.images.end() || *place != image)
        bad_input("the state has a contact with an image that is far away", "it is of another scene, or damaged",
                  "Resume with the scene that the state was saved from");
      again.j = static_cast<std::int32_t>(circles.size()) + static_cast<std::int32_t>(place - cell.images.begin());
      if (!system.shapes.parts.empty())
        pair_again.j += system.shapes.first_part[static_cast<std::size_t>(again.j)] -
                        system.shapes.first_part[static_cast<std::size_t>(contact.j)];
    }
    if (are_discs(system, contact.i, contact.j)) {
      discs.push_back(again);
    } else {
      parts.emplace_back(again, pair_again);
    }
  }
  std::ranges::sort(discs, {}, [](const Candidate& contact) { return std::pair(contact.i, contact.j); });
  if (system.contacts.near.active) take_near_pairs(system, discs);
  if (system.contacts.near_parts.active) take_near_parts(system, std::move(parts));
}

void find_images(GrainSystem& system) {
  list_contacts(system, contacts_with_images(system));
}

void turn_images(GrainSystem& system) {
  if (system.shapes.parts.empty()) return;
  const std::size_t bodies = system.bodies.constants.size();
  for (std::size_t k = 0; k < system.cell.images.size(); ++k)
    system.shapes.axes[bodies + k] = system.shapes.axes[static_cast<std::size_t>(system.cell.images[k].body)];
}

void place_images(GrainSystem& system) {
  const MovingCell& cell = system.cell;
  const std::size_t count = system.bodies.constants.size();
  NearPairs& pairs = system.contacts.near;
  NearParts& near_parts = system.contacts.near_parts;
  system.bodies.blocks.each_piece(cell.images.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const PeriodicImage& image = cell.images[k];
      const Vec2 shift = cell.now.shift(image);
      const Vec2 apart = cell.deforms ? cell.gradient * cell.before.shift(image) : Vec2{};
      if (pairs.active) {
        PairBody& seen = pairs.bodies[count + k];
        seen = pairs.bodies[static_cast<std::size_t>(image.body)];
        seen.position += shift;
        seen.velocity += apart;
        seen.middle_velocity += apart;
      }
      if (!near_parts.active) continue;
      const auto own = static_cast<std::size_t>(system.shapes.first_part[static_cast<std::size_t>(image.body)]);
      const auto first = static_cast<std::size_t>(system.shapes.first_part[count + k]),
                 last = static_cast<std::size_t>(system.shapes.first_part[count + k + 1]);
      for (std::size_t part = first; part < last; ++part) {
        if (near_parts.met[part] == 0) continue;
        PartBody& seen = near_parts.bodies[part];
        seen = near_parts.bodies[own + (part - first)];
        seen.centre += shift;
        seen.velocity += apart;
        seen.middle_velocity += apart;
      }
    }
  });
}

void wrap_bodies(GrainSystem& system) {
  MovingCell& cell = system.cell;
  std::vector<ImagedContact> contacts = contacts_with_images(system);
  const auto columns = static_cast<std::int32_t>(std::nearbyint(cell.now.b.x / cell.now.a.x));
  bool changed = columns != 0;
  if (columns != 0) {
    // the period b less some of a: a multiple of b is the same of the new one, and so many a more
    cell.now.b.x -= columns * cell.now.a.x;
    cell.before.b.x -= columns * cell.before.a.x;
    for (ImagedContact& imaged : contacts) imaged.image.a += columns * imaged.image.b;
    for (PeriodicImage& crossed : cell.crossed) crossed.a += columns * crossed.b;
  }
  std::vector<PeriodicImage> moves(system.bodies.motions.size());
  for (std::size_t k = 0; k < moves.size(); ++k) {
    Vec2& position = system.bodies.motions[k].position;
    const PeriodicImage move = moves[k] = image_inside(cell.now, cell.centre, position);
    if (move.a == 0 && move.b == 0) continue;
    changed = true;
    position += cell.now.shift(move);
    cell.crossed[k].a -= move.a;
    cell.crossed[k].b -= move.b;
    if (system.contacts.near.active) system.contacts.near.bodies[k].position = position;
  }
  cell.next = cell.now;
  if (!changed) return;
  find_images_of_bonds(system);
  if (!system.meets_images()) return find_candidates(system);
  for (ImagedContact& imaged : contacts) {
    const PeriodicImage &i = moves[static_cast<std::size_t>(imaged.contact.i)],
                        &j = moves[static_cast<std::size_t>(imaged.contact.j)];
    imaged.image.a += i.a - j.a;
    imaged.image.b += i.b - j.b;
  }
  list_contacts(system, contacts);
  find_candidates(system);
}

}  // namespace equidem
