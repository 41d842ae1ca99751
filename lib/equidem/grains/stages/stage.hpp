// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A stage of a run of colliding bodies: what changes where it begins, what ends it, and how it went.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/motion/wall.hpp"

namespace equidem {

/// Discs are bonded where the gap between them is small.
struct StageBonds {
  double gap_tolerance = 0;  ///< largest gap over the sum of the radii, as in touching_discs
  GrainBond like = {};       ///< with the springs and dashpots of all; i, j and rest are not read
  /// Strengths of the new bonds, in their order; where the bonds of a run break, and only there.
  std::optional<StrengthOptions> strengths = {};
};

/// The new bonds, ordered by i, then j > i. Discs that press each other keep their force: with f_N, f_T the normal
/// (compression positive) and tangential force of the contact, the bond is at rest at |l0| = |l| + f_N/kN, turned by
/// f_T |l|/(kT |l0|²), so that its springs carry what the contact did. A spring that the bond lacks carries nothing.
/// Where their contact goes on beside the bond it keeps the force, and the bond is at rest as the discs are.
/// \param scene its bodies, its periodic cell with the present periods, and its bonds so far, broken ones too: their
///        discs are not bonded again
/// \param contacts of the last step
/// \throws Error (bad_input) where a spring is so soft that it would have to be pressed to half its length, or turned
///         by more than a right angle, to carry the force of the contact
std::vector<GrainBond> make_bonds(const GrainScene& scene, std::span<const GrainContact> contacts,
                                  const StageBonds& how);

/// \throws Error (bad_input): a grain that is no disc, bonds that no law or step of the options allows, as check_bonds
void check(const StageBonds& bonds, std::span<const Grain> grains, const GrainOptions& options);

/// The step that such bonds are likely to bear, s: that of the lightest disc among six like it. Who is bonded to whom
/// shows only where the stage begins, and a longer step than those bear is refused there.
double likely_step_limit(std::span<const Grain> grains, const StageBonds& bonds, GrainOptions::BondStep bond_step);

/// Some of the present bodies.
struct BodyChoice {
  std::vector<int> kinds = {};        ///< bodies of these kinds; empty: of any kind
  std::optional<Rectangle> box = {};  ///< bodies with their centre inside, its sides included, m; none: anywhere

  [[nodiscard]] bool holds(const Grain& grain) const;
};

/// Bodies get another kind.
struct BodyRenaming {
  BodyChoice which;
  std::vector<int> kinds;  ///< that each body of the run would get, by its number
};

/// In this order: bodies are removed, renamed, added. Bonds go with their bodies.
struct StageBodies {
  std::vector<BodyChoice> removed = {};
  std::vector<BodyRenaming> renamed = {};
  std::vector<Grain> added = {};

  [[nodiscard]] bool change() const { return !removed.empty() || !renamed.empty() || !added.empty(); }
};

/// What ends a stage before its limit; all that is given must hold.
struct StageEnd {
  /// At rest: kinetic energy over elastic energy, mean unbalanced force of a body over the mean contact force.
  double kinetic = infinite, unbalanced = infinite;
  /// The distance of two walls has changed by this share of what it was at the start of the stage; 0: not looked at.
  double strain = 0;
  std::array<std::string, 2> walls = {};
  /// Instead of walls: this component of the strain of the periodic cell has changed by `strain` since then.
  enum class CellStrain { xx, yy, xy };
  std::optional<CellStrain> of_cell = {};
  /// A wall has moved so far since the start of the stage, m; 0: not looked at.
  double displacement = 0;
  std::string wall = {};

  static constexpr double infinite = std::numeric_limits<double>::infinity();
  [[nodiscard]] bool at_rest() const { return kinetic < infinite || unbalanced < infinite; }
  [[nodiscard]] bool given() const { return at_rest() || strain > 0 || displacement > 0; }
};

/// A wall gets another name where a stage begins.
struct WallRenaming {
  std::string from, to;
};

/// \param scene its bodies, bonds and strengths count in the first stage alone, its clumps are those of all bodies so
///        far, its walls are all that there are. Of a wall that was there in the stage before, by its name or by
///        renamed_walls, the place is not read: it stays where it is. All stages have a periodic cell or none; its
///        periods count in the first stage alone. Schedules begin with the stage.
struct GrainStage {
  std::string name;
  GrainScene scene;
  std::int64_t steps = 0;  ///< its length or, with an end, its limit
  StageEnd end = {};
  StageBodies bodies = {};                       ///< changed at its start; of the first stage not at all
  std::vector<WallRenaming> renamed_walls = {};  ///< the scene has the new names
  std::optional<StageBonds> bonds = {};          ///< made at its start, then
  std::string place = {};                        ///< in the user's input, for messages; empty: not known

  [[nodiscard]] std::string where() const { return (place.empty() ? "" : place + ": ") + "stage '" + name + "'"; }
};

template <>
struct EnumNames<StageEnd::CellStrain> {
  using enum StageEnd::CellStrain;
  static constexpr const char* what = "component of strain";
  static constexpr NamedValue<StageEnd::CellStrain> list[] = {{xx, "xx"}, {yy, "yy"}, {xy, "xy"}};
};

/// How a stage went.
struct StageReport {
  std::string name;
  std::int64_t first = 0, last = 0;  ///< steps at its start and end
  bool over = false;
  bool ended = false;                                                ///< by its end; false: by its length, or not yet
  double kinetic = 0, unbalanced = 0, strain = 0, displacement = 0;  ///< when they were last looked at
  std::vector<std::string> effects = {};                             ///< names of those that were active
  std::size_t removed = 0, renamed = 0, added = 0;                   ///< bodies, at its start
  std::size_t bonds_made = 0;                                        ///< likewise
  std::vector<WallRenaming> renamed_walls = {};                      ///< likewise
  /// Numbers of removals and renamings (StageBodies) that held no body at its start.
  std::vector<std::size_t> idle_removals = {}, idle_renamings = {};
  std::vector<ServoReport> servos = {};           ///< at its end; empty before
  std::vector<CellServoReport> cell_servos = {};  ///< likewise
};

/// The effects of all stages together: active is what is so in any of them.
Effects effects_of(const std::vector<GrainStage>& stages, const GrainOptions& options);

/// The names of the effects that are active.
std::vector<std::string> active_effects(const Effects& effects);

/// \throws Error (bad_input) if a wall that stands would jump where its schedules begin
void check_start(const Wall& wall);

/// \param[in,out] bodies all of the run, by their numbers
/// \param[out] report its counts of bodies
/// \param first_added number of the first body that is added
/// \throws Error (bad_input) if no body is left
void change_bodies(std::vector<Grain>& bodies, const StageBodies& how, std::size_t first_added, StageReport& report);

/// The number of each wall of a stage in the stage before; -1: it is new.
std::vector<std::int32_t> wall_origins(const GrainStage& stage, const GrainStage& before);

/// \throws Error (bad_input): two walls of one name in a stage, an end that names no wall of the stage or a cell that
///         is not there, walls as check_start, strengths of some bonds alone, bonds as check, bodies that the first
///         stage changes, a cell that not all stages have
void check(std::span<const GrainStage> stages, const GrainOptions& options);

}  // namespace equidem
