// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/report.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// What the inertia of K says about the answer.
std::string stability(const Problem& problem, const Equilibrium& result) {
  if (result.unstable_modes < 0) {
    return "NOT KNOWN: this solver does not count the negative pivots that would tell; method = \"auto\" does";
  }
  if (result.unstable_modes > 0) {
    return fmt::format(
        "UNSTABLE: {} beyond one for each rotation; the assembly would give way by so many modes, this "
        "equilibrium is no state of rest",
        counted(result.unstable_modes, "negative pivot"));
  }
  if (result.negative_pivots == 0) return "stable: no negative pivot";
  return fmt::format("stable: {}, one for each rotation{}", counted(result.negative_pivots, "negative pivot"),
                     problem.springs.springs.any_negative() ? " (kT < 0; static-only)" : "");
}

std::string scientific(double value) {
  return fmt::format("{:.6g}", value);
}

/// A component of a tensor; what is round-off beside the largest one reads as 0.
std::string component(double value, double largest) {
  return std::abs(value) <= 1e-12 * largest ? "0" : fmt::format("{:.6g}", value);
}

void append_stress(std::string& out, const SolvedCase& result) {
  if (!result.stress) {
    out += report_line("stress", "not known: the assembly has no cell areas");
    return;
  }
  const Tensor2& s = *result.stress;
  const double largest = std::max({std::abs(s.xx), std::abs(s.yy), std::abs(s.xy), std::abs(s.yx)});
  const auto shown = [&](double value) { return component(value, largest); };
  const bool symmetric = std::abs(asymmetry(s)) <= 1e-9 * largest;
  if (symmetric) {
    out += report_line(
        "stress", fmt::format("xx {}, yy {}, xy {} Pa, mean over the assembly", shown(s.xx), shown(s.yy), shown(s.xy)));
    return;
  }
  out += report_line("stress", fmt::format("xx {}, yy {}, xy {}, yx {} Pa, mean over the assembly", shown(s.xx),
                                           shown(s.yy), shown(s.xy), shown(s.yx)));
  out +=
      report_line("", fmt::format("not symmetric: xy - yx = {:.6g} Pa (Abe 1996, eq. 55). The moments that restrained "
                                  "rotation, supports and loads put on the discs are {:.6g} N m per m²",
                                  asymmetry(s), result.moment_per_area));
}

void append_tension(std::string& out, const Problem& problem, const SolvedCase& result) {
  const TensionResult& t = *result.tension;
  const TensionSetup& setup = *problem.tension;
  const auto theory = tension_theory(problem);
  const TomlValue& test = *problem.resolved.document.find("test");
  out += report_line("tension test",
                     fmt::format("s11 = {:.6g} Pa, height {:.6g} m, gauge \"{}\": discs {}-{} along x, {}-{} along y",
                                 t.stress.xx, setup.height, test.find("gauge")->text, setup.horizontal.first,
                                 setup.horizontal.second, setup.vertical.first, setup.vertical.second));
  out += report_line("  strain", fmt::format("e11 = {:.9g}, e22 = {:.9g}", t.strain.xx, t.strain.yy));
  const auto compared = [&](const std::string& name, double value, double expected) {
    std::string line = fmt::format("{:<14.9g}", value);
    if (theory) line += fmt::format(" theory {:<12.9g} difference {:+.2e}", expected, value - expected);
    out += report_line("  " + name, line);
  };
  compared("nu, (35)", t.poisson_ratio, theory ? theory->poisson_ratio : 0);
  compared("2G/((1-nu)kN)", t.stiffness_ratio, theory ? theory->stiffness_ratio : 0);
  out += report_line("  whole field",
                     fmt::format("nu = {:.9g}, fitted to the inner half of the block", t.fitted_poisson_ratio));
}

}  // namespace

std::string grouped(std::int64_t value) {
  std::string digits = fmt::format("{}", value);
  for (auto k = static_cast<std::ptrdiff_t>(digits.size()) - 3; k > (value < 0 ? 1 : 0); k -= 3)
    digits.insert(static_cast<std::size_t>(k), 1, ' ');
  return digits;
}

std::string report_line(const std::string& name, const std::string& value) {
  constexpr std::size_t name_width = 16, value_width = 94;
  std::string text, line = fmt::format("{:<{}}", name, name_width);
  std::size_t used = 0;
  for (std::size_t begin = 0; begin < value.size();) {
    std::size_t end = value.find(' ', begin + 1);
    if (end == std::string::npos) end = value.size();
    const std::string word = value.substr(begin, end - begin);
    if (used > 0 && used + word.size() > value_width) {
      text += line + "\n";
      line.assign(name_width, ' ');
      used = 0;
      line += word.substr(1);
    } else {
      line += word;
    }
    used += word.size();
    begin = end;
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return text + line + "\n";
}

std::string describe_problem(const Problem& problem, const Effects& effects) {
  const Assembly& a = problem.assembly;
  std::string out;
  if (!problem.resolved.title.empty()) out += problem.resolved.title + "\n\n";
  out += report_line("assembly", fmt::format("{}, {} disc{}, {} contact{}, z = {:.4g}", a.kind,
                                             grouped(static_cast<std::int64_t>(a.size())), a.size() == 1 ? "" : "s",
                                             grouped(static_cast<std::int64_t>(a.contacts.size())),
                                             a.contacts.size() == 1 ? "" : "s", a.coordination_number()));
  if (a.periodic() || !a.cell_areas.empty())
    out += report_line("", fmt::format("area {:.6g} m², solid fraction {:.6g}{}", a.area(), a.solid_fraction(),
                                       a.periodic() ? ", periodic" : ""));
  if (!a.periodic() && !a.box && !a.cell_areas.empty() && !a.sections.empty()) {
    out += report_line("",
                       "The area is that of the rectangle around the discs of equal area: the file gives no \"box\", "
                       "and the outlines of the bodies are not known.");
  }
  out += report_line("springs", problem.springs.report);
  std::string active;
  for (const Effects::Entry& entry : effects.entries)
    if (entry.active) active += (active.empty() ? "" : ", ") + entry.name;
  out += report_line("effects", active);
  for (const Effects::Entry& entry : effects.entries)
    if (!entry.active) out += report_line("", fmt::format("no {}: {}", entry.name, entry.why));
  return out;
}

std::string describe_results(const Problem& problem, std::span<const SolvedCase> results, const StageTimes& times) {
  std::string out;
  const Equilibrium& first = results.front().equilibrium;
  const Case& resolved = problem.resolved;
  if (resolved.run || !resolved.schedules.empty()) {
    out += report_line("not used",
                       "what belongs to a run: schedules (loads and supports act in full), gravity, walls, "
                       "velocities, damping");
  }
  out += report_line("unknowns", grouped(first.unknowns));
  out += report_line("solver", fmt::format("{}, {:.3g} entries in the factor ({})", first.solver, first.factor_nonzeros,
                                           readable_bytes(first.factor_bytes)));
  out += report_line("stability", stability(problem, first));
  for (const SolvedCase& result : results) {
    if (!result.name.empty()) out += fmt::format("\nload case {}\n", result.name);
    const Equilibrium& e = result.equilibrium;
    out += report_line("residual",
                       fmt::format("{:.1e} relative, after {} of refinement; {:.1e} for the motions rounded to double",
                                   e.relative_residual, counted(e.refinements, "step"), e.rounded_residual));
    if (e.condition > 0) {
      out += report_line("error bound",
                         fmt::format("{:.1e} of the motions, from the residual and a condition of about {:.1e}",
                                     e.error_bound, e.condition));
    }
    constexpr double doubtful = 1e-10;
    if (e.relative_residual > doubtful) {
      out += report_line("", "WARNING: K is nearly singular; do not trust more digits than the residual leaves");
    }
    out += report_line("energy", scientific(e.energy) + " N (J per m of depth, per m)");
    append_stress(out, result);
    if (result.tension) append_tension(out, problem, result);
  }
  // Stages that took no visible share of the time are left to the JSON.
  std::string stages;
  for (const auto& [stage, seconds] : times.stages())
    if (seconds >= 0.02 * times.total()) stages += fmt::format(", {} {:.2g} s", stage, seconds);
  out += report_line("times", fmt::format("{:.2g} s in all{}", times.total(), stages));
  return out;
}

std::string describe_estimate(const SolveEstimate& e) {
  return report_line("unknowns", grouped(e.unknowns)) +
         report_line("memory",
                     fmt::format("{} at the peak, {} of it for the factor ({:.3g} entries)",
                                 readable_bytes(e.peak_bytes), readable_bytes(e.factor_bytes), e.factor_nonzeros)) +
         report_line("work", fmt::format("{:.3g} multiplications and additions to factorize", e.operations)) +
         "nothing was solved (--dry-run)\n";
}

}  // namespace equidem
