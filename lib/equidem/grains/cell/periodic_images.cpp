// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/cell/periodic_images.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/neighbours/near_parts.hpp"

namespace equidem {
namespace {

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

bool is_listed(const GrainSystem& system, const ContactState& contact) {
  if (contact.j < 0) return false;
  return are_discs(system, contact.i, contact.j) ? system.contacts.near.active : system.contacts.near_parts.active;
}

void list_contacts(GrainSystem& system, const std::vector<ContactState>& contacts) {
  const std::size_t count = system.bodies.constants.size();
  std::vector<PeriodicImage>& images = system.cell.images;
  if (system.meets_images()) {
    std::vector<Circle> circles;
    for (std::size_t k = 0; k < count; ++k)
      circles.push_back({system.bodies.motions[k].position, system.bodies.constants[k].radius});
    images = images_near(circles, system.cell.now, system.contacts.margin);
    if (system.contacts.near.active) system.contacts.near.bodies.resize(count + images.size());
    list_images_of_shapes(system);
  }
  std::vector<ContactState> discs, parts;
  for (ContactState contact : contacts) {
    if (!is_listed(system, contact)) continue;
    std::vector<ContactState>& list = are_discs(system, contact.i, contact.j) ? discs : parts;
    if (contact.a != 0 || contact.b != 0) {
      const auto place = std::ranges::lower_bound(images, PeriodicImage{contact.j, contact.b, contact.a});
      if (place == images.end() || *place != PeriodicImage{contact.j, contact.b, contact.a})
        bad_input("the state has a contact with an image that is far away", "it is of another scene, or damaged",
                  "Resume with the scene that the state was saved from");
      const auto image = static_cast<std::int32_t>(count) + static_cast<std::int32_t>(place - images.begin());
      if (!system.shapes.parts.empty())
        contact.part_j += system.shapes.first_part[image] - system.shapes.first_part[contact.j];
      contact.j = image;
    }
    list.push_back(contact);
  }
  if (system.contacts.near.active) take_near_pairs(system, std::move(discs));
  if (system.contacts.near_parts.active) take_near_parts(system, std::move(parts));
}

void find_images(GrainSystem& system) {
  list_contacts(system, contact_states(system));
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
  std::vector<ContactState> contacts = contact_states(system);
  const auto columns = static_cast<std::int32_t>(std::nearbyint(cell.now.b.x / cell.now.a.x));
  bool changed = columns != 0;
  if (columns != 0) {
    // the period b less some of a: a multiple of b is the same of the new one, and so many a more
    cell.now.b.x -= columns * cell.now.a.x;
    cell.before.b.x -= columns * cell.before.a.x;
    for (ContactState& contact : contacts) contact.a += columns * contact.b;
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
  for (ContactState& contact : contacts) {
    if (contact.j < 0) continue;
    contact.a += moves[contact.i].a - moves[contact.j].a;
    contact.b += moves[contact.i].b - moves[contact.j].b;
  }
  list_contacts(system, contacts);
  find_candidates(system);
}

}  // namespace equidem
