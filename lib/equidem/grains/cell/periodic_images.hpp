// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Images of the bodies of a periodic cell, which the loops over pairs and over parts take for bodies.
///
/// A pair of i and an image of j is listed once, for i < j, the image as a body with a number behind those of all
/// bodies, its parts behind all parts. Its impulse goes to the place for a body of a later block and from there to j.
/// Loops and scenes without a cell do not change by it.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/geometry/neighbours.hpp"

namespace equidem {

struct GrainSystem;
struct ContactState;
struct PeriodicCell;

Periods periods_of(const PeriodicCell& cell);

/// Whether a contact is one of near pairs or parts, not of candidates.
bool is_listed(const GrainSystem& system, const ContactState& contact);
/// Find the images again, and replace the near pairs and parts by contacts, in any order; those with walls are not
/// read.
void list_contacts(GrainSystem& system, const std::vector<ContactState>& contacts);

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
