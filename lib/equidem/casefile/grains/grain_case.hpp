// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A case of colliding bodies as typed values.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/casefile/engine/toml.hpp"
#include "equidem/fields/box_measures.hpp"
#include "equidem/grains/scene/pair_options.hpp"
#include "equidem/grains/stages/staged_simulation.hpp"
#include "equidem/motion/saved_state.hpp"
#include "equidem/motion/wall.hpp"

namespace equidem {

/// One [[stage]]. The scene has all bodies that the run may have until then, with every group; build_grain_stages sets
/// its pairs and the number of steps.
struct StageCase : GrainStage {
  std::optional<double> duration;           ///< s; with an end its limit
  std::optional<std::int64_t> given_steps;  ///< instead
  ContactTable contacts;
  std::optional<Shaking> shaking;  ///< from the start of the stage; also set in the walls
};

/// A checked case: complete, in range and without contradiction; conditions on all bodies together are checked at the
/// start of the simulation.
struct GrainCase : CaseDocument {
  Body body = Body::disc;
  GrainScene scene;                 ///< bodies of the file, then those of the case; `pairs` is not set
  std::vector<std::string> groups;  ///< of all bodies of the run, as it has them first
  std::vector<double> densities;    ///< kg/m³, likewise
  std::string grain_file;           ///< file of [grains] path; empty: none
  std::vector<int> grain_lines;     ///< line numbers of the grains in that file
  ContactTable contacts;
  GrainOptions options;            ///< without its time step
  GrainStepOptions step;           ///< options of its choice
  double duration = 0;             ///< s; with stages the sum of theirs, infinite where one counts its steps
  std::vector<StageCase> stages;   ///< empty: `scene` throughout; else `scene` and `contacts` are those of the first
  std::optional<Shaking> shaking;  ///< shaking; its motion is also set in the walls
  std::optional<MeasureOptions> measures;
  std::vector<Probe> probes;  ///< with the bodies of their groups
  OutputCase output;

  /// All bodies of the run by their numbers: those of the scene, then those that stages add.
  [[nodiscard]] std::vector<Grain> bodies() const;
  /// Place of a grain in the user's input: "cases/a.toml:12: grain", "cases/grains.csv:3".
  [[nodiscard]] std::string where_grain(std::size_t grain) const;
};

/// Whether a document describes colliding bodies.
/// \throws Error (bad_input) if it also has an [assembly]
bool describes_grains(const TomlValue& document);

/// Read and check a case file.
/// \param overrides "collisions.friction=0.3", in order
/// \throws Error (bad_input) with file, line and key
GrainCase read_grain_case(const std::filesystem::path& path, std::span<const std::string> overrides = {});

/// Read and check a case from text.
/// \param name of the file, for messages
/// \param folder to which paths in the text are relative
GrainCase parse_grain_case(std::string_view text, const std::string& name, const std::filesystem::path& folder,
                           std::span<const std::string> overrides = {});

/// The time step of a run, of its stages the shortest.
/// \throws Error (bad_input) as choose_time_step, with line and key
GrainTimeStep choose_grain_step(const GrainCase& resolved);

/// Number of steps of the whole duration.
/// \throws Error (bad_input) as count_steps(double, double), with line and key
std::int64_t count_steps(const GrainCase& resolved, double step);

/// The scene and the options of a simulation with a time step, s.
GrainScene build_grain_scene(const GrainCase& resolved, double step);
/// The stages of a run; one that has no end where the case has none.
std::vector<GrainStage> build_grain_stages(const GrainCase& resolved, double step);
GrainOptions grain_options(const GrainCase& resolved, double step);

}  // namespace equidem
