// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Measures of bodies in a box while they move: surface, density away from walls and surface, stress of a
/// rectangle, fields of stress, velocity, density and contacts on a coarse grid.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"
#include "equidem/motion/any_simulation.hpp"
#include "equidem/motion/wall.hpp"

namespace equidem {

/// Stands for a quantity that has no value at a moment.
inline constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();

/// \throws Error (bad_input) on a region without area, "the NAME is 0 m wide"
void check_area(const Rectangle& region, const char* name);

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

/// The highest point of the bodies in columns of equal width.
struct SurfaceProfile {
  double left = 0, width = 0;   ///< of the first column, m
  std::vector<double> heights;  ///< m; NaN: no body reaches into the column

  /// Middle of a column, m.
  [[nodiscard]] double place(std::size_t column) const { return left + width * (static_cast<double>(column) + 0.5); }
};

/// Exact for every shape: a body counts in a column with the highest point that it has there.
/// \param heap for each body: whether it is included; empty: all are
/// \param columns >= 1, of the width from left to right
SurfaceProfile surface_of(std::span<const Grain> grains, std::span<const Clump> clumps, double left, double right,
                          std::size_t columns, std::span<const char> heap = {});

/// The straight line of least squares through the heights.
struct SurfaceShape {
  double height = 0;     ///< m, mean over the columns
  double slope = 0;      ///< of the line, upwards to the right; 0 for a single column
  double roughness = 0;  ///< m, standard deviation of the heights about the line
};

/// Columns without bodies are left aside.
/// \return NaN where no column has a body
SurfaceShape shape_of(const SurfaceProfile& profile);

/// The heap: the largest set of bodies of which each lies no further than `gap` from another, surface to surface (of
/// ellipses and clumps: of the circles that hold them). \return 1 for a body of the heap \param gap >= 0, m
std::vector<char> heap_of(std::span<const Grain> grains, double gap);

/// The centre of mass of all bodies, m.
Vec2 centre_of_mass(std::span<const Grain> grains);

/// The rectangle that walls leave for bodies.
struct GrainBox {
  Rectangle inside;  ///< m; where there is no wall, as far as the bodies reach
  bool lid = false;  ///< a wall above
};

/// Lines and segments along the axes are its sides; each is on that side of the middle of all bodies on which it lies
/// at the start. \param time s, by which walls have moved
/// \throws Error (bad_input) without grains
GrainBox box_of(std::span<const Wall> walls, std::span<const Grain> grains, double time);

/// Mean diameter of circles with the areas of the bodies, m.
double mean_diameter(std::span<const Grain> grains, std::span<const Clump> clumps);

/// The box without strips of two mean diameters at its sides and, under an open top, without three below the lowest
/// place of the surface, seen in columns two largest diameters wide.
/// \param heap of each body: whether it belongs to the surface (heap_of); empty: all do
/// \return none where nothing as large as two diameters each way is left
std::optional<Rectangle> measured_region(std::span<const Grain> grains, std::span<const Clump> clumps,
                                         const GrainBox& box, std::span<const char> heap = {});

/// Solid fraction, porosity n = 1 - solid fraction, void ratio e = n/(1 - n).
struct SolidMeasures {
  double solid_fraction = 0, porosity = 0, void_ratio = 0;
};

/// \param covered area of the bodies in the region, m²
SolidMeasures solid_measures(double covered, const Rectangle& region);

struct MeasureOptions {
  std::optional<Rectangle> region = {};  ///< of the void ratio, m, where the box stands at the start; none:
                                         ///< measured_region at each moment
  std::optional<double> cell = {};       ///< width of the cells of the fields, m; none: no fields
};

/// \throws Error (bad_input), its place the name of the option: spheres, whose volumes no area of the plane tells; a
///         region without an area
void check(const MeasureOptions& options, Body body);

/// Places go with the shaking box.
struct MeasuredMoment {
  std::int64_t step = 0;
  double time = 0;  ///< s
  double void_ratio = not_measured, porosity = not_measured;
  SurfaceShape surface;      ///< of the heap
  Vec2 centre;               ///< of mass, m
  std::int64_t outside = 0;  ///< bodies with the centre beyond a side or the floor of the box
};

/// A shaking of the box in a part of a run.
struct BoxShaking {
  Shaking shaking;                                         ///< its times count from here:
  double from = 0;                                         ///< s; infinite: not known yet
  double until = std::numeric_limits<double>::infinity();  ///< s, where the box stops

  [[nodiscard]] double start() const { return from + shaking.displacement.start; }  ///< s
  [[nodiscard]] Vec2 displacement(double time) const;
};

class BoxMeasures {
 public:
  /// \param scene bodies at the start, walls and gravity; must outlive this
  /// \param shakings of the box, one after the other; none: it stands
  /// \throws Error (bad_input) as box_of, and as grid_over where the cells are too small
  BoxMeasures(const GrainScene& scene, const MeasureOptions& options, std::vector<BoxShaking> shakings = {});

  /// \param shakings as before, with the times that are known now
  void set_shakings(std::vector<BoxShaking> shakings);
  /// \param grains that are there
  /// \param walls at their places (GrainSimulation::placed_walls)
  const MeasuredMoment& record(std::int64_t step, double time, const std::vector<Grain>& grains,
                               const std::vector<Wall>& walls);
  /// Continue the history of an earlier run.
  /// \param moments at least one
  /// \param profiles of the surface at the moments
  void restore(std::vector<MeasuredMoment> moments, const std::vector<SurfaceProfile>& profiles);

  [[nodiscard]] std::size_t columns() const { return columns_; }    ///< of the surface
  [[nodiscard]] double mean_diameter() const { return diameter_; }  ///< m
  /// The first column and its width at the start, heights unknown.
  [[nodiscard]] SurfaceProfile empty_profile() const;
  [[nodiscard]] const std::vector<MeasuredMoment>& moments() const { return moments_; }
  /// The last moment before the first shaking begins; without shaking the first. There is at least one.
  [[nodiscard]] const MeasuredMoment& before() const;
  [[nodiscard]] const SurfaceProfile& surface_before() const { return before_; }
  [[nodiscard]] const SurfaceProfile& surface() const { return last_; }  ///< of the last moment
  /// The grid of the fields over the inside of the box, below the surface where there is no lid; MeasureOptions::cell
  /// must be given.
  /// \throws Error (computation_failed) where no heap is left in the box, or bodies are too far apart for the cells
  [[nodiscard]] CoarseGrid grid_of_fields(const GrainSimulation& simulation) const;
  [[nodiscard]] CoarseFields fields(const GrainSimulation& simulation, const CoarseGrid& grid) const;

 private:
  const GrainScene& scene_;
  MeasureOptions options_;
  std::vector<BoxShaking> shakings_;
  GrainBox start_;  ///< the box at t = 0
  std::size_t columns_ = 0;
  double shaken_from_ = 0;
  double diameter_ = 0;
  std::vector<MeasuredMoment> moments_;
  SurfaceProfile before_, last_;
};

}  // namespace equidem
