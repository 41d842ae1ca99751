// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Images of the bodies of a periodic cell, which the loops over pairs and over parts take for bodies.
///
/// A pair of i and an image of j is listed once, for i < j, the image as a body with a number behind those of all
/// bodies, its parts behind all parts. Its impulse goes to the place for a body of a later block and from there to j.
/// Loops and scenes without a cell do not change by it.
#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "equidem/core/vector.hpp"
#include "equidem/grains/neighbours/neighbours.hpp"

namespace equidem {

struct GrainSystem;
struct ImagedContact;
struct PeriodicCell;

/// A body moved by a whole number of each period.
struct PeriodicImage {
  std::int32_t body = 0;
  std::int32_t b = 0, a = 0;  ///< along y, along x
  auto operator<=>(const PeriodicImage&) const = default;
};

struct Periods {
  Vec2 a, b;  ///< a along x; b = {} without a period along y
  [[nodiscard]] Vec2 shift(const PeriodicImage& image) const {
    return static_cast<double>(image.a) * a + static_cast<double>(image.b) * b;
  }
};

Periods periods_of(const PeriodicCell& cell);

/// The image of a body in the cell around a centre: body 0, and the periods by which it is moved into the cell.
PeriodicImage image_inside(const Periods& periods, Vec2 centre, Vec2 position);

/// All images that come near a body or could: those nearer to the box of all centres than their radius, the largest
/// radius and the margin together. Ascending.
std::vector<PeriodicImage> images_near(std::span<const Circle> circles, const Periods& periods, double margin);

/// Find the images again, and replace the near pairs and parts by contacts.
void list_contacts(GrainSystem& system, const std::vector<ImagedContact>& contacts);

/// Find the images again for the present margin of the candidates; contacts keep their state.
void find_images(GrainSystem& system);

/// Move the images to where their bodies are, for the loops.
void place_images(GrainSystem& system);
/// Turn those of ellipses and clumps as their bodies.
void turn_images(GrainSystem& system);

/// Steps after which bodies that have left the cell are taken as their images inside. That depends on the step alone: a
/// resumed run does the same.
constexpr std::int64_t steps_between_wraps = 256;

/// Take each body as its image in the cell, and the period along y as the one of least shift. Candidates are found
/// anew.
void wrap_bodies(GrainSystem& system);

}  // namespace equidem
