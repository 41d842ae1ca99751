// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem quasistatic: contacts that break one after another under a growing load.
#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/breakage/breakage_run.hpp"
#include "equidem/breakage/path_numbers.hpp"
#include "equidem/breakage/unbonded/unbonded_run.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/checkpoint.hpp"
#include "equidem/statics/solver_choice.hpp"

#include "command.hpp"
#include "problem.hpp"
#include "quasistatic/quasistatic_files.hpp"
#include "quasistatic/quasistatic_results.hpp"
#include "state_files.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

struct QuasistaticOptions {
  CommonOptions common;
  bool resume = false;
};

/// Loads and supports as in solve, but bodies that hang loose stay: contacts keep their numbers.
Problem build(Case resolved) {
  Problem problem = problem_of(std::move(resolved));
  problem.breaks = true;
  add_actions(problem);
  if (problem.load_cases.size() > 1) {
    bad_input_at(problem.resolved.where("load"), "there are several load cases", "a path has one",
                 "Keep one; loads that stay are [[dead_load]]");
  }
  return problem;
}

/// Everything that a path refers to.
struct Sequence {
  Problem problem;
  Effects effects;
  ContactStrengths strengths;
  LoadPath path;
  std::vector<std::size_t> cut{};  ///< contacts across notches
  std::unique_ptr<BreakableSystem> system{};
  std::unique_ptr<EventPath> events{};
  BreakageRun* brittle = nullptr;   ///< the path of bonds that break
  UnbondedRun* unbonded = nullptr;  ///< or that of frictional contacts

  explicit Sequence(Problem given) : problem(std::move(given)) {
    using casefile::with_place;
    const Case& resolved = problem.resolved;
    const Assembly& assembly = problem.assembly;
    const ContactSprings& springs = problem.springs.springs;
    effects = derive_effects(assembly, springs, resolved.rotation);
    strengths = with_place(resolved.where("strength"),
                           [&] { return contact_strengths(assembly, resolved.strength.value_or(StrengthOptions{})); });
    cut = with_place(resolved.where("notch"), [&] { return contacts_across(assembly, resolved.notches); });
    if (frictional()) tell_forces_at_rest();
    const QuasistaticCase& wanted = resolved.quasistatic;
    const bool loaded = !problem.load_cases.front().loads.empty();
    if (frictional()) {
      for (const std::size_t contact : cut) strengths.tension[contact] = strengths.shear[contact] = 0;
      check_frictional_solver();
    }
    with_place(resolved.where("quasistatic.legs"), [&] { check_legs(wanted.legs); });
    with_place(resolved.where(resolved.material ? "material" : "springs"), [&] { check_breaking_springs(springs); });
    path = with_place(place_of_driving(), [&] {
      return make_load_path(assembly, springs, effects,
                            {.supports = problem.supports,
                             .loads = problem.load_cases.front().loads,
                             .dead_loads = resolved.dead_loads,
                             .strain = resolved.strain,
                             .control = wanted.control.value_or(!frictional() ? LoadControl::path
                                                                : loaded      ? LoadControl::load
                                                                              : LoadControl::motion),
                             .legs = wanted.legs,
                             .max_events = wanted.max_events});
    });
    if (frictional()) with_place(resolved.where("quasistatic.control"), [&] { check_control_with_friction(path); });
  }

  /// The table that drives the path, or should.
  [[nodiscard]] std::string place_of_driving() const {
    const Case& resolved = problem.resolved;
    for (const char* table : {"strain", "load", "test", "support"}) {
      if (resolved.document.find(table) != nullptr) return resolved.where(table);
    }
    return resolved.document.where();
  }
  void tell_forces_at_rest() {
    if (!carries_forces(problem.assembly)) return;
    const ContactSprings& springs = problem.springs.springs;
    problem.prestress =
        PrestressedSprings{.springs = springs,
                           .largest = largest_prestress(problem.assembly, springs),
                           .balance = balance_at_rest(problem.assembly),
                           .sentence =
                               "contacts begin with them, and open, close, stick and slip from there; the "
                               "stiffness does not turn with them"};
  }
  void check_frictional_solver() const {
    const SolverMethod method = problem.resolved.solver.method;
    if (method == SolverMethod::automatic || method == SolverMethod::umfpack) return;
    bad_input_at(problem.resolved.where("solver.method"),
                 fmt::format("contacts are frictional, and the method is {}", to_string(method)),
                 "the stiffness of contacts that slip is not symmetric, which umfpack alone factorizes",
                 "Leave out solver.method, or take \"umfpack\"");
  }
  /// With the method that the path takes.
  [[nodiscard]] SolverOptions solver() const {
    SolverOptions solver = factor_to_update(problem.resolved.solver);
    if (frictional()) solver.method = SolverMethod::umfpack;
    return solver;
  }
  [[nodiscard]] BreakageScene scene() const { return {problem.assembly, problem.springs.springs, strengths, path}; }
  [[nodiscard]] bool frictional() const {
    const auto& strength = problem.resolved.strength;
    return strength && strength->after_breaking == AfterBreaking::frictional;
  }
  /// mu of contacts without a bond; none: they are not frictional.
  [[nodiscard]] std::optional<double> residual_friction() const {
    if (!frictional()) return {};
    const StrengthOptions& strength = *problem.resolved.strength;
    return strength.residual_friction.value_or(strength.friction);
  }
  [[nodiscard]] EventPath& run() const { return *events; }
  void begin() {
    const Stopwatch watch;
    if (frictional()) {
      EquilibriumOptions wanted = problem.options();
      wanted.solver = solver();
      check_memory(estimate_solve(problem.assembly, problem.springs.springs, problem.supports, wanted),
                   wanted.solver.memory_limit);
      UnbondedOptions options{.friction = *residual_friction()};
      for (std::size_t c = 0; carries_forces(problem.assembly) && c < problem.assembly.contacts.size(); ++c)
        options.rest.push_back(force_at_rest(problem.assembly, c));
      casefile::with_place(problem.resolved.where("strength"), [&] {
        events = std::make_unique<UnbondedRun>(scene(), effects, problem.supports, std::move(options));
      });
    } else {
      system = std::make_unique<BreakableSystem>(
          breakable_network(scene(), effects, problem.supports, problem.resolved.solver));
      if (!cut.empty()) system->remove(cut);
      casefile::with_place(system->carries(0) ? problem.resolved.where("dead_load") : place_of_driving(),
                           [&] { events = std::make_unique<BreakageRun>(scene(), *system); });
    }
    brittle = dynamic_cast<BreakageRun*>(events.get());
    unbonded = dynamic_cast<UnbondedRun*>(events.get());
    problem.times.add("first state", watch.seconds());
  }
};

/// Size and memory of a path: how many events follow is not known before.
int dry_run_path(const CommonOptions& options, Sequence& sequence) {
  Problem& problem = sequence.problem;
  problem.resolved.solver = sequence.solver();
  Results further = path_results(sequence.scene(), sequence.cut.size(), sequence.residual_friction());
  const double picture = bytes_of_state_picture(options, problem.resolved.output, problem.assembly);
  deliver(options, "dry_run",
          dry_run_results(problem, further, AssemblyKeys::all, {.inertia = {}, .bytes_of_picture = picture}),
          problem.times);
  return 0;
}

/// Whether the table of events does not hold all that is needed to go on from it: forces of frictional contacts depend
/// on the path, and frames are written of states on it.
bool keeps_state(const Case& resolved) {
  const bool frictional = resolved.strength && resolved.strength->after_breaking == AfterBreaking::frictional;
  return frictional || resolved.quasistatic.frame_every != 0;
}

/// The path so far, written whole or not at all.
class PathCheckpoint {
 public:
  PathCheckpoint(const CommonOptions& options, const Sequence& sequence)
      : path_(*options.out / path_checkpoint_name),
        case_text_(deciding_keys_of_path(sequence.problem.resolved, *options.out)) {}

  void write(const Sequence& sequence, EventFrames* frames) const {
    Checkpoint checkpoint;
    checkpoint.state.step = std::ssize(sequence.run().events());
    PathNumbers numbers;
    if (sequence.unbonded) sequence.unbonded->pass(numbers);
    checkpoint.state.arrays.push_back({.name = "path", .columns = 1, .values = numbers.numbers()});
    if (frames != nullptr) checkpoint.files.push_back(frames->kept());
    CheckpointWriter(path_, case_text_, true).write(checkpoint);
  }
  /// \return none where no state was kept
  [[nodiscard]] std::optional<Checkpoint> read() const {
    if (!std::filesystem::exists(path_)) return {};
    return read_checkpoint(path_, case_text_);
  }
  void remove() const { std::filesystem::remove(path_); }

 private:
  std::filesystem::path path_;
  std::string case_text_;
};

/// Goes on with an earlier computation of the same case.
/// \return the frames so far; none: there are none, or the path begins anew
std::optional<FileMark> resume(const CommonOptions& options, Sequence& sequence) {
  const auto table = *options.out / event_table_name, text = *options.out / "case.toml";
  if (!std::filesystem::exists(table) || !std::filesystem::exists(text)) return {};
  const FreeKeysOfPath before = check_same_path(text, sequence.problem.resolved);
  StoredEvents stored = read_events(table, sequence.run(), sequence.scene());
  std::optional<FileMark> frames;
  const bool with_frames = sequence.problem.resolved.quasistatic.frame_every != 0;
  std::string cut = stored.cut ? "the last line is cut short; " : "";
  const std::int64_t found = std::ssize(stored.events);
  check_most_events(before, sequence.problem.resolved, found);
  std::optional<Checkpoint> kept;
  if (keeps_state(sequence.problem.resolved)) kept = PathCheckpoint(options, sequence).read();
  if (kept) {
    if (sequence.unbonded) {
      PathNumbers numbers(kept->state["path"]);
      sequence.unbonded->pass(numbers);
      numbers.check_end();
    } else {
      stored.events.resize(std::min(stored.events.size(), static_cast<std::size_t>(kept->state.step)));
    }
    const bool had_frames = std::ranges::find(kept->files, "frames.pvd", &FileMark::name) != kept->files.end();
    if (with_frames && had_frames) frames = kept->mark_of("frames.pvd");
    const std::int64_t step = sequence.unbonded ? kept->state.step : std::ssize(stored.events);
    const std::string later =
        step < found ? fmt::format(" of the {} that lie there: no later state was kept", found) : "";
    say(options, fmt::format("{}: {}going on behind {}{}", table.string(), cut, counted(step, "event"), later));
  } else if (sequence.unbonded || (with_frames && before.frame_every != 0)) {
    say(options, fmt::format("{}: {} that lie there are computed again: no state was kept yet", table.string(),
                             counted(found, "event")));
    return {};
  } else if (stored.cut) {
    say(options, fmt::format("{}: {}going on behind {}", table.string(), cut, counted(found, "event")));
  }
  if (with_frames && !frames) say(options, "frames begin here: none were kept of the path so far");
  if (sequence.brittle) sequence.brittle->resume(std::move(stored.events));
  return frames;
}

/// How a path was left.
struct Stop {
  bool interrupted = false;
  std::optional<Error> failure{};    ///< what ended it otherwise than by its own end
  std::optional<PathState> state{};  ///< behind the last event; none: not known
  std::optional<Error> unsaved{};    ///< why events, state or frames are not on disk
};

/// Whatever ends the path, all that was found so far stays.
/// \param from frames of the path so far
Stop go(const CommonOptions& options, Sequence& sequence, const std::optional<FileMark>& from) {
  EventPath& run = sequence.run();
  const QuasistaticCase& wanted = sequence.problem.resolved.quasistatic;
  std::optional<EventFrames> frames;
  if (options.out && wanted.frame_every > 0) frames.emplace(options, sequence.scene(), wanted.frame_every, from, run);
  std::optional<PathCheckpoint> checkpoint;
  if (options.out && keeps_state(sequence.problem.resolved)) checkpoint.emplace(options, sequence);
  bool between = true;  // two calls of advance()
  const auto save = [&] {
    if (options.out) write_samples(*options.out / event_table_name, event_table(run, sequence.scene()));
    if (checkpoint && between) checkpoint->write(sequence, frames ? &*frames : nullptr);
  };
  SavedOnTheWay saved_on_the_way(options);
  const Stopwatch watch;
  double saved = 0;
  const auto contacts = static_cast<double>(sequence.problem.assembly.contacts.size());
  const double most = wanted.max_events > 0 ? static_cast<double>(wanted.max_events) : contacts;
  const auto advance = [&] {
    between = false;
    const bool goes_on = run.advance();
    if (goes_on && frames && !run.releasing() && frames->due(run)) {
      if (const auto state = run.state()) frames->add(run, *state);
    }
    between = true;
    return goes_on;
  };
  Stop stop;
  stop.failure = failure_of([&] {
    Progress progress("breaking");
    while (advance()) {
      if (watch.seconds() - saved > sequence.problem.resolved.output.checkpoint_interval) {
        saved_on_the_way(save);
        saved = watch.seconds();
      }
      progress.update(static_cast<double>(run.events().size()) / most);
    }
  });
  stop.interrupted = stop.failure && stop.failure->kind() == ErrorKind::interrupted;
  if (stop.interrupted) stop.failure.reset();
  const StopsHeldBack held_back(stop.interrupted);
  if (stop.failure) {
    const std::string& why = stop.failure->why();
    run.fail(stop.failure->problem() + (why.empty() ? "" : ": " + why));
  }
  stop.unsaved = failure_of(save);
  if (!stop.interrupted || sequence.unbonded) stop.state = run.state();
  if (frames && !stop.unsaved) {
    stop.unsaved = failure_of([&] {
      if (!stop.interrupted && stop.state) frames->add_end(run, *stop.state);
      frames->finish();
    });
  }
  sequence.problem.times.add("events", watch.seconds());
  return stop;
}

int quasistatic(const QuasistaticOptions& given) {
  CommonOptions options = given.common;
  if (given.resume && !options.out)
    bad_input("--resume has nothing to go on from", "the events lie in the folder of --out", "Add --out DIR");
  const Case resolved = read_case(options);
  if (given.resume) options.overwrite = true;
  const OutputPlan plan(options);
  plan.expect_results();
  expect_quasistatic(plan, resolved.output, keeps_state(resolved));
  const auto lock = lock_out(options);
  const auto shared_sequence = std::make_shared<Sequence>(build(resolved));
  Sequence& sequence = *shared_sequence;
  if (options.dry_run) return dry_run_path(options, sequence);
  sequence.begin();
  std::optional<FileMark> frames;
  if (given.resume) {
    frames = resume(options, sequence);
  } else if (options.out && keeps_state(resolved)) {
    PathCheckpoint(options, sequence).remove();
  }
  write_case(options, sequence.problem.resolved);
  const Stop stop = go(options, sequence, frames);
  const StopsHeldBack held_back(stop.interrupted);
  const QuasistaticOutcome outcome{sequence.problem, sequence.effects, sequence.scene(), sequence.cut.size(),
                                   sequence.residual_friction()};
  Results results = quasistatic_results(outcome, sequence.run());
  results.set("complete", !stop.interrupted && !stop.failure);
  if (options.out && !stop.state) {
    results.line("state", stop.interrupted || stop.failure ? "none is written: that behind the last event is not known"
                                                           : "none is written: what is left does not carry its loads");
  }
  const OutputCase& wanted = sequence.problem.resolved.output;
  const auto write_state_at_end = [&](const CommonOptions& into) {
    write_end_state(into, wanted, sequence.scene(), sequence.run().lambda(), stop.state);
  };
  const auto write_case_and_figures = [shared_sequence](const CommonOptions& into) {
    const Case& kept = shared_sequence->problem.resolved;
    write_case(into, kept);
    write_figures(into, kept.output, shared_sequence->scene(), shared_sequence->run(), shared_sequence->cut,
                  kept.title);
  };
  const auto tell_unsaved = [&](const CommonOptions& /*into*/) {
    if (stop.unsaved) throw *stop.unsaved;
  };
  const std::vector<OutputPart> parts{{"the events", tell_unsaved},
                                      {"the state", write_state_at_end},
                                      {"the figures", write_case_and_figures, OutputPart::page}};
  deliver(options, stop.interrupted ? "interrupted" : "done", std::move(results), sequence.problem.times, parts);
  const std::int64_t events = std::ssize(sequence.run().events());
  if (stop.failure && events == 0) throw *stop.failure;  // nothing of the path is known
  if (stop.interrupted) {
    throw_stopped(options, fmt::format("{} are done", counted(events, "event")),
                  "Run the same command with --resume to go on");
  }
  hand_over(std::shared_ptr<const Assembly>(shared_sequence, &sequence.problem.assembly));
  return 0;
}

}  // namespace

Run declare_quasistatic(CLI::App& command) {
  const auto options = std::make_shared<QuasistaticOptions>();
  add_common_options(command, options->common);
  command.add_flag("--resume", options->resume, "go on behind the events that lie in --out");
  command.footer(
      "Examples:\n"
      "  equidem quasistatic data/cases/notched_plate.toml --out notch    curve, cracks, events.csv\n"
      "  equidem quasistatic data/cases/notched_plate.toml --set quasistatic.max_events=10 --json -\n"
      "Contacts break where their forces reach the [strength]; loads, motions of supports or the [strain] grow with\n"
      "lambda. Ctrl-C keeps what is done; --resume goes on.");
  return [options] { return quasistatic(*options); };
}

}  // namespace equidem
