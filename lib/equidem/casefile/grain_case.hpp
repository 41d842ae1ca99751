// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A case of bodies that collide, as typed values.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/casefile/case.hpp"
#include "equidem/casefile/engine/toml.hpp"
#include "equidem/fields/box_measures.hpp"
#include "equidem/grains/scene/grain_time_step.hpp"
#include "equidem/grains/scene/shaking.hpp"

namespace equidem {

/// [[probe]]: a history of grains.
struct GrainProbe {
  std::string name;
  std::vector<std::int32_t> grains;     ///< at least one
  std::vector<std::string> quantities;  ///< words of the key probe.quantities
};

/// A checked case: complete, in range and without contradiction; what only all bodies together can tell is checked
/// where the simulation begins.
struct GrainCase {
  std::string title;
  Body body = Body::disc;
  GrainScene scene;               ///< bodies: those of the file, then those of the case; without its pairs
  std::vector<double> densities;  ///< kg/m³, of each grain
  std::string grain_file;         ///< that of [grains] path; empty: none
  std::vector<int> grain_lines;   ///< of its grains, in that file
  ContactTable contacts;
  GrainOptions options;            ///< without its time step
  GrainStepOptions step;           ///< how that is chosen
  double duration = 0;             ///< s
  std::optional<Shaking> shaking;  ///< its motion is in the walls
  std::optional<MeasureOptions> measures;
  std::vector<GrainProbe> probes;
  OutputCase output;

  /// The document behind it, defaults filled in.
  TomlValue document;

  /// "cases/a.toml:7: wall.0": where the user wrote it, for errors.
  [[nodiscard]] std::string where(std::string_view key) const;
  /// The same of a grain: "cases/a.toml:12: grain", "cases/grains.csv:3".
  [[nodiscard]] std::string where_grain(std::size_t grain) const;
};

/// Whether a case file describes bodies that collide.
/// \throws Error (bad_input) where it cannot be read, is no TOML, or has an [assembly] too
bool describes_grains(const std::filesystem::path& path, std::span<const std::string> overrides = {});

/// Read and check a case file.
/// \param overrides "collisions.friction=0.3", in order
/// \throws Error (bad_input) with file, line and key
GrainCase read_grain_case(const std::filesystem::path& path, std::span<const std::string> overrides = {});

/// The same from text.
/// \param name of the file, for messages
/// \param folder to which paths in the text are relative
GrainCase parse_grain_case(std::string_view text, const std::string& name, const std::filesystem::path& folder,
                           std::span<const std::string> overrides = {});

}  // namespace equidem
