// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Histories of bodies in a box while they move: void ratio and surface.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "equidem/fields/coarse_fields.hpp"
#include "equidem/fields/surface.hpp"
#include "equidem/fields/void_ratio.hpp"
#include "equidem/grains/scene/shaking.hpp"

namespace equidem {

struct MeasureOptions {
  std::optional<Region> region = {};  ///< of the void ratio, m, where the box stands at the start; none:
                                      ///< measured_region at each moment
  std::optional<double> cell = {};    ///< width of the cells of the fields, m; none: no fields
};

/// \throws Error (bad_input), its place the name of the option: spheres, whose volumes no area of the plane tells; a
///         region without an area
void check(const MeasureOptions& options, Body body);

/// Stands for a quantity that has no value at a moment.
inline constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();

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
