// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A run that is ready to start: what bonded discs and colliding bodies each add to the common run; results, the plot,
/// the histories and the moving picture that are common to all.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/output/plots/plot.hpp"
#include "equidem/output/results.hpp"
#include "equidem/output/run/run_loop.hpp"

#include "command.hpp"

namespace equidem {

/// Error of the energy balance over the largest energy.
struct Balance {
  static constexpr double doubtful = 0.1;  ///< beyond it the motion is in doubt
  double at_end = 0;
  double most = 0;  ///< the largest during the run
};

class RunJob {
 public:
  virtual ~RunJob() = default;

  [[nodiscard]] virtual AnySimulation& simulation() = 0;
  [[nodiscard]] virtual RunPlan plan() = 0;
  [[nodiscard]] virtual const char* body_name() const = 0;  ///< "disc", "grain"
  /// Seconds of the stages before the run.
  [[nodiscard]] virtual StageTimes times() const { return {}; }

  /// Whether the answers of a test need a history, also where no file of it is wanted.
  [[nodiscard]] virtual bool needs_history() const { return false; }
  /// Title, the answers of a test, bodies, effects, law or integrator.
  /// \param history text of history.csv; empty: none was written
  [[nodiscard]] virtual Results scene(const std::string& history) const = 0;
  /// Curves of a test with their names, over its strain, the first; none: there is no test.
  [[nodiscard]] virtual std::vector<std::pair<std::string, std::vector<double>>> curves(
      const std::string& /*history*/) const {
    return {};
  }
  /// The time step and the limits that it keeps.
  [[nodiscard]] virtual Results step() const = 0;
  /// Events of the run other than energies.
  [[nodiscard]] virtual Results events() const { return {}; }
  /// Advice on the energy balance.
  [[nodiscard]] virtual Results advice(const Balance& balance) const = 0;
  /// The state at the end, plots, the case; as long as there is no state, nothing of it is written. The job and the
  /// result must stay where they are.
  [[nodiscard]] virtual std::vector<OutputPart> parts(const RunResult& result) const = 0;

  /// Memory that the picture of the end takes beside the run.
  [[nodiscard]] virtual double bytes_of_drawing() const { return 0; }

  /// Whether the case asks for relaxation in place of steps.
  [[nodiscard]] virtual bool goes_to_rest() const { return false; }
  /// Relax the scene to rest, the state that parts() then write.
  virtual Results relax(StageTimes& /*times*/) { return {}; }
};

/// The run of a case of bonded discs or of bodies that collide.
/// \param resume whether an automatic time step is that of the checkpoint in --out
/// \param begin_from checkpoint with whose state a run of grains begins
/// \throws Error (bad_input) as the readers of the cases, the constructors of the runs, and GrainRun::begin_from
std::unique_ptr<RunJob> make_run_job(const CommonOptions& options, bool resume,
                                     const std::optional<std::filesystem::path>& begin_from = {});

/// The files in --out that the steps themselves write.
std::vector<std::string> files_of_steps(const OutputCase& output);

/// "J per m of depth", "J".
const char* energy_unit(Body body);

struct EnergyCurve {
  const char* label;
  PlotColour colour;
  double (*value)(const EnergyLedger&);
};
/// NAME.{csv,gp,svg,png}: kinetic, elastic, potential and further energies that are not 0 throughout, and the error of
/// the balance, against time.
void write_energy_plot(const CommonOptions& into, const std::string& name, const std::string& title, Body body,
                       std::span<const EnergySample> energies, std::span<const EnergyCurve> further);

/// Add the film to the figures of this thread (DrawnFigures), where it has two frames at least. Displacements of bonded
/// discs are enlarged where they are too small to be seen, as in write_picture.
void add_film(const std::string& title, const Assembly& assembly, std::span<const FilmFrame> frames);
/// \param colours of each grain \param started as GrainAnimation
void add_film(const GrainCase& resolved, std::span<const Wall> walls, std::span<const int> colours,
              std::span<const Grain> started, std::span<const FilmFrame> frames);

}  // namespace equidem
