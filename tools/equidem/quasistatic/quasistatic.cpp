// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem quasistatic: contacts that break one after another under a growing load.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/breakage/avalanches.hpp"
#include "equidem/breakage/breakage_run.hpp"
#include "equidem/breakage/path_numbers.hpp"
#include "equidem/breakage/unbonded/unbonded_run.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/checkpoint.hpp"
#include "equidem/statics/motion_description.hpp"
#include "equidem/statics/solver_choice.hpp"

#include "case_text.hpp"
#include "command.hpp"
#include "problem.hpp"
#include "quasistatic/quasistatic_files.hpp"
#include "state_files.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

struct QuasistaticOptions : CommonOptions {
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

bool is_frictional(const Case& resolved) {
  return resolved.strength && resolved.strength->after_breaking == AfterBreaking::frictional;
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
    effects = problem.effects();
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
  [[nodiscard]] bool frictional() const { return is_frictional(problem.resolved); }
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

std::string driving(const LoadPath& path) {
  switch (path.driven_by) {
    case DrivenBy::loads:
      return "the loads";
    case DrivenBy::motions:
      return "the motions of supports";
    case DrivenBy::strain:
      return "the mean strain";
  }
  return {};
}

/// "disc 4 at (0.1, 0.2)", "disc 4 at (0.1, 0.2) and 3 others".
std::string named(const Assembly& assembly, const std::vector<std::int32_t>& discs) {
  const std::string first = describe_disc(assembly, static_cast<std::size_t>(discs.front()));
  return discs.size() == 1 ? first : fmt::format("{} and {}", first, counted(std::ssize(discs) - 1, "other"));
}

void add_events(Results& out, const BreakageScene& scene, const EventPath& run, bool brittle) {
  const std::vector<BreakEvent>& events = run.events();
  const auto in = [&](BreakMode mode) { return std::ranges::count(events, mode, &BreakEvent::mode); };
  const std::int64_t pulled = in(BreakMode::tension), sheared = in(BreakMode::shear);
  out.line("events").add("event_count", "", std::ssize(events), brittle ? "contact" : "event", {Shown::count});
  out.note(
      brittle
          ? fmt::format(" of {} broken, {} in tension, {} in shear", scene.assembly.contacts.size(), pulled, sheared)
          : fmt::format(": {} broken in tension, {} in shear, {} opened, {} closed, {} slipped, {} stuck", pulled,
                        sheared, in(BreakMode::open), in(BreakMode::close), in(BreakMode::slip), in(BreakMode::stick)));
  out.set("broken_in_tension", pulled).set("broken_in_shear", sheared);
  const bool cut_short = run.end() == PathEnd::no_answer || run.end() == PathEnd::not_balanced ||
                         run.end() == PathEnd::load_moves_part || run.end() == PathEnd::failed;
  const std::string where = run.leg_points().empty() ? " while the dead loads were applied"
                            : cut_short              ? fmt::format(" at lambda {:.9g}", run.lambda())
                                                     : "";
  const std::string why = run.end() == PathEnd::none ? "stopped as asked" : run.why();
  out.line("", run.end() == PathEnd::none ? "not ended: " + why : "ended" + where + ": " + why);
  out.set("end", to_string(run.end())).set("ended", why).set("lambda", run.lambda());
  if (events.empty()) return;
  const auto ties = std::ranges::count_if(events, [](const BreakEvent& event) { return event.ties > 0; });
  out.set("tied_events", ties);
  if (ties > 0) {
    out.line("", brittle
                     ? fmt::format("{} would have broken at the same lambda as others: the lowest number went first",
                                   counted(ties, "contact"))
                     : fmt::format("{} at the same lambda as others", counted(ties, "event")));
  }
  const auto& first = events.front();
  out.line("first")
      .add("first_break/lambda", "lambda", first.lambda, "", {.digits = 9})
      .add("first_break/contact", "contact", first.contact)
      .note(fmt::format(" in {}", to_string(first.mode)));
}

/// The largest load of all events, of the start and of the ends of legs.
void add_peak(Results& out, const BreakageScene& scene, const EventPath& run,
              const std::optional<TestedSection>& section) {
  const std::vector<BreakEvent>& events = run.events();
  const std::vector<LegPoint> points = run.leg_points();
  const auto size_of = [](const auto& point) { return std::abs(point.load); };
  const auto event = std::ranges::max_element(events, {}, size_of);
  const auto point = std::ranges::max_element(points, {}, size_of);
  const std::string load = unit_of_load(scene.path.driven_by), motion = unit_of_motion(scene.path.driven_by);
  const auto add = [&](const auto& peak) {
    out.line("largest load")
        .add("peak/load", "", peak.load, load, {.digits = 9})
        .add("peak/motion", "at the motion", peak.motion, motion)
        .add("peak/lambda", "lambda", peak.lambda);
  };
  const auto add_stress = [&](const auto& peak) {
    if (!section) return;
    out.line("largest stress")
        .add("peak/section_stress", "", peak.load / section->width, "Pa", {.digits = 9})
        .add("peak/section_strain", "at a strain of", peak.motion / section->height);
  };
  if (event != events.end() && (point == points.end() || size_of(*event) >= size_of(*point))) {
    add(*event);
    out.add("peak/event", "event", event - events.begin()).set("peak/stress", event->stress);
    add_stress(*event);
  } else if (events.size() + points.size() > 1) {
    add(*point);
    const auto leg = point - points.begin() - 1;
    out.note(leg < 0 ? ", at the start" : fmt::format(", at the end of leg {}", leg)).set("peak/event", nullptr);
    out.set("peak/stress", point->stress);
    add_stress(*point);
  }
}

void add_loads(Results& out, const BreakageScene& scene, const EventPath& run,
               const std::optional<TestedSection>& section) {
  add_peak(out, scene, run, section);
  if (run.events().empty()) return;
  const auto avalanches = [&](const std::string& key, const std::string& name, double BreakEvent::*quantity) {
    const Avalanches found = avalanches_by(run, quantity);
    out.line(name)
        .add(key + "/count", "", found.count(), "avalanche", {Shown::count})
        .add(key + "/largest", "the largest of", found.largest, "event", {Shown::count});
  };
  avalanches("avalanches_of_load", "load control", &BreakEvent::load);
  avalanches("avalanches_of_motion", "motion control", &BreakEvent::motion);
}

void add_energies(Results& out, const EventPath& run) {
  out.line("energy")
      .add("energies/released", "released", run.ledger().released, "N")
      .add("energies/elastic", "elastic at the end", run.ledger().elastic, "N")
      .add("energies/error", "with the work closed to", run.energy_error(), "", {Shown::power, 1});
}

void add_loosened(Results& out, const BreakageScene& scene, const EventPath& run) {
  constexpr int most = 5;
  if (!run.idle().empty())
    out.line("idle", fmt::format("{} from the start, which can carry no load", named(scene.assembly, run.idle())));
  std::int64_t loosened = 0, events = 0;
  for (std::size_t k = 0; k < run.events().size(); ++k) {
    const std::vector<std::int32_t>& discs = run.events()[k].loosened;
    if (discs.empty()) continue;
    loosened += std::ssize(discs);
    if (++events > most) continue;
    out.line(events == 1 ? "came loose" : "", fmt::format("with event {}: {}", k, named(scene.assembly, discs)));
  }
  if (events > most) out.line("", fmt::format("with {}: others", counted(events - most, "further event")));
  out.set("idle_discs", std::ssize(run.idle())).set("loosened_discs", loosened);
}

/// Rattlers between frictional contacts: these may close again.
void add_let_go(Results& out, const BreakageScene& scene, const UnbondedRun& run) {
  using Discs = std::vector<std::int32_t>;
  const Discs& at_first = run.idle();
  const auto without = [](const Discs& discs, const Discs& others) {
    Discs left;
    std::ranges::set_difference(discs, others, std::back_inserter(left));
    return left;
  };
  const Discs untouched = run.untouched(), now = without(untouched, at_first),
              on_contacts = without(without(run.loose(), untouched), at_first);
  if (!at_first.empty()) out.line("idle", fmt::format("{}: nothing touched at first", named(scene.assembly, at_first)));
  if (!now.empty()) out.line("came loose", fmt::format("{}: nothing touched at the end", named(scene.assembly, now)));
  if (!on_contacts.empty()) {
    out.line(now.empty() ? "came loose" : "",
             fmt::format("{}: on contacts that carry nothing at the end", named(scene.assembly, on_contacts)));
  }
  out.set("idle_discs", std::ssize(at_first)).set("loosened_discs", std::ssize(now) + std::ssize(on_contacts));
}

/// Where all contacts are bonds: the stability of the states.
void add_stability(Results& out, const EventPath& run) {
  std::int64_t unstable = 0, unknown = 0, most = 0;
  for (const BreakEvent& event : run.events()) {
    unstable += event.unstable_modes > 0 ? 1 : 0;
    unknown += event.unstable_modes ? 0 : 1;
    most = std::max(most, event.unstable_modes.value_or(0));
  }
  out.line("stability", unstable > 0  ? fmt::format("{} with unstable modes, up to {}: not reached in a test",
                                                    counted(unstable, "state"), most)
                        : unknown > 0 ? std::string(stability_not_known)
                                      : "every state is stable while lambda is held");
  out.set("unstable_states", unstable);
}

void add_solver(Results& out, const EventPath& run) {
  const SolverReport solver = run.solver();
  out.line("residual").add("relative_residual", "at most", solver.largest_residual, "relative", {Shown::power, 1});
  out.line("solver")
      .add("solver", "", solver.name)
      .add("factorizations", "", solver.factorizations, "factorization", {Shown::count})
      .add("factor_updates", "", solver.updates, "update", {Shown::count});
  if (!run.has_history()) out.add("factorizations_for_accuracy", "of which", solver.mended, "for round-off", {});
}

Results of_event(const BreakEvent& event, DrivenBy driven_by) {
  return Results()
      .set("lambda", event.lambda)
      .set("contact", event.contact)
      .set("mode", to_string(event.mode))
      .set("stress", std::vector<double>{event.stress.xx, event.stress.yx, event.stress.xy, event.stress.yy}, "Pa",
           "stress as the contact breaks: xx, yx, xy, yy")
      .set("leg", event.leg)
      .set("load", event.load, unit_of_load(driven_by))
      .set("motion", event.motion, unit_of_motion(driven_by))
      .set("energy_before", event.energy_before)
      .set("energy_after", event.energy_after)
      .set("energy_released", event.energy_released)
      .set("unstable_modes", event.unstable_modes)
      .set("relative_residual", event.relative_residual)
      .set("ties", event.ties)
      .set("gap", event.gap)
      .set("loosened", std::vector<std::int64_t>(event.loosened.begin(), event.loosened.end()));
}

Results curve_results(const LoadCurve& curve, DrivenBy driven_by) {
  return Results()
      .set("motion", curve.motion, unit_of_motion(driven_by))
      .set("load", curve.load, unit_of_load(driven_by));
}

void add_events_and_curves(Results& out, const BreakageScene& scene, const EventPath& run) {
  std::vector<Results> events;
  const DrivenBy driven_by = scene.path.driven_by;
  for (const BreakEvent& event : run.events()) events.push_back(of_event(event, driven_by));
  out.set("events", std::move(events));
  out.append(curve_results(curve_of(run), driven_by).under("curve"));
  out.append(curve_results(load_envelope(run), driven_by).under("load_envelope"));
  out.append(curve_results(motion_envelope(run), driven_by).under("motion_envelope"));
}

Results path_results(const Sequence& sequence) {
  Results out;
  const BreakageScene scene = sequence.scene();
  const auto residual_friction = sequence.residual_friction();
  const auto [low, high] = std::ranges::minmax(scene.strengths.tension);
  const auto [low_shear, high_shear] = std::ranges::minmax(scene.strengths.shear);
  out.line("strengths", fmt::format("tension {:.4g} to {:.4g} N/m, shear {:.4g} to {:.4g} N/m, friction {:g}", low,
                                    high, low_shear, high_shear, scene.strengths.friction));
  out.set("strength/tension", std::vector<double>{low, high})
      .set("strength/shear", std::vector<double>{low_shear, high_shear});
  out.set("strength/friction", scene.strengths.friction);
  if (residual_friction) {
    out.note(fmt::format("; contacts without a bond have friction {:g}", *residual_friction));
    out.set("strength/residual_friction", *residual_friction);
  }
  const LoadPath& path = scene.path;
  std::string legs = path.legs.empty() ? ", until nothing breaks" : ", lambda from 0";
  for (const double to : path.legs) legs += fmt::format(" to {:g}", to);
  const std::string control = path.control == LoadControl::path
                                  ? "; lambda may fall from event to event"
                                  : fmt::format("; the {} does not fall while contacts break", to_string(path.control));
  out.line("path", driving(path) + " times lambda" + (path.dead ? ", beside dead loads" : "") + legs + control);
  const std::size_t cut = sequence.cut.size();
  if (cut > 0) out.line("notch").add("cut_contacts", "", cut, "contact", {Shown::count}).note(" cut from the start");
  return out.set("control", to_string(path.control));
}

Results quasistatic_results(const Sequence& sequence) {
  const BreakageScene scene = sequence.scene();
  const EventPath& run = sequence.run();
  const UnbondedRun* const unbonded = sequence.unbonded;
  Results out = problem_results(sequence.problem, sequence.effects).append(path_results(sequence));
  add_events(out, scene, run, unbonded == nullptr);
  add_loads(out, scene, run, section_of(scene.assembly, sequence.problem.supports));
  add_energies(out, run);
  if (unbonded != nullptr) {
    out.add("energies/friction", "lost by slip", run.ledger().friction, "N");
    add_let_go(out, scene, *unbonded);
    if (run.end() != PathEnd::none && run.releasing())
      out.line("state", "the last one in balance: bonds that broke still carry what they had yet to give up");
    out.set("within_a_break", run.releasing());
    if (scene.path.dead)
      out.set("dead_loads_applied", unbonded->contact_state().dead(), "",
              "share of the dead loads that act at the end");
  } else {
    add_loosened(out, scene, run);
    add_stability(out, run);
  }
  add_solver(out, run);
  add_events_and_curves(out, scene, run);
  return out;
}

/// Size and memory of a path: how many events follow is not known before.
void dry_run_path(const CommonOptions& options, Sequence& sequence) {
  Problem& problem = sequence.problem;
  problem.resolved.solver = sequence.solver();
  const double picture = bytes_of_state_picture(options, problem.resolved.output, problem.assembly);
  dry_run(options, problem, path_results(sequence), AssemblyKeys::all, {.bytes_of_picture = picture});
}

/// Whether the table of events does not hold all that is needed to go on from it: forces of frictional contacts depend
/// on the path, and frames are written of states on it.
bool keeps_state(const Case& resolved) {
  return is_frictional(resolved) || resolved.quasistatic.frame_every != 0;
}

std::string checkpoint_text(const CommonOptions& options, const Sequence& sequence) {
  return to_toml(deciding_tables(sequence.problem.resolved.document, Decided::path), *options.out);
}

/// The path so far, written whole or not at all.
void write_path_checkpoint(const CommonOptions& options, const Sequence& sequence, std::optional<EventFrames>& frames) {
  Checkpoint checkpoint;
  checkpoint.state.step = std::ssize(sequence.run().events());
  PathNumbers numbers;
  if (sequence.unbonded) sequence.unbonded->pass(numbers);
  checkpoint.state.arrays.push_back({.name = "path", .columns = 1, .values = numbers.numbers()});
  if (frames) checkpoint.files.push_back(frames->kept());
  CheckpointWriter(*options.out / path_checkpoint_name, checkpoint_text(options, sequence), true).write(checkpoint);
}

/// Goes on with an earlier computation of the same case.
/// \param note of the files that the case reads
/// \return the frames so far; none: there are none, or the path begins anew
std::optional<FileMark> resume(const CommonOptions& options, Sequence& sequence, const std::string& note) {
  const auto table = *options.out / event_table_name, text = *options.out / "case.toml";
  if (!std::filesystem::exists(table) || !std::filesystem::exists(text)) return {};
  const FreeKeysOfPath before = check_same_path(text, sequence.problem.resolved, note);
  StoredEvents stored = read_events(table, sequence.run(), sequence.scene());
  std::optional<FileMark> frames;
  const bool with_frames = sequence.problem.resolved.quasistatic.frame_every != 0;
  std::string cut = stored.cut ? "the last line is cut short; " : "";
  const std::int64_t found = std::ssize(stored.events);
  check_most_events(before, sequence.problem.resolved, found);
  std::optional<Checkpoint> kept;
  if (const auto path = *options.out / path_checkpoint_name;
      keeps_state(sequence.problem.resolved) && std::filesystem::exists(path))
    kept = read_checkpoint(path, checkpoint_text(options, sequence));
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
  bool between = true;  // two calls of advance()
  const auto save = [&] {
    if (options.out) write_samples(*options.out / event_table_name, event_table(run, sequence.scene()));
    if (options.out && between && keeps_state(sequence.problem.resolved))
      write_path_checkpoint(options, sequence, frames);
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

struct ComputedPath {
  std::string note{};  ///< of the files that the case reads
  std::optional<Sequence> sequence{};
  Stop stop{};
};

std::vector<OutputPart> output_parts(const Case& resolved, const std::shared_ptr<const ComputedPath>& path) {
  const OutputCase& wanted = resolved.output;
  const auto tell_unsaved = [=](const CommonOptions& /*into*/) {
    if (path->stop.unsaved) throw *path->stop.unsaved;
  };
  const auto write_state_at_end = [=](const CommonOptions& into) {
    const Sequence& sequence = *path->sequence;
    write_end_state(into, wanted, sequence.scene(), sequence.run().lambda(), path->stop.state);
  };
  const auto draw = [=](const CommonOptions& into) {
    const Sequence& sequence = *path->sequence;
    write_figures(into, wanted, sequence.scene(), sequence.run(), sequence.cut, sequence.problem.resolved.title,
                  section_of(sequence.problem.assembly, sequence.problem.supports));
  };
  std::vector<std::string> events{event_table_name};
  if (keeps_state(resolved)) events.emplace_back(path_checkpoint_name);
  return {{"the events", tell_unsaved, OutputPart::folder, std::move(events)},
          {"the state", write_state_at_end, OutputPart::folder, names_of_end_state(wanted)},
          case_part([=]() -> const Case& { return path->sequence->problem.resolved; }, path->note),
          {"the figures", draw, OutputPart::page, names_of_figures(wanted)}};
}

void quasistatic(QuasistaticOptions options) {
  if (options.resume) expect_folder_of(options, "the events");
  const Case resolved = read_case(options);
  if (options.resume) options.overwrite = true;
  const auto path = std::make_shared<ComputedPath>();
  if (options.out) path->note = note_of_files(resolved.document);
  const std::vector<OutputPart> parts = output_parts(resolved, path);
  expect_results(options, parts);
  const auto lock = lock_out(options);
  Sequence& sequence = path->sequence.emplace(build(resolved));
  if (options.dry_run) return dry_run_path(options, sequence);
  sequence.begin();
  std::optional<FileMark> frames;
  if (options.resume) {
    frames = resume(options, sequence, path->note);
  } else if (options.out && keeps_state(resolved)) {
    std::filesystem::remove(*options.out / path_checkpoint_name);
  }
  write_case(options, sequence.problem.resolved, path->note);
  const Stop& stop = path->stop = go(options, sequence, frames);
  const StopsHeldBack held_back(stop.interrupted);
  Results results = quasistatic_results(sequence);
  results.set("complete", !stop.interrupted && !stop.failure);
  if (options.out && !stop.state) {
    results.line("state", stop.interrupted || stop.failure ? "none is written: that behind the last event is not known"
                                                           : "none is written: what is left does not carry its loads");
  }
  deliver(options, stop.interrupted ? "interrupted" : "done", std::move(results), sequence.problem.times, parts);
  const std::int64_t events = std::ssize(sequence.run().events());
  if (stop.failure && events == 0) throw *stop.failure;  // nothing of the path is known
  if (stop.interrupted) {
    throw_stopped(options, fmt::format("{} are done", counted(events, "event")),
                  "Run the same command with --resume to go on");
  }
  hand_over(std::shared_ptr<const Assembly>(path, &sequence.problem.assembly));
}

}  // namespace

Run declare_quasistatic(CLI::App& command) {
  const auto options = std::make_shared<QuasistaticOptions>();
  add_common_options(command, *options);
  command.add_flag("--resume", options->resume, "go on behind the events that lie in --out");
  return [options] { return quasistatic(*options); };
}

}  // namespace equidem
