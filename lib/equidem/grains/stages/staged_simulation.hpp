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
#include "equidem/grains/contacts/bond_breaking.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/stages/stage.hpp"

namespace equidem {

/// A stage that does not meet its end within its limit stops the simulation: advance() throws there, and again in every
/// call. Energies that change where a stage begins, because walls or bodies go or come, or springs change, are in
/// EnergyLedger::work_of_stages. motions(), velocities() and body_contacts() number all bodies of the run.
class StagedSimulation final : public AnySimulation {
 public:
  /// \param stages at least one
  /// \param options a reference length of 0 is that of the first scene, in all stages
  /// \throws Error as check(stages, options), and as GrainSimulation and make_bonds for the first stage
  StagedSimulation(std::vector<GrainStage> stages, const GrainOptions& options);

  /// The simulation of the present stage; it counts the bodies that are there.
  [[nodiscard]] const GrainSimulation& present() const { return present_; }
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
  [[nodiscard]] std::int64_t step() const override { return present_.step(); }
  [[nodiscard]] std::int64_t milestone() const override;
  [[nodiscard]] bool over() const override;
  /// One for each body of the run; not_there: those that are gone, or come later.
  [[nodiscard]] std::vector<DiscMotion> motions() const override { return of_run(present_.motions()); }
  [[nodiscard]] std::vector<DiscMotion> velocities() const override { return of_run(present_.velocities()); }
  [[nodiscard]] std::vector<BodyContact> body_contacts() const override;
  [[nodiscard]] EnergyLedger energy() const override;
  [[nodiscard]] std::vector<WallState> walls() const override { return present_.walls(); }
  [[nodiscard]] std::optional<CellState> cell() const override { return present_.cell(); }
  [[nodiscard]] double bytes_per_body() const override { return present_.bytes_per_body(); }
  /// Arrays of the present GrainSimulation; stages: reports, a row for each stage that has begun; of the start of the
  /// present stage: stage_walls (places), stage_cell, stage_bodies; stage_order: of the bodies in the loops;
  /// stage_bonds: made so far; stage_breaks: of bonds whose bodies are gone; stage_servos: reports of stages that are
  /// over; stage_idle: choices that held no body; stage_energies.
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
  [[nodiscard]] GrainScene scene_of(std::span<const StageReport> reports, const Start& start, const Bonds& bonds) const;
  [[nodiscard]] std::size_t stage_of_servo(std::size_t stage, std::size_t wall) const;
  [[nodiscard]] std::size_t stage_of_stress(std::size_t stage, bool CellServo::*goes_on) const;
  [[nodiscard]] Start start_of_first() const;
  [[nodiscard]] Bonds bonds_at_start() const;
  /// The bonds with those that a stage makes.
  [[nodiscard]] Bonds bonds_of(std::size_t stage, Bonds bonds, const Start& start,
                               std::span<const GrainContact> contacts, std::span<const std::int32_t> origins) const;
  [[nodiscard]] Bonds bonds_in(const SavedState& state, std::size_t begun) const;
  [[nodiscard]] Start start_in(const SavedState& state, std::size_t begun) const;
  void begin_stage();
  [[nodiscard]] std::vector<BondBreak> breaks_of_others(const std::vector<std::int32_t>& left) const;
  void look_for_end();
  [[nodiscard]] bool holds(const StageEnd& end);
  [[noreturn]] void refuse_endless() const;

  /// At the start of the run; up to the present stage. J
  struct Energies {
    double initial = 0, potential = 0, changes = 0;
  };

  std::vector<GrainStage> stages_;
  GrainOptions options_;
  Effects effects_;
  Start start_;  ///< of the present stage
  Bonds bonds_;
  GrainSimulation present_;
  std::vector<StageReport> reports_;
  std::vector<BondBreak> past_breaks_;  ///< of bonds whose bodies are gone
  Energies energies_;
};

}  // namespace equidem
