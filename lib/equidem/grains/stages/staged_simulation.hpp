// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Simulation of colliding bodies in stages: each begins with the state of the one before in a changed scene.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/stages/make_bonds.hpp"
#include "equidem/motion/servo.hpp"

namespace equidem {

/// What ends a stage before its limit; all that is given must hold.
struct StageEnd {
  /// At rest: kinetic energy over elastic energy, mean unbalanced force of a body over the mean contact force.
  double kinetic = infinite, unbalanced = infinite;
  /// The distance of two walls has changed by this share of what it was at the start of the stage; 0: not looked at.
  double strain = 0;
  std::array<std::string, 2> walls = {};
  /// A wall has moved so far since the start of the stage, m; 0: not looked at.
  double displacement = 0;
  std::string wall = {};

  static constexpr double infinite = std::numeric_limits<double>::infinity();
  [[nodiscard]] bool at_rest() const { return kinetic < infinite || unbalanced < infinite; }
  [[nodiscard]] bool given() const { return at_rest() || strain > 0 || displacement > 0; }
};

/// \param scene its bodies, bonds and strengths count in the first stage alone; its walls are all that there are. Of a
///        wall that was there in the stage before, the place is not read: it stays where it is. Schedules begin with
///        the stage.
struct GrainStage {
  std::string name;
  GrainScene scene;
  std::int64_t steps = 0;  ///< its length or, with an end, its limit
  StageEnd end = {};
  std::optional<StageBonds> bonds = {};  ///< made at its start
};

/// How a stage went.
struct StageReport {
  std::string name;
  std::int64_t first = 0, last = 0;  ///< steps at its start and end
  bool over = false;
  bool ended = false;                                                ///< by its end; false: by its length, or not yet
  double kinetic = 0, unbalanced = 0, strain = 0, displacement = 0;  ///< when they were last looked at
  Effects effects = {};
  std::size_t bonds_made = 0;            ///< at its start
  std::vector<ServoReport> servos = {};  ///< at its end; empty before
};

/// \throws Error (bad_input) if a wall that stands would jump where its schedules begin
void check_start(const Wall& wall);

/// A stage that does not meet its end within its limit stops the simulation: advance() throws there, and again in every
/// call. Energies that change where a stage begins, because walls go or springs change, are in
/// EnergyLedger::work_of_stages.
class StagedSimulation final : public AnySimulation {
 public:
  /// \param stages at least one
  /// \throws Error as GrainSimulation and make_bonds, for the first stage; (bad_input) two walls of one name in a
  ///         stage, an end that names no wall of the stage, walls as check_start, strengths of some bonds alone
  StagedSimulation(std::vector<GrainStage> stages, const GrainOptions& options);

  /// The simulation of the present stage.
  [[nodiscard]] const GrainSimulation& present() const { return *present_; }
  [[nodiscard]] const std::vector<StageReport>& reports() const { return reports_; }
  /// All bonds so far, broken ones too: those of the first scene, then those made in stages. BondBreak::bond is their
  /// number.
  [[nodiscard]] std::span<const GrainBond> bonds() const { return bonds_.all; }
  /// Their strengths; null: they do not break.
  [[nodiscard]] const ContactStrengths* strengths() const { return bonds_.strengths ? &*bonds_.strengths : nullptr; }

  [[nodiscard]] const Effects& effects() const override { return present_->effects(); }
  /// Stops at the end of a stage; the next call goes on with the next one.
  /// \throws Error as GrainSimulation and, where a stage begins, as make_bonds: the state is then that before it;
  ///         (computation_failed) if a stage does not meet its end
  void advance(std::int64_t steps) override;
  [[nodiscard]] std::int64_t step() const override { return present_->step(); }
  [[nodiscard]] std::int64_t milestone() const override;
  [[nodiscard]] bool over() const override;
  [[nodiscard]] std::vector<DiscMotion> motions() const override { return present_->motions(); }
  [[nodiscard]] std::vector<DiscMotion> velocities() const override { return present_->velocities(); }
  [[nodiscard]] std::vector<BodyContact> body_contacts() const override { return present_->body_contacts(); }
  [[nodiscard]] EnergyLedger energy() const override;
  [[nodiscard]] std::vector<WallState> walls() const override { return present_->walls(); }
  [[nodiscard]] std::optional<CellState> cell() const override { return present_->cell(); }
  [[nodiscard]] double bytes_per_body() const override { return present_->bytes_per_body(); }
  /// Arrays of the present GrainSimulation; stages: first, last, over, ended and the values of StageReport, a row for
  /// each stage that has begun; stage_walls: places of the walls at the start of the present stage; stage_motions,
  /// stage_velocities: of the bodies there, where it is not the first; stage_bonds: made so far, with stage, i, j, rest
  /// and strengths; stage_servos: the reports of stages that are over; stage_energies.
  [[nodiscard]] SavedState save() const override;
  void restore(const SavedState& state) override;

 private:
  /// Where a stage has begun.
  struct Start {
    std::vector<Vec2> walls;                      ///< places
    std::vector<DiscMotion> motions, velocities;  ///< of the bodies; empty in the first stage
  };
  /// The bonds of all stages that have begun.
  struct Bonds {
    std::vector<GrainBond> all;
    std::optional<ContactStrengths> strengths;
    std::vector<std::size_t> stages;  ///< in which they were made, of those behind the bonds of the first scene
  };

  [[nodiscard]] std::size_t number() const { return reports_.size() - 1; }
  [[nodiscard]] GrainScene scene_of(std::size_t stage, std::int64_t first, const Start& start,
                                    const Bonds& bonds) const;
  [[nodiscard]] std::vector<Vec2> places_in(std::size_t stage) const;
  [[nodiscard]] Bonds bonds_at_start() const;
  /// The bonds with those that a stage makes.
  [[nodiscard]] Bonds bonds_of(std::size_t stage, Bonds bonds, std::span<const Grain> grains,
                               std::span<const GrainContact> contacts) const;
  [[nodiscard]] Bonds bonds_in(const SavedState& state, std::size_t begun) const;
  void begin_stage();
  void look_for_end();
  [[nodiscard]] bool holds(const StageEnd& end);
  [[noreturn]] void refuse_endless() const;

  std::vector<GrainStage> stages_;
  GrainOptions options_;
  std::unique_ptr<GrainSimulation> present_;
  std::vector<StageReport> reports_;
  Start start_;  ///< of the present stage
  Bonds bonds_;
  double initial_ = 0, potential_ = 0, changes_ = 0;  ///< J: at the start; up to the present stage
};

}  // namespace equidem
