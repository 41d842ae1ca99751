// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What `equidem run` reads off bodies in a box while they move: void ratio, surface, bodies thrown, period of the
/// surface.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "equidem/casefile/grain_case.hpp"
#include "equidem/fields/surface.hpp"
#include "equidem/fields/void_ratio.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/output/files/growing_csv.hpp"
#include "equidem/output/files/json.hpp"

namespace equidem {

/// What cannot be measured at a moment is this.
inline constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();

/// At one moment. Places go with the shaking box.
struct MeasuredMoment {
  std::int64_t step = 0;
  double time = 0;  ///< s
  double void_ratio = 0, porosity = 0;
  SurfaceShape surface;          ///< of the heap
  Vec2 centre;                   ///< of mass, m
  std::int64_t thrown = 0;       ///< bodies apart from the heap now
  std::int64_t ever_thrown = 0;  ///< bodies that were, now or before
  std::int64_t outside = 0;      ///< bodies with the centre beyond a side or the floor of the box
};

class GrainMeasures {
 public:
  /// \param resolved with measures
  explicit GrainMeasures(const GrainCase& resolved);

  /// Write measures.csv, surface.csv and thrown.csv (when a body was first seen apart) into a folder.
  /// \param continue_after go on with the files of an earlier run
  /// \throws Error (bad_input) as GrowingCsv
  void open(const std::filesystem::path& folder, bool overwrite, std::optional<std::int64_t> continue_after);
  [[nodiscard]] std::int64_t last_step() const { return moments_.empty() ? -1 : moments_.back().step; }
  void record(std::int64_t step, double time, const std::vector<Grain>& grains);
  /// Return once all rows are on the disk.
  void sync();

  /// For the report, after the last step.
  [[nodiscard]] std::string describe() const;
  void add_to(JsonObject& object) const;
  /// surface_plot: the surface before and at the end; void_ratio_plot; fields where asked for.
  void write_files(const std::filesystem::path& folder, const GrainSimulation& simulation, bool overwrite) const;

 private:
  struct Sloshing {
    double from = 0;  ///< s, the history looked at
    double period = 0, frequency_resolution = 0, amplitude = 0;
    double theory = 0;    ///< s
    std::string missing;  ///< why there is no period
  };
  [[nodiscard]] Vec2 displacement(double time) const;
  [[nodiscard]] Sloshing sloshing() const;
  /// The last moment before the shaking begins; without [shaking] the start of the run.
  [[nodiscard]] const MeasuredMoment& before() const;
  void check_cells() const;
  void go_on(std::int64_t after);
  void write_thrown() const;

  const GrainCase& resolved_;
  GrainBox start_;          ///< the box at t = 0
  double shaken_from_ = 0;  ///< s
  double diameter_ = 0;     ///< mean, m
  std::size_t columns_ = 0;
  std::vector<MeasuredMoment> moments_;
  SurfaceProfile before_, last_;
  struct Throw {
    std::int64_t step = 0;
    double time = 0;
  };
  std::vector<std::optional<Throw>> throws_;  ///< of each body, the first
  std::filesystem::path folder_;
  std::optional<GrowingCsv> table_, profiles_;
};

/// How the box shakes, as a line of the report; empty without [shaking].
std::string describe_shaking(const GrainCase& resolved);
/// shaking: direction, peak_acceleration, ...; nothing without [shaking].
void add_shaking(JsonObject& object, const GrainCase& resolved);

/// paths_plot: where the probes of positions went, from history.csv of the folder; nothing where there are none.
void write_probe_paths(const std::filesystem::path& folder, const GrainCase& resolved, bool overwrite);

}  // namespace equidem
