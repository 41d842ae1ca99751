// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Stress, velocity, density and contacts of bodies as fields on a coarse grid.
///
/// Mean stress of a rectangle.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/body_contact.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/scene/clipped_area.hpp"

namespace equidem {

/// A rectangle in equal cells, row by row from below; none where there is nothing to measure.
struct CoarseGrid {
  Rectangle region;  ///< m
  std::size_t columns = 1, rows = 1;

  [[nodiscard]] std::size_t size() const { return columns * rows; }
  [[nodiscard]] Vec2 cell_size() const {
    return {(region.high.x - region.low.x) / static_cast<double>(columns),
            (region.high.y - region.low.y) / static_cast<double>(rows)};
  }
  [[nodiscard]] Rectangle cell(std::size_t k) const;
};

/// A grid over a region whose cells are about `width` wide and high.
/// \throws Error (bad_input) on a region without area, a width that is not positive, more than a million cells
CoarseGrid grid_over(const Rectangle& region, double width);

/// One value for each cell.
struct CoarseFields {
  CoarseGrid grid;
  /// Love and Weber's, s = (1/A) sum of F (x) l, tension positive, Pa: F is the force on body i, l the part of the way
  /// from i to j (or to the wall) that lies in the cell. Over all cells it adds up to the stress of the whole; motion
  /// adds nothing to it.
  std::vector<Tensor2> stress;
  std::vector<double> solid_fraction;  ///< exact areas
  std::vector<double> coordination;    ///< contacts and bonds of a body with its centre in the cell; NaN: there is none
  std::vector<Vec2> velocity;          ///< m/s, mean by mass over these bodies; NaN: there is none
};

/// \param contacts with the forces of the last step, and bonds
CoarseFields coarse_fields(std::span<const Grain> grains, std::span<const Clump> clumps,
                           std::span<const BodyContact> contacts, const CoarseGrid& grid);

/// Love and Weber's mean stress s = (1/A) sum of F (x) l over a rectangle of area A, tension positive, Pa: F is the
/// force on a body, l the part inside of the way from its centre to the contact. Rectangles that make up a larger one
/// add up to its stress times its area. A force is spread along its way, so that a stress that changes over the
/// rectangle is read to about the diameter of a body. Motion adds nothing to it.
/// \param bodies whose ways count
/// \param places of all bodies
Tensor2 region_stress(const Rectangle& region, std::span<const std::int32_t> bodies, std::span<const DiscMotion> places,
                      std::span<const BodyContact> contacts);

}  // namespace equidem
