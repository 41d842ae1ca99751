// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [[stage.remove]], [[stage.rename]], [stage.grains], [[stage.grain]]: bodies that change where a stage begins.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/casefile/grains/grain_tables.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"

namespace equidem::casefile {

/// [[stage.remove]]: which bodies; of [[stage.rename]] too.
struct BodyChoiceTable {
  std::optional<std::string> group;
  std::optional<Rectangle> box;  ///< m
};

/// [[stage.rename]]: bodies, or a wall.
struct BodyRenamingTable {
  BodyChoiceTable which;
  std::optional<std::string> wall;
  std::string to;
};
std::vector<Key<BodyRenamingTable>> renaming_keys();

/// All bodies of a run up to a stage, each as often as there are groups that it may have: their kinds and the masses
/// that meet in contacts do not depend on where bodies will be.
class StagePopulation {
 public:
  StagePopulation(const std::vector<Grain>& grains, const std::vector<std::string>& groups);

  /// Go on to the next stage.
  /// \param[in,out] stage its table; paths become those that the program opens
  /// \param tables with the walls of all stages; get the densities of bodies that are added
  /// \return whether it changes bodies
  /// \throws Error (bad_input) with line and key: a choice of all bodies, a group that no body has, a box without area,
  ///         names that are not plain, bodies as those of the case
  bool read(const TomlValue& root, TomlValue& stage, const std::filesystem::path& folder, GrainShapes& shapes,
            GrainTables& tables);

  [[nodiscard]] const std::vector<Grain>& grains() const { return grains_; }
  [[nodiscard]] const std::vector<std::string>& groups() const { return groups_; }
  /// The groups of the bodies in which the run has them first.
  [[nodiscard]] const std::vector<std::string>& first_groups() const { return first_groups_; }
  /// Returns what was read last. \param grains those of the population, with their kinds
  [[nodiscard]] StageBodies changes(const std::vector<Grain>& grains) const;

 private:
  void add(std::size_t number, const Grain& grain, const std::string& group);
  void check_choice(const TomlValue& table, const std::string& path, const BodyChoiceTable& choice) const;
  [[nodiscard]] BodyChoice choice_of(const BodyChoiceTable& table, const std::vector<Grain>& grains) const;

  std::vector<Grain> grains_;
  std::vector<std::string> groups_, first_groups_;
  std::vector<std::size_t> numbers_;
  std::map<std::pair<std::size_t, std::string>, std::size_t> entries_;
  // of the last stage
  std::vector<BodyChoiceTable> removed_;
  std::vector<BodyRenamingTable> renamed_;
  std::size_t added_ = 0;
};

void bind_stage_bodies(File<GrainTables>& file);

}  // namespace equidem::casefile
