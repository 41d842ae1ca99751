// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Simulation of colliding bodies in stages, each of which changes the scene where it begins.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "equidem/breakage/strengths.hpp"
#include "equidem/grains/contacts/bonds.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/stages/stage.hpp"

namespace equidem {

/// Motions that a user changes between two steps, until the stage ends.
struct Steering {
  std::string wall = {};              ///< name; empty: of the periodic cell
  std::optional<Vec2> velocity = {};  ///< of the wall, m/s: it has no servo from then on
  std::optional<double> wanted = {};  ///< of its servo: force, N (discs: N/m), or stress, Pa
  std::optional<double> rate_xx = {}, rate_yy = {}, rate_xy = {};  ///< of the cell, 1/s: it keeps no such stress then
  std::optional<double> stress_xx = {}, stress_yy = {};            ///< that the servo of the cell keeps, Pa
};

/// A stage that does not meet its end within its limit stops the simulation: advance() throws there, and again in every
/// call. Energies that change where a stage begins, because walls or bodies go or come, or springs change, are in
/// EnergyLedger::work_of_stages. Bodies and bonds keep one number through the run: first those of the first scene, then
/// those that stages add or make.
class StagedSimulation final : public AnySimulation {
 public:
  /// \param stages at least one
  /// \param options a reference length of 0 is that of the first scene, in all stages
  /// \throws Error as check(stages, options), and as GrainSimulation and make_bonds for the first stage
  StagedSimulation(std::vector<GrainStage> stages, const GrainOptions& options);

  /// The simulation of the present stage.
  [[nodiscard]] const GrainSimulation& present() const { return present_; }
  [[nodiscard]] const std::vector<StageReport>& reports() const { return reports_; }
  /// All bonds so far, those of bodies that have gone and broken ones too. BondBreak::bond is their number.
  [[nodiscard]] std::span<const GrainBond> bonds() const { return bonds_.all; }
  /// Their strengths; null: they do not break.
  [[nodiscard]] const ContactStrengths* strengths() const { return bonds_.strengths ? &*bonds_.strengths : nullptr; }
  /// In all stages, in the order of time.
  [[nodiscard]] std::vector<BondBreak> breaks() const { return present_.breaks(); }
  /// The bonds that hold, and their strengths, empty where they do not break.
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
  /// Change the motion of a wall or of the cell from the present step on. The saved states of a simulation that was
  /// steered do not contain it.
  /// \throws Error (bad_input): no such wall, servo or cell, a motion that the scene refuses; then nothing has changed
  void steer(const Steering& how);
  [[nodiscard]] std::int64_t step() const override { return present_.step(); }
  [[nodiscard]] std::int64_t milestone() const override;
  [[nodiscard]] bool over() const override;
  [[nodiscard]] std::vector<DiscMotion> motions() const override { return present_.motions(); }
  [[nodiscard]] std::vector<DiscMotion> velocities() const override { return present_.velocities(); }
  [[nodiscard]] std::vector<BodyContact> body_contacts() const override { return present_.body_contacts(); }
  [[nodiscard]] EnergyLedger energy() const override;
  [[nodiscard]] std::vector<WallState> walls() const override { return present_.walls(); }
  [[nodiscard]] std::optional<CellState> cell() const override { return present_.cell(); }
  [[nodiscard]] double bytes_per_body() const override { return present_.bytes_per_body(); }
  /// Arrays of the present GrainSimulation; stages: reports, a row for each stage that has begun; stage_walls (places)
  /// and stage_start: where the present stage began; stage_bodies: presence and kind of those so far; stage_bonds: made
  /// so far; stage_servos: reports of stages that are over; stage_idle: choices that held no body.
  [[nodiscard]] SavedState save() const override;
  void restore(const SavedState& state) override;
  /// The number of stages that have begun in a saved state; 0: it is of no simulation in stages.
  [[nodiscard]] static std::size_t stages_begun(const SavedState& state);

 private:
  /// Where a stage has begun.
  struct Start {
    std::vector<Vec2> walls;  ///< places
    Voigt strain = {};        ///< of the cell
    /// At the start of the run; up to this stage. J
    double initial = 0, potential = 0, changes = 0;
  };
  /// The bonds of all stages that have begun.
  struct Bonds {
    std::vector<GrainBond> all;
    std::optional<ContactStrengths> strengths;
    std::vector<std::size_t> stages;  ///< in which they were made, of those behind the bonds of the first scene
  };

  [[nodiscard]] std::size_t number() const { return reports_.size() - 1; }
  [[nodiscard]] std::size_t first_added(std::size_t stage) const;
  [[nodiscard]] std::vector<Grain> bodies_at_start() const;
  [[nodiscard]] GrainScene scene_of(std::span<const StageReport> reports, std::vector<Grain> bodies, const Start& start,
                                    const Bonds& bonds) const;
  [[nodiscard]] std::size_t stage_of_servo(std::size_t stage, std::size_t wall) const;
  [[nodiscard]] std::size_t stage_of_stress(std::size_t stage, bool CellServo::*goes_on) const;
  [[nodiscard]] Bonds bonds_at_start() const;
  /// The bonds with those that a stage makes.
  [[nodiscard]] Bonds bonds_of(std::size_t stage, Bonds bonds, const std::vector<Grain>& bodies,
                               const std::optional<PeriodicCell>& cell, std::span<const GrainContact> contacts) const;
  [[nodiscard]] Bonds bonds_in(const SavedState& state, std::size_t begun) const;
  [[nodiscard]] std::vector<Grain> bodies_in(const SavedState& state, std::size_t begun) const;
  void begin_stage();
  /// Go on in a scene; what that changes of the energies is in the ledger.
  void go_on_in(GrainScene scene, const std::vector<std::int32_t>& walls, Start start, Bonds bonds);
  void look_for_end();
  [[nodiscard]] bool holds(const StageEnd& end);
  [[noreturn]] void refuse_endless() const;

  std::vector<GrainStage> stages_;
  GrainOptions options_;
  Effects effects_;
  Start start_;  ///< of the present stage
  Bonds bonds_;
  GrainSimulation present_;
  std::vector<StageReport> reports_;
  std::vector<std::pair<double, Steering>> steered_;  ///< in the present stage, with their times
};

}  // namespace equidem
