// SPDX-License-Identifier: GPL-3.0-or-later
#include "laws.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "equidem/contact/exact_contact.hpp"
#include "equidem/contact/laws/normal_law.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"

#include "contender.hpp"
#include "scenes.hpp"
#include "variants.hpp"

namespace equidem::bench {
namespace {

constexpr double restitution = 0.7;

/// A contact at the start of a step.
struct State {
  double depth, closing;
  bool first;
};

template <class Law>
struct Force {
  double a;
  double c = Law::dissipation(restitution, ContactEnd::at_zero_overlap) * std::sqrt(a);
  ContactStep operator()(const State& s) const { return force_step<Law>(s.depth, s.closing, a, c, true); }
};
template <class Law>
struct Map {
  ContactStep operator()(const State& s) const { return Law::step(s.depth, s.closing, 0.1, restitution, s.first); }
};
/// In units of reduced mass, step and d_c.
struct ExactFlow {
  ExactPair pair;
  explicit ExactFlow(double a)
      : pair(exact_pair(1, a, damping_ratio_of(restitution, ContactEnd::at_zero_force), ContactEnd::at_zero_force, 1)) {
  }
  ContactStep operator()(const State& s) const {
    const ExactStep step = exact_step(pair, s.depth, s.closing, !s.first, 0, 0);
    return {step.touching_at_end ? 0 : 4, -step.impulse, 0, step.loss + step.released};
  }
};

/// All steps of impacts, mixed.
template <class Law>
std::vector<State> stream_of(const Law& law, int impacts) {
  constexpr bool exact = std::is_same_v<Law, ExactFlow>;
  Random random(1);
  std::vector<State> states;
  for (int k = 0; k < impacts; ++k) {
    const double speed = random.uniform(0.5e-3, 1.5e-3);
    const double depth = speed * random.uniform();
    // X begins in the step that the bodies meet in, the others in the next one
    State state{exact ? depth - speed : depth, speed, true};
    for (;;) {
      states.push_back(state);
      const ContactStep step = law(state);
      const double closing = state.closing + step.change;
      // force of X: it displaces by its moment; half the change is near enough for a stream
      state = {state.depth + step.shift + (exact ? 0.5 * (state.closing + closing) : closing), closing, false};
      if (exact ? step.mode == 4 : state.depth <= 0) break;
    }
  }
  for (std::size_t k = states.size(); k > 1; --k) std::swap(states[k - 1], states[random.bits() % k]);
  return states;
}

/// Keeps what is measured alive.
volatile double sink = 0;

template <class Law>
void add(std::vector<Entry>& entries, std::vector<double>& sizes, const std::string& name, const Law& law,
         int impacts) {
  std::vector<State> states = stream_of(law, impacts);
  sizes.push_back(static_cast<double>(states.size()));
  entries.push_back({name, [law, states = std::move(states)](std::int64_t passes) {
                       double sum = 0;
                       for (std::int64_t p = 0; p < passes; ++p) {
                         for (const State& state : states) {
                           const ContactStep step = law(state);
                           sum += step.change + step.shift + step.loss;
                         }
                       }
                       sink = sum;
                     }});
}

Range scaled(const Seconds& seconds, double scale) {
  std::vector<double> values;
  for (const double s : seconds) values.push_back(s * scale);
  return range_of(std::move(values));
}

std::string text(const Range& range, const char* digits) {
  const auto one = [&](double value) { return fmt::format(fmt::runtime(digits), value); };
  return one(range.median) + " (" + one(range.smallest) + " .. " + one(range.largest) + ")";
}

}  // namespace

std::string compare_laws(int impacts, int rounds) {
  std::vector<Entry> entries;
  std::vector<double> sizes;
  add(entries, sizes, "C", Force<laws::LinearDashpot>{0.1}, impacts);
  add(entries, sizes, "T", Force<laws::HertzDashpot>{4.62}, impacts);
  add(entries, sizes, "F", Map<laws::FiveCaseMap>{}, impacts);
  add(entries, sizes, "P", Map<laws::EnergyMap>{}, impacts);
  add(entries, sizes, "X", ExactFlow(0.1), impacts);
  add(entries, sizes, "X, a = 4", ExactFlow(4), impacts);
  add(entries, sizes, "X, a = 1000", ExactFlow(1000), impacts);
  constexpr std::int64_t passes = 20;
  const std::vector<Seconds> seconds = take_turns(entries, passes, rounds);
  std::string table =
      "| law | steps in an impact | ns per evaluation | over C | ns per impact | over C |\n|---|---|---|---|---|---|\n";
  const double per_c = range_of(seconds[0]).median;
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const Range each = scaled(seconds[k], 1e9 / (static_cast<double>(passes) * sizes[k]));
    Range over = ratio_of(seconds[k], seconds[0]);
    for (double* value : {&over.median, &over.smallest, &over.largest}) *value *= sizes[0] / sizes[k];
    const double per_impact = range_of(seconds[k]).median;
    table += fmt::format("| {} | {:.2f} | {} | {} | {:.0f} | {:.2f} |\n", entries[k].label, sizes[k] / impacts,
                         text(each, "{:.1f}"), text(over, "{:.2f}"),
                         1e9 * per_impact / static_cast<double>(passes * impacts), per_impact / per_c);
  }
  return table;
}

std::string compare_in_simulation(const std::string& scene, int rounds) {
  constexpr std::int64_t steps = 100;
  constexpr int side = 50, discs = side * side;
  std::vector<GrainSimulation> simulations;
  std::vector<std::string> names;
  std::string failed;
  for (const Variant& variant : variants()) {
    if (variant.dimensionless > 100 || variant.dimensionless < 0.1) continue;
    if (scene == "bed" && variant.law == NormalLaw::exact_flow && variant.dimensionless > 1) continue;
    const GrainScene discs_in_box =
        scene == "gas" ? gas(discs, 0.6, pair_of(variant, 1)) : packed_bed(side, side, pair_of(variant, 0.7));
    GrainSimulation simulation = start(discs_in_box, variant, scene == "gas" ? 2e-3 : 1e-3);
    const double energy = simulation.energy().kinetic + simulation.energy().elastic_normal;
    std::string fate;
    try {
      simulation.advance(500);  // away from the grid, or to rest
      const double moving = simulation.energy().kinetic;
      if (moving > 10 * energy) fate = fmt::format("moves with {:.2g} times the energy that it had", moving / energy);
    } catch (const Error&) {
      fate = fmt::format("is refused at step {}", simulation.step());
    }
    if (!fate.empty()) {
      failed += fmt::format("\n{} does not hold them: within 500 steps the scene {}.\n", variant.name, fate);
      continue;
    }
    simulations.push_back(std::move(simulation));
    names.push_back(variant.name);
  }
  std::vector<Entry> entries;
  std::vector<std::int64_t> before;
  for (std::size_t k = 0; k < names.size(); ++k) {
    GrainSimulation& simulation = simulations[k];
    before.push_back(simulation.counters().evaluations);
    entries.push_back({names[k], [&simulation](std::int64_t n) { simulation.advance(n); }});
  }
  const std::vector<Seconds> seconds = take_turns(entries, steps, rounds);
  std::string table =
      "| law | evaluations per disc and step | ns per disc and step | over C | bytes per disc "
      "|\n|---|---|---|---|---|\n";
  constexpr auto disc_steps = static_cast<double>(discs * steps);
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto evaluations = static_cast<double>(simulations[k].counters().evaluations - before[k]);
    table += fmt::format("| {} | {:.3f} | {} | {} | {:.0f} |\n", names[k], evaluations / (disc_steps * (rounds + 1)),
                         text(scaled(seconds[k], 1e9 / disc_steps), "{:.1f}"),
                         text(ratio_of(seconds[k], seconds[0]), "{:.2f}"), simulations[k].bytes_per_body());
  }
  table += failed;
  return table;
}

}  // namespace equidem::bench
