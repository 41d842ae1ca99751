// SPDX-License-Identifier: GPL-3.0-or-later
#include "quasistatic/quasistatic_results.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "equidem/breakage/avalanches.hpp"
#include "equidem/breakage/unbonded/unbonded_run.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/motion_description.hpp"

#include "quasistatic/quasistatic_files.hpp"

namespace equidem {
namespace {

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
void add_peak(Results& out, const BreakageScene& scene, const EventPath& run) {
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
  if (event != events.end() && (point == points.end() || size_of(*event) >= size_of(*point))) {
    add(*event);
    out.add("peak/event", "event", event - events.begin()).set("peak/stress", event->stress);
  } else if (events.size() + points.size() > 1) {
    add(*point);
    const auto leg = point - points.begin() - 1;
    out.note(leg < 0 ? ", at the start" : fmt::format(", at the end of leg {}", leg)).set("peak/event", nullptr);
    out.set("peak/stress", point->stress ? ResultValue(*point->stress) : ResultValue(nullptr));
  }
}

void add_loads(Results& out, const BreakageScene& scene, const EventPath& run) {
  add_peak(out, scene, run);
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
  if (!run.idle().empty()) {
    out.line("idle", fmt::format("{} from the start, which can carry no load", named(scene.assembly, run.idle())));
  }
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
  const std::vector<std::int32_t>& at_first = run.idle();
  const auto without = [](const std::vector<std::int32_t>& discs, const std::vector<std::int32_t>& others) {
    std::vector<std::int32_t> left;
    std::ranges::set_difference(discs, others, std::back_inserter(left));
    return left;
  };
  const std::vector<std::int32_t> untouched = run.untouched(), now = without(untouched, at_first),
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
    unknown += event.unstable_modes < 0 ? 1 : 0;
    most = std::max(most, event.unstable_modes);
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
  Results one;
  one.set("lambda", event.lambda)
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
      .set("unstable_modes", known(event.unstable_modes))
      .set("relative_residual", event.relative_residual)
      .set("ties", event.ties)
      .set("gap", event.gap)
      .set("loosened", std::vector<std::int64_t>(event.loosened.begin(), event.loosened.end()));
  return one;
}

Results curve_results(const LoadCurve& curve) {
  return Results().set("motion", curve.motion).set("load", curve.load);
}

void add_events_and_curves(Results& out, const QuasistaticOutcome& outcome, const EventPath& run) {
  std::vector<Results> events;
  for (const BreakEvent& event : run.events()) events.push_back(of_event(event, outcome.scene.path.driven_by));
  out.set("events", std::move(events));
  out.append(curve_results(curve_of(run)).under("curve"));
  out.append(curve_results(load_envelope(run)).under("load_envelope"));
  out.append(curve_results(motion_envelope(run)).under("motion_envelope"));
}

}  // namespace

Results path_results(const BreakageScene& scene, std::size_t cut, std::optional<double> residual_friction) {
  Results out;
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
  if (cut > 0) out.line("notch").add("cut_contacts", "", cut, "contact", {Shown::count}).note(" cut from the start");
  return out.set("control", to_string(path.control));
}

Results quasistatic_results(const QuasistaticOutcome& outcome, const EventPath& run) {
  const BreakageScene& scene = outcome.scene;
  const auto* const unbonded = dynamic_cast<const UnbondedRun*>(&run);
  Results out = problem_results(outcome.problem, outcome.effects);
  out.append(path_results(scene, outcome.cut, outcome.residual_friction));
  add_events(out, scene, run, unbonded == nullptr);
  add_loads(out, scene, run);
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
  add_events_and_curves(out, outcome, run);
  return out;
}

}  // namespace equidem
