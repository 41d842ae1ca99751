// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Files of a run whose process dies, and of the one that goes on.
#include "equidem/output/run/run_loop.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/stages/staged_simulation.hpp"

#include "grains/scenes.hpp"
#include "output/runs.hpp"
#include "support/catch.hpp"
#include "support/temporary_folder.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Dies where its state is to be saved for the n-th time.
class Dying final : public AnySimulation {
 public:
  Dying(StagedSimulation& of, int saves)
      : AnySimulation(BodyFamily::colliding, of.time_step()), of_(of), left_(saves) {}

  [[nodiscard]] const Effects& effects() const override { return of_.effects(); }
  void advance(std::int64_t steps) override { of_.advance(steps); }
  [[nodiscard]] std::int64_t step() const override { return of_.step(); }
  [[nodiscard]] std::int64_t milestone() const override { return of_.milestone(); }
  [[nodiscard]] bool over() const override { return of_.over(); }
  [[nodiscard]] std::vector<DiscMotion> motions() const override { return of_.motions(); }
  [[nodiscard]] std::vector<DiscMotion> velocities() const override { return of_.velocities(); }
  [[nodiscard]] std::vector<BodyContact> body_contacts() const override { return of_.body_contacts(); }
  [[nodiscard]] EnergyLedger energy() const override { return of_.energy(); }
  [[nodiscard]] std::vector<WallState> walls() const override { return of_.walls(); }
  [[nodiscard]] double bytes_per_body() const override { return of_.bytes_per_body(); }
  void restore(const SavedState& state) override { of_.restore(state); }
  [[nodiscard]] SavedState save() const override {
    if (--left_ == 0) kill(getpid(), SIGKILL);
    return of_.save();
  }

 private:
  StagedSimulation& of_;
  mutable int left_;
};

/// Three stages; the second changes a wall, bonds discs and adds one.
struct StagedRun {
  GrainScene scene = busy_box(NormalLaw::linear_dashpot, 4, 3, 5);
  GrainOptions options = options_of(NormalLaw::linear_dashpot, 4e-3);
  std::vector<GrainStage> stages;
  Assembly discs;

  StagedRun() {
    for (Wall& wall : scene.walls) wall.move_x = wall.move_y = {};
    for (const char* name : {"a", "b", "c"}) stages.push_back({.name = name, .scene = scene, .steps = 30});
    stages[1].scene.walls[0].move_x = {Schedule::Kind::sine, 0.1, 0, 0, 0.5};
    stages[1].bonds = StageBonds{.gap_tolerance = 0.2, .like = {.normal_dashpot = 1, .normal_spring = 300}};
    stages[2].scene.walls.pop_back();
    stages[2].bodies.added = {ball({2, 9}, 0.3)};
    for (const Grain& grain : scene.grains)
      discs.centres.push_back(grain.position), discs.radii.push_back(grain.radius);
    discs.centres.push_back({2, 9}), discs.radii.push_back(0.3);
  }
  /// \param dies at that save; 0: never
  void go(const std::filesystem::path& folder, bool resume, int dies = 0) const {
    StagedSimulation simulation(stages, options);
    Dying dying(simulation, dies);
    std::vector<std::int32_t> all;
    for (std::size_t k = 0; k < discs.size(); ++k) all.push_back(static_cast<std::int32_t>(k));
    RunResult result;
    run_through(dying,
                {.steps = 90,
                 .time_step = options.time_step,
                 .case_text = "case",
                 .frame_interval = 10 * options.time_step,
                 .probe_interval = 5 * options.time_step,
                 .checkpoint_interval = 0,
                 .frame_discs = &discs,
                 .frames = {.travelling = true, .contacts = true},
                 .probes = {{.name = "all",
                             .bodies = all,
                             .quantities = {ProbeQuantity::position, ProbeQuantity::stress},
                             .box = Rectangle{{0, 0}, {4, 3}}}},
                 .walls = names_of(scene.walls),
                 .milestone_name = [&] { return simulation.reports().back().name; },
                 .samples = 8,
                 .film_frames = 4},
                {.folder = folder, .overwrite = true, .resume = resume}, result);
  }
};

/// Every file, of checkpoints the arrays but the counters of work.
std::map<std::string, std::string> contents_of(const std::filesystem::path& folder) {
  std::map<std::string, std::string> contents;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    const std::string name = std::filesystem::relative(entry.path(), folder).string();
    std::string& text = contents[name];
    if (!name.ends_with(".checkpoint.h5")) {
      text = read_file(entry.path());
      continue;
    }
    const Checkpoint checkpoint = read_checkpoint(entry.path(), "case");
    text = fmt::format("step {}, {} samples, {} pictures\n", checkpoint.state.step, checkpoint.record.energies.size(),
                       checkpoint.record.film.size());
    for (const SavedArray& array : checkpoint.state.arrays)
      if (array.name != "counters") text += fmt::format("{} {}\n", array.name, fmt::join(array.values, " "));
    for (const FileMark& mark : checkpoint.files)
      text += fmt::format("{} {} {}\n", mark.name, mark.length, mark.checksum);
  }
  return contents;
}

std::string differences(const std::map<std::string, std::string>& a, const std::map<std::string, std::string>& b) {
  std::set<std::string> names;
  for (const auto* files : {&a, &b})
    for (const auto& [name, text] : *files)
      if (!a.contains(name) || !b.contains(name) || a.at(name) != b.at(name)) names.insert(name);
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

TEST_CASE("a_run_in_stages_that_dies_at_any_of_its_checkpoints_goes_on_to_the_same_files_and_no_others") {
  const StagedRun run;
  const TemporaryFolder whole;
  run.go(whole.path(), false);
  const auto expected = contents_of(whole.path());
  CHECK(expected.contains("run.a.checkpoint.h5"));
  CHECK(expected.contains("run.b.checkpoint.h5"));
  int deaths = 0;
  for (int first = 1;; ++first) {
    const TemporaryFolder folder;
    const auto die = [&](bool resume, int saves) {
      const pid_t child = fork();
      if (child == 0) {
        run.go(folder.path(), resume, saves);
        _exit(0);
      }
      int status = 0;
      waitpid(child, &status, 0);
      return WIFSIGNALED(status);
    };
    const auto can_resume = [&] { return std::filesystem::exists(folder / "run.checkpoint.h5"); };
    if (!die(false, first)) break;
    ++deaths;
    CAPTURE(first);
    CHECK(can_resume() == (first > 1));
    if (first % 3 == 0) die(can_resume(), 2);  // and once more
    // what a kill in the middle of a write leaves, and who locks the folder removes
    for (const std::string name : {"frames.pvd", "run.checkpoint.h5", "run.a.checkpoint.h5", "run.b.checkpoint.h5"})
      if (!name.starts_with("run.") || name == "run.checkpoint.h5" || !std::filesystem::exists(folder / name))
        std::ofstream(folder / (name + ".equidem.999999999.part")) << "half";
    remove_abandoned_files(folder.path());
    run.go(folder.path(), can_resume());
    CHECK(differences(expected, contents_of(folder.path())) == "");
  }
  CHECK(deaths > 10);
}
