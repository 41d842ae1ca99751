// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies that are removed, renamed or added where a stage begins.
///
/// Simulation of colliding bodies in stages: each begins with the state of the one before in a changed scene.
///
/// Bonds that are made where a stage begins.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/grains/contacts/bond_breaking.hpp"
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
/// \param scene its bodies, and its periodic cell with the present periods
/// \param contacts of the last step
/// \param known bonds so far, broken ones too: their discs are not bonded again
/// \throws Error (bad_input) where a spring is so soft that it would have to be pressed to half its length, or turned
///         by more than a right angle, to carry the force of the contact
std::vector<GrainBond> make_bonds(const GrainScene& scene, std::span<const GrainContact> contacts,
                                  std::span<const GrainBond> known, const StageBonds& how);

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

/// The bodies that are there. A body keeps its number in the run: those of the first scene come first, then those that
/// stages add.
struct PresentBodies {
  std::vector<std::size_t> numbers;  ///< ascending
  std::vector<Grain> grains;         ///< in the same order
};

struct ChangedBodies {
  PresentBodies now;
  std::vector<std::int32_t> origins;  ///< place of each among those before; -1: it is new
  std::size_t removed = 0, renamed = 0;
  std::vector<std::size_t> idle_removals, idle_renamings;  ///< numbers of choices that held no body
};

/// \param first_added number in the run of the first body that is added
/// \throws Error (bad_input) if no body is left
ChangedBodies change_bodies(const PresentBodies& before, const StageBodies& how, std::size_t first_added);

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

/// A stage that does not meet its end within its limit stops the simulation: advance() throws there, and again in every
/// call. Energies that change where a stage begins, because walls or bodies go or come, or springs change, are in
/// EnergyLedger::work_of_stages. motions(), velocities() and body_contacts() number all bodies of the run.
class StagedSimulation final : public AnySimulation {
 public:
  /// \param stages at least one
  /// \param options a reference length of 0 is that of the first scene, in all stages
  /// \throws Error as GrainSimulation and make_bonds, for the first stage; (bad_input) two walls of one name in a
  ///         stage, an end that names no wall of the stage or a cell that is not there, walls as check_start, strengths
  ///         of some bonds alone, bodies that the first stage changes, a cell that not all stages have
  StagedSimulation(std::vector<GrainStage> stages, const GrainOptions& options);

  /// The simulation of the present stage; it counts the bodies that are there.
  [[nodiscard]] const GrainSimulation& present() const { return *present_; }
  /// The numbers of these bodies in the run, ascending.
  [[nodiscard]] const std::vector<std::size_t>& numbers() const { return start_.bodies.numbers; }
  [[nodiscard]] const std::vector<StageReport>& reports() const { return reports_; }
  /// All bonds so far, broken ones too, between bodies as they are numbered in the run: those of the first scene, then
  /// those made in stages. BondBreak::bond is their number.
  [[nodiscard]] std::span<const GrainBond> bonds() const { return bonds_.all; }
  /// Their strengths; null: they do not break.
  [[nodiscard]] const ContactStrengths* strengths() const { return bonds_.strengths ? &*bonds_.strengths : nullptr; }
  /// Bonds that broke in all stages, in the order of time.
  [[nodiscard]] std::vector<BondBreak> breaks() const;
  /// The bonds that hold, between bodies as present() counts them, and their strengths, empty where they do not break.
  struct HoldingBonds {
    std::vector<GrainBond> bonds;
    ContactStrengths strengths;
  };
  [[nodiscard]] HoldingBonds holding_bonds() const;

  /// The effects of all stages together; StageReport has those of each.
  [[nodiscard]] const Effects& effects() const override { return effects_; }
  /// Stops at the end of a stage; the next call goes on with the next one.
  /// \throws Error as GrainSimulation and, where a stage begins, as make_bonds: the state is then that before it;
  ///         (computation_failed) if a stage does not meet its end
  void advance(std::int64_t steps) override;
  [[nodiscard]] std::int64_t step() const override { return present_->step(); }
  [[nodiscard]] std::int64_t milestone() const override;
  [[nodiscard]] bool over() const override;
  /// One for each body of the run; not_there: those that are gone, or come later.
  [[nodiscard]] std::vector<DiscMotion> motions() const override { return of_run(present_->motions()); }
  [[nodiscard]] std::vector<DiscMotion> velocities() const override { return of_run(present_->velocities()); }
  [[nodiscard]] std::vector<BodyContact> body_contacts() const override;
  [[nodiscard]] EnergyLedger energy() const override;
  [[nodiscard]] std::vector<WallState> walls() const override { return present_->walls(); }
  [[nodiscard]] std::optional<CellState> cell() const override { return present_->cell(); }
  [[nodiscard]] double bytes_per_body() const override { return present_->bytes_per_body(); }
  /// Arrays of the present GrainSimulation; stages: first, last, over, ended, the values of StageReport and its effects
  /// as bits, a row for each stage that has begun; stage_walls: places of the walls at the start of the present stage;
  /// stage_cell: width, height, shift, corner and strain of the cell there; stage_bodies: numbers and kinds of the
  /// bodies in the order of the loops; stage_motions: of the bodies at the start of the present stage, where it is
  /// not the first; stage_bonds: made so far, with stage, i, j, rest and strengths; stage_breaks: of bonds whose bodies
  /// are gone; stage_servos: the reports of stages that are over; stage_cell_servos: likewise of cells; stage_idle:
  /// stage, 1 for a renaming, number of a choice that held no body; stage_energies.
  [[nodiscard]] SavedState save() const override;
  void restore(const SavedState& state) override;
  /// The number of stages that have begun in a saved state; 0: it is of no simulation in stages.
  [[nodiscard]] static std::size_t stages_begun(const SavedState& state);

 private:
  /// Where a stage has begun.
  struct Start {
    std::vector<Vec2> walls;  ///< places
    PresentBodies bodies;
    std::optional<PeriodicCell> cell = {};  ///< its periods
    Voigt strain = {};                      ///< of the cell
  };
  /// The bonds of all stages that have begun.
  struct Bonds {
    std::vector<GrainBond> all;
    std::optional<ContactStrengths> strengths;
    std::vector<std::size_t> stages;  ///< in which they were made, of those behind the bonds of the first scene
  };
  /// The bonds of a scene: those of `all` whose bodies are there.
  struct SceneBonds {
    std::vector<std::size_t> numbers;  ///< in Bonds::all, ascending
    std::vector<GrainBond> bonds;      ///< between bodies of the scene
  };

  [[nodiscard]] std::size_t number() const { return reports_.size() - 1; }
  [[nodiscard]] std::vector<DiscMotion> of_run(const std::vector<DiscMotion>& here) const;
  [[nodiscard]] std::size_t first_added(std::size_t stage) const;
  [[nodiscard]] const Grain& body_of_run(std::size_t number) const;
  [[nodiscard]] static SceneBonds bonds_between(const std::vector<std::size_t>& bodies, const Bonds& bonds);
  [[nodiscard]] GrainScene scene_of(std::span<const std::int64_t> firsts, const Start& start, const Bonds& bonds) const;
  [[nodiscard]] std::size_t stage_of_servo(std::size_t stage, std::size_t wall) const;
  [[nodiscard]] std::size_t stage_of_stress(std::size_t stage, bool CellServo::*goes_on) const;
  [[nodiscard]] std::vector<std::int32_t> wall_origins(std::size_t stage) const;
  [[nodiscard]] std::vector<Vec2> places_in(std::size_t stage) const;
  [[nodiscard]] Start start_of_first() const;
  [[nodiscard]] Bonds bonds_at_start() const;
  /// The bonds with those that a stage makes.
  [[nodiscard]] Bonds bonds_of(std::size_t stage, Bonds bonds, const Start& start,
                               std::span<const GrainContact> contacts) const;
  [[nodiscard]] Bonds bonds_in(const SavedState& state, std::size_t begun) const;
  [[nodiscard]] Start start_in(const SavedState& state, std::size_t begun, std::vector<std::size_t>& order) const;
  void begin_stage();
  void keep_past_breaks(const std::vector<std::size_t>& bodies_left);
  void look_for_end();
  [[nodiscard]] bool holds(const StageEnd& end);
  [[noreturn]] void refuse_endless() const;

  std::vector<GrainStage> stages_;
  GrainOptions options_;
  Effects effects_;
  std::unique_ptr<GrainSimulation> present_;
  std::vector<StageReport> reports_;
  Start start_;  ///< of the present stage
  Bonds bonds_;
  std::vector<BondBreak> past_breaks_;                ///< of bonds whose bodies are gone
  double initial_ = 0, potential_ = 0, changes_ = 0;  ///< J: at the start; up to the present stage
};

}  // namespace equidem
