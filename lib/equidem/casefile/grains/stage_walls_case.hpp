// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [[stage.wall]], and [[stage.rename]] of walls: walls that come, go, move otherwise or get another name.
#pragma once

#include <set>
#include <span>
#include <string>
#include <vector>

#include "equidem/casefile/grains/grain_tables.hpp"

namespace equidem::casefile {

/// The walls of a run, from stage to stage.
class StageWalls {
 public:
  /// \param walls of the case; \param tables that they were read from
  StageWalls(const std::vector<Wall>& walls, const std::vector<WallTable>& tables);

  /// Go on to the next stage: walls are renamed, then changed.
  /// \throws Error (bad_input) with line and key: a wall that is not there or needed by the servo of another, a name
  ///         that a wall has or had, a wall that is renamed twice or renamed and removed, one that is there with a
  ///         place
  void read(const TomlValue& stage, std::span<const NamedSchedule> schedules);

  /// Those of the stage, without its shaking.
  [[nodiscard]] const std::vector<Wall>& walls() const { return walls_; }
  [[nodiscard]] const std::vector<WallRenaming>& renamed() const { return renamed_; }
  [[nodiscard]] bool shakes(const Wall& wall) const { return !still_.contains(wall.name); }
  /// Those of all stages so far, one of each name.
  [[nodiscard]] const std::vector<Wall>& all() const { return all_; }

 private:
  [[noreturn]] void refuse_unknown(const TomlValue& name, const char* key, const char* what) const;
  void rename(const TomlValue& table);
  void check_name(const TomlValue& table) const;
  void change(const TomlValue& table, std::span<const NamedSchedule> schedules);
  void check_servos_of_others(const TomlValue& table, const std::string& name, const char* path,
                              const char* done) const;

  std::vector<Wall> walls_, all_;
  std::vector<WallRenaming> renamed_;  ///< in this stage
  std::set<std::string> still_;        ///< names of walls that do not shake
};

void bind_stage_walls(File<GrainTables>& file);

}  // namespace equidem::casefile
