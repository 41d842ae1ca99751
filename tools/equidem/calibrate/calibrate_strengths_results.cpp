// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibrate/calibrate_strengths_results.hpp"

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// The second strength beside the tensile one.
struct SecondStrength {
  std::string key, name, unit, unit_of_ratio;
};

SecondStrength second_of(const StrengthTargets& wanted) {
  if (wanted.compressive) return {"compressive", "compressive", "Pa", ""};
  return {"toughness", "toughness", "Pa sqrt(m)", "sqrt(m)"};
}

void add_error(Results& out, const std::string& key, double error, const std::string& unit) {
  if (std::isfinite(error)) {
    out.add(key, "+-", error, unit, {.digits = 2});
  } else {
    out.set(key, nullptr);
  }
}

void add_wanted_strengths(Results& out, const StrengthTargets& wanted) {
  const SecondStrength second = second_of(wanted);
  out.line("wanted")
      .add("target/tensile", "tensile", wanted.tensile, "Pa")
      .add("target/" + second.key, second.name, wanted.second(), second.unit)
      .add("target/strength_ratio", "ratio", wanted.second() / wanted.tensile, second.unit_of_ratio);
}

void add_tests(Results& out, const StrengthTargetCase& target, const StrengthSample& sample,
               const StrengthCalibration& found) {
  const std::string how = fmt::format(
      "ends along {} moved apart{}, {} plates, until the load has fallen to {:g} % of its peak",
      to_string(target.test.axis), target.wanted.compressive ? " and together" : ", without and with notches",
      to_string(target.test.ends), 100 * target.test.fallen_to);
  out.line("tests", how);
  out.line("").add("width", "width", sample.width(), "m").add("tests", "", found.tests, "test", {Shown::count});
  out.add("sample_count", "of", std::ssize(found.samples), "sample", {Shown::count});
  if (found.samples.size() == 1)
    out.line("", "one sample: neither the assembly nor the strengths are random, or one was asked for: no scatter");
}

void add_found_strengths(Results& out, const StrengthCalibration& found, const StrengthTargetCase& target,
                         BondLength length) {
  const std::string unit = length == BondLength::none ? "N/m" : "Pa";
  out.line("contacts").add("contact_strength/tension", "tension", found.tension, unit, {.digits = 9});
  add_error(out, "contact_strength/tension_error", found.tension_error, unit);
  out.line("").add("contact_strength/shear", "shear", found.shear, unit, {.digits = 9});
  add_error(out, "contact_strength/shear_error", found.shear_error, unit);
  out.add("contact_strength/shear_over_tension", "shear over tension", found.shear / found.tension);
  out.line("").add("contact_strength/friction", "friction", found.friction, "", {.digits = 9});
  if (target.shear_over_tension) {
    add_error(out, "contact_strength/friction_error", found.friction_error, "");
  } else {
    out.note(", as given").set("contact_strength/friction_error", found.friction_error);
  }
  if (found.shear / found.tension >= largest_shear_over_tension)
    out.line("", "contacts break in tension alone: any larger strength in shear gives the same");
}

void add_mean(Results& out, const std::string& key, const std::string& name, const MeanEstimate& mean, double wanted,
              const std::string& unit) {
  const std::string place = "achieved/" + key;
  out.line(name).add(place, "", mean.mean, unit, {.digits = 9});
  add_error(out, place + "_error", mean.standard_error, unit + " (standard error)");
  if (std::isfinite(mean.standard_deviation)) {
    out.add(place + "_deviation", "samples scatter by", mean.standard_deviation, unit, {.digits = 2});
  } else {
    out.set(place + "_deviation", nullptr);
  }
  constexpr double rounding = 1e-12;
  const double off = mean.mean / wanted - 1;
  if (std::abs(off) > rounding) {
    out.add(place + "_off", "off by", off, "", {Shown::percent});
  } else {
    out.note(", as wanted").set(place + "_off", off);
  }
}

void add_reached_strengths(Results& out, const StrengthTargets& wanted, const StrengthCalibration& found) {
  const SecondStrength second = second_of(wanted);
  add_mean(out, "tensile", "tensile", found.tensile, wanted.tensile, "Pa");
  add_mean(out, second.key, second.name, found.second, wanted.second(), second.unit);
  std::vector<Results> rows;
  for (const TestedSample& one : found.samples) {
    Results row;
    row.add("seed", "seed", static_cast<std::int64_t>(one.seed))
        .add("tensile", "tensile", one.tensile, "Pa")
        .add(second.key, second.name, one.second, second.unit)
        .add("strength_ratio", "ratio", one.second / one.tensile, second.unit_of_ratio, {.digits = 4})
        .add("events", "broken", one.events)
        .add("in_shear", "of them in shear", one.in_shear);
    rows.push_back(std::move(row));
  }
  out.table("samples", std::move(rows));
}

void add_feasible(Results& out, const StrengthTargetCase& target, const StrengthCalibration& found) {
  const SecondStrength second = second_of(target.wanted);
  const std::string unknown = target.shear_over_tension ? "friction" : "shear_over_tension";
  const auto shown = [](double ratio) {
    return std::isfinite(ratio) ? fmt::format("{:.4g}", ratio) : std::string("no bound");
  };
  out.line("feasible ratio", fmt::format("{} over tensile from {} to {}{}, for {} from {:g} to {:g}", second.name,
                                         shown(found.lowest_ratio()), shown(found.highest_ratio()),
                                         second.unit_of_ratio.empty() ? "" : " " + second.unit_of_ratio,
                                         target.shear_over_tension ? "friction" : "shear over tension",
                                         found.tried.front().value, found.tried.back().value));
  out.set("feasible_strength_ratio", std::vector<double>{found.lowest_ratio(), found.highest_ratio()},
          second.unit_of_ratio);
  std::vector<Results> tried;
  for (const TriedValue& one : found.tried)
    tried.push_back(Results().set(unknown, one.value).set("strength_ratio", one.ratio, second.unit_of_ratio));
  out.set("tried", std::move(tried));
}

}  // namespace

void add_unused(Results& out, const Case& resolved) {
  static constexpr std::array tables{"test", "support", "load", "strain"};
  std::vector<std::string> unused = resolved.headings(tables);
  if (resolved.quasistatic != QuasistaticCase{}) unused.emplace_back("[quasistatic]");
  if (!unused.empty()) out.line("not used", joined(unused) + ": the tests of [strength_target] take their place");
}

Results strength_results(const Problem& problem, const StrengthSample& first, const StrengthCalibration& found) {
  const Case& resolved = problem.resolved;
  const StrengthTargetCase& target = *resolved.strength_target;
  const StrengthOptions given = resolved.strength.value_or(StrengthOptions{});
  Results out = problem_results(problem, derive_effects(problem.assembly, problem.springs.springs, resolved.rotation));
  add_unused(out, resolved);
  add_wanted_strengths(out, target.wanted);
  add_tests(out, target, first, found);
  add_found_strengths(out, found, target, given.bond_length);
  add_reached_strengths(out, target.wanted, found);
  add_feasible(out, target, found);
  out.line("energy").add("energies/error", "in every test closed to", found.energy_error, "", {Shown::power, 1});
  return out;
}

}  // namespace equidem
