// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem calibrate: wanted moduli -> springs, wanted strengths -> strengths of contacts.
#include "equidem/homogenize/calibrate/calibrate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "equidem/assembly/files.hpp"
#include "equidem/breakage/breakable_system.hpp"
#include "equidem/breakage/calibrate/calibrate_strength.hpp"
#include "equidem/breakage/load_path.hpp"
#include "equidem/casefile/assembly/build.hpp"
#include "equidem/casefile/assembly/case.hpp"
#include "equidem/casefile/contact_tables.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/material/spring_relations.hpp"
#include "equidem/waves/vibration.hpp"

#include "command.hpp"
#include "problem.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

constexpr double quotient_rounding = 1e-12;  // of a quotient that is 1 but for rounding

/// The second strength beside the tensile one.
struct SecondStrength {
  std::string key, unit, unit_of_ratio;
};

SecondStrength second_of(const StrengthTargets& wanted) {
  if (wanted.compressive) return {"compressive", "Pa", ""};
  return {"toughness", "Pa sqrt(m)", "sqrt(m)"};
}

void add_error(Results& out, const std::string& key, double error, const std::string& unit) {
  std::isfinite(error) ? out.add(key, "+-", error, unit, {.digits = 2}) : out.set(key, nullptr);
}

void add_wanted_strengths(Results& out, const StrengthTargets& wanted) {
  const SecondStrength second = second_of(wanted);
  out.line("wanted")
      .add("target/tensile", "tensile", wanted.tensile, "Pa")
      .add("target/" + second.key, second.key, wanted.second(), second.unit)
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
  std::isfinite(mean.standard_deviation)
      ? out.add(place + "_deviation", "samples scatter by", mean.standard_deviation, unit, {.digits = 2})
      : out.set(place + "_deviation", nullptr);
  const double off = mean.mean / wanted - 1;
  std::abs(off) > quotient_rounding ? out.add(place + "_off", "off by", off, "", {Shown::percent})
                                    : out.note(", as wanted").set(place + "_off", off);
}

void add_reached_strengths(Results& out, const StrengthTargets& wanted, const StrengthCalibration& found) {
  const SecondStrength second = second_of(wanted);
  add_mean(out, "tensile", "tensile", found.tensile, wanted.tensile, "Pa");
  add_mean(out, second.key, second.key, found.second, wanted.second(), second.unit);
  std::vector<Results> rows;
  for (const TestedSample& one : found.samples) {
    Results row;
    row.add("seed", "seed", static_cast<std::int64_t>(one.seed))
        .add("tensile", "tensile", one.tensile, "Pa")
        .add(second.key, second.key, one.second, second.unit)
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
  out.line("feasible ratio", fmt::format("{} over tensile from {} to {}{}, for {} from {:g} to {:g}", second.key,
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

/// Tells of supports, loads and paths of the case, in whose place the tests stand.
void add_unused(Results& out, const Case& resolved) {
  static constexpr std::array tables{"test", "support", "load", "strain"};
  std::vector<std::string> unused = resolved.headings(tables);
  if (resolved.quasistatic != QuasistaticCase{}) unused.emplace_back("[quasistatic]");
  if (!unused.empty()) out.line("not used", joined(unused) + ": the tests of [strength_target] take their place");
}

/// \param first sample, whose width the report tells
Results strength_results(const Problem& problem, const StrengthSample& first, const StrengthCalibration& found) {
  const Case& resolved = problem.resolved;
  const StrengthTargetCase& target = *resolved.strength_target;
  const StrengthOptions given = resolved.strength.value_or(StrengthOptions{});
  Results out = problem_results(problem, problem.effects());
  add_unused(out, resolved);
  add_wanted_strengths(out, target.wanted);
  add_tests(out, target, first, found);
  add_found_strengths(out, found, target, given.bond_length);
  add_reached_strengths(out, target.wanted, found);
  add_feasible(out, target, found);
  out.line("energy").add("energies/error", "in every test closed to", found.energy_error, "", {Shown::power, 1});
  return out;
}

/// Samples as asked for; one where neither the assembly nor the strengths are random.
std::int64_t number_of_samples(const Case& resolved) {
  const bool scattered = resolved.strength && resolved.strength->weibull_modulus;
  return resolved.assembly.random() || scattered ? resolved.strength_target->samples : 1;
}

std::vector<SeededSample> build_samples(const Problem& first) {
  Case resolved = first.resolved;
  StrengthTestOptions test = resolved.strength_target->test;
  test.rotation = resolved.rotation;
  test.solver = resolved.solver;
  const std::uint64_t seed = resolved.strength.value_or(StrengthOptions{}).seed;
  std::vector<SeededSample> samples;
  for (std::uint64_t k = 0; k < static_cast<std::uint64_t>(number_of_samples(resolved)); ++k) {
    Assembly assembly = k == 0 || !resolved.assembly.random() ? first.assembly : build_assembly(resolved);
    ContactSprings springs = k == 0 ? first.springs.springs : build_springs(resolved, assembly).springs;
    samples.push_back({StrengthSample(std::move(assembly), std::move(springs), test), seed + k});
    ++resolved.assembly.delaunay.seed;
    if (resolved.assembly.packing) ++resolved.assembly.packing->seed;
  }
  return samples;
}

void dry_run_strengths(const CommonOptions& options, Problem& problem) {
  problem.resolved.solver = factor_to_update(problem.resolved.solver);
  problem.breaks = true;
  Results results;
  add_unused(results, problem.resolved);
  const std::int64_t tests = 2 * number_of_samples(problem.resolved);
  const int at_once = static_cast<int>(std::min<std::int64_t>(thread_count(), tests));
  dry_run(options, problem, results, AssemblyKeys::size, {.at_once = at_once});
}

std::string text_of_strengths(const Case& resolved, const StrengthCalibration& found,
                              const StrengthOptions& strengths) {
  const StrengthTargets& wanted = resolved.strength_target->wanted;
  const std::string second = wanted.compressive ? fmt::format("compressive {:.6g} Pa", *wanted.compressive)
                                                : fmt::format("toughness {:.6g} Pa sqrt(m)", *wanted.toughness);
  return strength_file(
      strengths, resolved.title,
      fmt::format("Strengths of contacts for the strengths tensile {:.6g} Pa and {},\n{} of {}, along {}, {} ends. By "
                  "equidem calibrate.",
                  wanted.tensile, second, found.samples.size() > 1 ? "the means" : "those",
                  counted(std::ssize(found.samples), "sample"), to_string(resolved.strength_target->test.axis),
                  to_string(resolved.strength_target->test.ends)));
}

/// The file of what is found: the one that is named, or NOUN.toml in --out, or none.
class FoundFile {
 public:
  /// \param noun "springs", "strength"
  FoundFile(const CommonOptions& options, std::string noun, const std::optional<std::filesystem::path>& named)
      : noun_(std::move(noun)), named_(named.has_value()), path_(named) {
    if (!named_ && options.out) path_ = *options.out / (noun_ + ".toml");
  }
  [[nodiscard]] OutputPart part() const {
    const auto write = [path = path_, text = text_](const CommonOptions& into) {
      if (!text->empty()) write_file(*path, *text, into.overwrite);
    };
    OutputPart part{fmt::format("the {} file", noun_), write, named_ ? OutputPart::file : OutputPart::folder};
    if (path_) part.files.push_back(named_ ? path_->string() : path_->filename().string());
    return part;
  }
  /// What is found goes into the file, or into the report.
  void found(Results& results, std::string text) const {
    const std::string key = noun_ + "_file";
    if (!path_) {
      results.block(fmt::format("\n{0} file (--{0} FILE writes it):\n{1}\n", noun_, text)).set(key, nullptr);
      return;
    }
    results.line(noun_ + " file").add(key, "", path_->string());
    *text_ = std::move(text);
  }
  void not_found(Results& results, const std::string& why) const {
    results.line(noun_ + " file", "none: " + why).set(noun_ + "_file", nullptr);
  }
  void say_written(const CommonOptions& options) const {
    if (path_) say(options, fmt::format("{}{} written to {}", noun_, noun_.ends_with('s') ? "" : "s", path_->string()));
  }

 private:
  std::string noun_;
  bool named_;
  std::optional<std::filesystem::path> path_;
  std::shared_ptr<std::string> text_ = std::make_shared<std::string>();
};

/// What was asked for, moduli or strengths, is out of reach: `refusal`, and its line.
Results refusal_results(const Error& refusal) {
  return Results().warning("NOT FEASIBLE", refusal.what()).set("refusal", refusal.what());
}

/// With [strength_target]: wanted strengths -> strengths and friction of the contacts.
/// \param file to which they are written; none: strength.toml in --out
void calibrate_strengths(const CommonOptions& options, const std::optional<std::filesystem::path>& file, Case read) {
  if (read.material)
    bad_input_at(read.where("strength_target"), "[material] and [strength_target] are both given",
                 "strengths are calibrated for springs that are known",
                 "Calibrate the springs first, with --springs FILE, and take springs = \"FILE\" here");
  const FoundFile strengths_out(options, "strength", file);
  const auto problem_found = std::make_shared<std::optional<Problem>>();
  const std::vector<OutputPart> parts{case_part([=]() -> const Case& { return (*problem_found)->resolved; }),
                                      strengths_out.part()};
  expect_results(options, parts);
  const auto lock = lock_out(options);
  Problem& problem = problem_found->emplace(problem_of(std::move(read)));
  const Case& resolved = problem.resolved;
  casefile::with_place(resolved.where("springs"), [&] { check_breaking_springs(problem.springs.springs); });
  if (options.dry_run) return dry_run_strengths(options, problem);

  const std::string place = resolved.where("strength_target");
  Stopwatch watch;
  const std::vector<SeededSample> samples = casefile::with_place(place, [&] { return build_samples(problem); });
  problem.times.add("samples", watch.lap());
  const StrengthTargetCase& target = *resolved.strength_target;
  StrengthOptions strengths = resolved.strength.value_or(StrengthOptions{});
  Progress progress("testing");
  std::optional<Error> refusal, failure;
  const StrengthCalibration found = casefile::with_place(place, [&] {
    try {
      return calibrate_strength(samples, target.wanted,
                                {.strengths = strengths, .shear_over_tension = target.shear_over_tension},
                                [&](double share) { progress.update(share); });
    } catch (const InfeasibleStrengths& infeasible) {
      refusal = infeasible.at(place);
      return infeasible.found();
    } catch (const ErrorWith<StrengthCalibration>& ended) {
      failure = ended.at(place);
      return ended.found();
    }
  });
  problem.times.add("tests", watch.lap());
  const StopsHeldBack held_back(failure);
  strengths.tension = found.tension;
  strengths.shear = found.shear;
  strengths.friction = found.friction;
  Results results = strength_results(problem, samples.front().sample, found);
  if (refusal) results.append(refusal_results(*refusal));
  if (refusal || failure) {
    strengths_out.not_found(results, "what is above has the nearest ratio that was found");
  } else {
    strengths_out.found(results, text_of_strengths(resolved, found, strengths));
  }
  deliver(options, refusal ? "not_feasible" : "calibrated", std::move(results), problem.times, parts, failure);
  if (refusal) throw *refusal;
  strengths_out.say_written(options);
}

std::string range_text(double first, double last) {
  return first == last ? fmt::format("{:.9g}", first) : fmt::format("{:.6g} .. {:.6g}", first, last);
}

/// LAMMPS, YADE and PFC, with units, depth and what does not hold. Without a table where springs differ from contact to
/// contact or kT is negative.
/// \param bond_width as BendingOptions, of springs that bend
Results engine_springs_results(const Assembly& assembly, const ContactSprings& springs, const SpringConstants& k,
                               std::optional<double> bond_width) {
  Results out;
  if (!springs.uniform() || k.kT < 0) {
    out.line("other programs", k.kT < 0 ? "kT < 0: they have no such springs"
                                        : "springs differ from contact to contact: equidem export writes each");
    return out;
  }
  const auto [least, most] = std::ranges::minmax(assembly.radii);
  const double force = engine_depth;  // N/m of a spring of 1 Pa
  const YadeMaterial small = yade_material(k, least), large = yade_material(k, most);
  const bool bends = springs.bends() && bond_width.value_or(0) > 0;
  const double width = bends ? *bond_width : 1;  // of the bonds, over the diameter of the smaller disc
  const SpringConstants per_area{k.kN / width, k.kT / width};
  const SpringConstants of_small = pfc_parallel_bond(per_area, least, least),
                        of_large = pfc_parallel_bond(per_area, most, most);
  const std::string left_out = bends ? "; without the bending springs" : "";
  const bool alike = least == most;
  out.set("engines/depth", engine_depth);
  std::vector<Results> rows;
  const auto add = [&](const std::string& engine, const std::string& normal, const std::string& tangential,
                       const std::string& unit, const std::string& note) {
    Results& row = rows.emplace_back();
    row.add("", "other programs, per metre of depth", "  " + engine).add("", "normal", normal);
    row.add("", "tangential", tangential).add("", "unit", unit).note(note);
  };
  const auto add_forces = [&](const std::string& engine, const std::string& key, const char* normal,
                              const char* tangential, const std::string& note) {
    add(engine, fmt::format("{} = {:.9g}", normal, force * k.kN), fmt::format("{} = {:.9g}", tangential, force * k.kT),
        "N/m", note + left_out);
    out.set(fmt::format("engines/{}/{}", key, normal), force * k.kN);
    out.set(fmt::format("engines/{}/{}", key, tangential), force * k.kT);
  };
  add_forces("LAMMPS bond_coeff, bpm/rotational", "lammps", "k_r", "k_s",
             "k_t = k_b = 0; contact points in the middle of the branch");
  add_forces("LAMMPS gran/hooke/history", "lammps", "kn", "kt", "contacts that may open");
  add("YADE CohFrictMat, FrictMat", fmt::format("young = {}", range_text(large.young, small.young)),
      fmt::format("poisson = {:.9g}", small.poisson), "Pa, 1",
      (alike
           ? "of both bodies"
           : fmt::format("young = {:.9g}/r of each body of radius r (m): one material for each radius", force * k.kN)) +
          left_out);
  out.set("engines/yade/young", std::vector<double>{large.young, small.young});
  out.set("engines/yade/young_times_radius", force * k.kN).set("engines/yade/poisson", small.poisson);
  add_forces("PFC linear, linearcbond", "pfc", "kn", "ks", "per bond");
  const std::string of_pair =
      alike ? "" : fmt::format(", kN/({0:.6g} r) and kT/({0:.6g} r) with the smaller radius r of each pair", 2 * width);
  add("PFC linearpbond", fmt::format("pb_kn = {}", range_text(of_large.kN, of_small.kN)),
      fmt::format("pb_ks = {}", range_text(of_large.kT, of_small.kT)), "Pa/m",
      fmt::format("per area of bond{}{}", of_pair,
                  bends ? fmt::format("; pb_rmul = {:.6g}: it resists bending as these do", width)
                        : "; it also resists bending, which these springs do not"));
  out.set("engines/pfc/pb_kn", std::vector<double>{of_large.kN, of_small.kN});
  out.set("engines/pfc/pb_ks", std::vector<double>{of_large.kT, of_small.kT});
  if (bends) out.set("engines/pfc/pb_rmul", width);
  out.set("engines/radii", std::vector<double>{most, least});
  return out.table("", rows);
}

std::string percent_beside(double value, double wanted) {
  const double off = value / wanted - 1;
  return std::abs(off) < quotient_rounding ? "as wanted" : fmt::format("{:+.3g} %", 100 * off);
}

std::string shown_springs(const SpringConstants& k) {
  return fmt::format("kN = {:.9g} Pa, kT = {:.9g} Pa (kT/kN = {:.6g})", k.kN, k.kT, k.ratio());
}

void add_wanted(Results& out, const ElasticModuli& m) {
  const Plane other = m.plane == Plane::strain ? Plane::stress : Plane::strain;
  out.line("wanted")
      .add("target/shear_modulus", "G =", m.shear_modulus, "Pa", {.digits = 9})
      .add("target/bulk_modulus_2d", "K =", m.bulk_modulus_2d(), "Pa", {.digits = 9})
      .add("target/poisson_ratio", "nu =", m.poisson_ratio, "in plane", {.digits = 9})
      .note(" " + to_string(m.plane));
  out.set("target/plane", to_string(m.plane));
  const double nu = m.read_as(other).poisson_ratio;
  out.line("", nu > -1 ? fmt::format("the same body in plane {}: nu = {:.9g}", to_string(other), nu)
                       : fmt::format("in plane {} {}", to_string(other), no_solid));
}

void add_method(Results& out, const Calibration& found) {
  out.line("method").add("method", "", found.method);
  if (found.iterations > 0) {
    out.note(": ").add("iterations", "", found.iterations, "step", {Shown::count});
    out.add("factorizations", "", found.factorizations, "factorization", {Shown::count})
        .note(found.scanned ? " in all with a scan of the range" : " in all with the two ends of the range");
  } else {
    out.note(found.verified ? "; checked by one factorization of this cell" : "");
    out.set("iterations", found.iterations).set("factorizations", found.factorizations);
  }
  out.set("verified", found.verified);
  if (!found.verified) {
    out.line(
        "",
        "It is that of the infinite lattice: a block with free edges is softer near them, and its own stiffness is "
        "what equidem homogenize says");
    if (found.springs.kT < 0)
      out.warning("", "WARNING: with free edges it is unstable already at kT/kN near -0.26; see equidem stability");
    return;
  }
  const std::string boundary = to_string(found.achieved.boundary);
  out.set("boundary", boundary);
  if (found.achieved.boundary == Boundary::periodic) return;
  out.line("boundary",
           fmt::format("{}: the sample is not periodic, so the moduli are those of this sample with {}", boundary,
                       found.achieved.boundary == Boundary::displacement
                           ? "a uniform displacement gradient at its boundary, stiffer than the large sample"
                           : "the tractions of a uniform stress at its boundary, softer than the large "
                             "sample"));
}

void add_reached(Results& out, const Calibration& found) {
  out.append(moduli_results(found.moduli, found.verified ? "reached" : "lattice", true).under("achieved"));
  out.set("achieved/anisotropy", found.moduli.anisotropy);
  if (found.verified) {
    out.line("").add("achieved/relative_error", "relative error", found.relative_error, "", {Shown::power, 1});
  } else {
    out.set("achieved/relative_error", found.relative_error).line("", "of the lattice where it has no edges");
  }
  const double anisotropy = found.moduli.anisotropy;
  out.line("anisotropy", anisotropy < 1e-9
                             ? "none, to round-off"
                             : fmt::format("{}; the moduli are the mean over all directions", percent(anisotropy)));
  if (found.springs.kT < 0)
    out.line("statics only", "kT < 0: this equilibrium exists, and no motion of the discs is stable");
}

void add_range(Results& out, const Calibration& found, Plane wanted) {
  std::vector<std::string> ranges;
  for (const Plane plane : {Plane::strain, Plane::stress}) {
    const std::vector<double> range{found.lowest_poisson_ratio(plane), found.highest_poisson_ratio(plane)};
    ranges.push_back(fmt::format("{:.6g} to {:.6g} in plane {}", range[0], range[1], to_string(plane)));
    out.set("feasible_poisson_ratios/plane_" + to_string(plane), range);
    if (plane == wanted) out.set("feasible_poisson_ratio", range);
  }
  out.line("feasible nu", found.scanned ? "" : "at least ").note(joined(ranges) + ", without negative springs");
  out.set("scanned", found.scanned).set("monotonic", found.rising);
  if (found.iterations == 0) return;
  if (found.scanned) {
    out.line("", "These are the extremes over all kT/kN up to 1e6");
    if (!found.rising)
      out.note("; nu does not fall throughout with kT/kN here, so that other springs may give the same moduli");
    return;
  }
  out.line("", "The ends are those of tangential springs much stiffer than the normal ones, and of none; ")
      .note(found.rising ? "nu fell with kT/kN wherever it was tried"
                         : "between them nu does not always fall with kT/kN here, so other springs may give the same "
                           "moduli");
}

/// The keys of [springs] that go with a pair of constants.
Results springs_table(const Case& resolved, const SpringConstants& k) {
  Results out;
  out.set("kN", k.kN).set("kT", k.kT).set("weighting", to_string(resolved.weighting));
  if (const auto& width = resolved.bending.bond_width) out.set("bond_width", *width);
  return out;
}

void add_mean_field(Results& out, const MeanFieldGuess& guess, const Case& resolved) {
  const ElasticModuli& wanted = resolved.material->moduli;
  if (!guess.moduli) out.set("mean_field/missing", guess.missing);
  if (guess.springs.kN == 0) {
    out.line("mean field", "no springs for this: " + guess.missing);
    return;
  }
  out.append(springs_table(resolved, guess.springs).under("mean_field"));
  out.line("mean field", "Abe (1996), eqs. (21) and (22), advise " + shown_springs(guess.springs));
  if (!guess.moduli) {
    out.line("", guess.missing);
    return;
  }
  const EffectiveModuli& m = *guess.moduli;
  out.set("mean_field/achieved", moduli_results(m, "", true).set("anisotropy", m.anisotropy));
  out.line("",
           fmt::format("with them this assembly has G = {:.6g} Pa ({}), K = {:.6g} Pa ({}), nu = {:.6g} in plane {} "
                       "in place of {:.6g}",
                       m.shear_modulus, percent_beside(m.shear_modulus, wanted.shear_modulus), m.bulk_modulus_2d,
                       percent_beside(m.bulk_modulus_2d, wanted.bulk_modulus_2d()),
                       wanted.plane == Plane::strain ? m.poisson_strain : m.poisson_stress, to_string(wanted.plane),
                       wanted.poisson_ratio));
}

void add_motion(Results& out, const Problem& problem, double disc_density, const ElasticModuli& wanted) {
  const Assembly& a = problem.assembly;
  const double fraction = a.solid_fraction(), density = disc_density * fraction;
  out.line("density")
      .add("density/continuum", "", density, "kg/m³ of the continuum")
      .add("density/discs", "", disc_density, "kg/m³ of the discs, solid fraction")
      .note(fmt::format(" {:.6g}", fraction));
  if (problem.resolved.assembly.body == Body::disc) {
    const WaveSpeeds speeds = wave_speeds_of(wanted, density);
    out.line("long waves")
        .add("wave_speeds/pressure", "Vp =", speeds.pressure, "m/s")
        .add("wave_speeds/shear", "Vs =", speeds.shear, "m/s");
  }
  const std::vector<Inertia> inertia = inertia_of(a, disc_density, problem.resolved.assembly.body);
  const double omega = std::sqrt(element_bound(a, problem.springs.springs, inertia, problem.effects().rotation));
  out.line("time step")
      .add("guaranteed_step", "any below", 2 / omega, "s is stable, from the highest frequency of a single contact");
}

/// The relation for restrained rotation beside the springs of a lattice whose discs do not turn.
void add_operator(Results& out, const ElasticModuli& wanted, const SpringRelation& restrained) {
  const SpringConstants k = springs_for(wanted, restrained, {}, NegativeTangential::static_only);
  out.line("displacements", fmt::format("{} advises {}: it fits wave speeds and problems in which all of the "
                                        "boundary is displaced, not the stress, which is calibrated here",
                                        restrained.source, shown_springs(k)));
}

/// \param problem its springs are those found
Results calibrated_results(const Problem& problem, const Calibration& found,
                           const std::optional<MeanFieldGuess>& guess) {
  const SpringConstants& k = found.springs;
  const Case& resolved = problem.resolved;
  const ElasticModuli& wanted = resolved.material->moduli;
  Results out = problem_results(problem, problem.effects(), AssemblyKeys::size);
  out.set("kN", k.kN).set("kT", k.kT).set("ratio", k.ratio()).set("weighting", to_string(resolved.weighting));
  add_wanted(out, wanted);
  add_method(out, found);
  add_reached(out, found);
  add_range(out, found, wanted.plane);
  if (guess) add_mean_field(out, *guess, resolved);
  out.append(springs_table(resolved, k).under("springs"));
  if (const auto density = disc_density(resolved, problem.assembly)) {
    out.set("springs/density", *density);
    if (k.kT >= 0) add_motion(out, problem, *density, wanted);
  }
  out.append(engine_springs_results(problem.assembly, problem.springs.springs, k, problem.resolved.bending.bond_width));
  const Lattice* lattice = resolved.assembly.arrangement;
  if (lattice != nullptr && lattice->restrained != nullptr && resolved.rotation == Rotation::restrained)
    add_operator(out, wanted, *lattice->restrained);
  return out;
}

struct CalibrateVerb : CommonOptions {
  std::optional<std::filesystem::path> springs;   ///< path of the springs file
  std::optional<std::filesystem::path> strength;  ///< path of the strength file
};

CalibrateOptions calibrate_options(const Case& resolved) {
  return {.homogenize = {.boundary = resolved.homogenize.boundary.value_or(Boundary::periodic),
                         .rotation = resolved.rotation,
                         .solver = resolved.solver},
          .weighting = resolved.weighting,
          .bond_width = resolved.bending.bond_width,
          .lattice = resolved.assembly.arrangement,
          .static_only = resolved.material->static_only};
}

std::string text_of_springs(const Case& resolved, const Assembly& assembly, const Calibration& found) {
  const ElasticModuli& m = resolved.material->moduli;
  const std::string moduli =
      fmt::format("G = {:.9g} Pa and nu = {:.9g} in plane {}", m.shear_modulus, m.poisson_ratio, to_string(m.plane));
  const std::string discs =
      fmt::format("{} discs of kind {} with {} contacts", assembly.size(), assembly.kind, assembly.contacts.size());
  std::string comment;
  if (!found.verified) {
    comment = fmt::format(
        "Springs that give the infinite lattice {}.\nThe {} they were made for have free edges, and are softer.",
        moduli, discs);
  } else {
    comment =
        fmt::format("Springs that give {}, to a relative error of {:.1e},\non {}", moduli, found.relative_error, discs);
    comment += found.achieved.boundary == Boundary::periodic
                   ? "."
                   : fmt::format(" between boundaries of kind {}.", to_string(found.achieved.boundary));
  }
  return springs_file(found.springs, resolved.weighting, disc_density(resolved, assembly), resolved.bending.bond_width,
                      resolved.title, comment + fmt::format("\nBy equidem calibrate, {}.", found.method));
}

/// The case with springs that are not known yet.
Problem problem_with_material(Case resolved) {
  if (!resolved.material) {
    bad_input_at(resolved.document.where(), "there is no [material]",
                 "calibration looks for the springs that stand for it",
                 "Replace the springs by [material] with the moduli wanted, or add [strength_target]");
  }
  require_memory_for(resolved, Purpose::factorize);
  StageTimes times;
  Stopwatch watch;
  Assembly assembly = assembly_of(resolved);
  times.add("assembly", watch.lap());
  BuiltSprings unknown{ContactSprings(SpringConstants{1e9, 1e9}), {}, "not known yet"};
  return {std::move(resolved), std::move(assembly), std::move(unknown), {}, {}, {}, std::move(times)};
}

void calibrate(const CalibrateVerb& options) {
  Case read = read_case(options);
  const bool strengths = read.strength_target.has_value();
  if (options.springs && strengths)
    bad_input("--springs asks for springs, and the case for strengths", "[strength_target] takes its springs as given",
              "Leave out --springs; --strength FILE writes the strengths");
  if (options.strength && !strengths)
    bad_input("--strength asks for strengths, and the case for springs", "there is no [strength_target]",
              "Add it, or leave out --strength");
  if (strengths) return calibrate_strengths(options, options.strength, std::move(read));
  const std::string assembly_name = assembly_file_name("assembly", read.output.assembly.value_or(AssemblyFormat::json));
  const FoundFile springs_out(options, "springs", options.springs);
  const auto problem_found = std::make_shared<std::optional<Problem>>();
  const auto write = [=](const CommonOptions& into) {
    write_assembly(*into.out / assembly_name, (*problem_found)->assembly, into.overwrite);
  };
  const std::vector<OutputPart> parts{case_part([=]() -> const Case& { return (*problem_found)->resolved; }),
                                      {assembly_name, write, OutputPart::folder, {assembly_name}},
                                      springs_out.part()};
  expect_results(options, parts);
  const auto lock = lock_out(options);
  Problem& problem = problem_found->emplace(problem_with_material(std::move(read)));
  const Case& resolved = problem.resolved;
  if (options.dry_run) return dry_run(options, problem, {}, AssemblyKeys::size);

  const ElasticModuli& wanted = resolved.material->moduli;
  const CalibrateOptions how = calibrate_options(resolved);
  std::optional<Error> refusal, failure;
  const Calibration found = [&] {
    try {
      return calibrate(problem.assembly, wanted, how);
    } catch (const InfeasibleModuli& infeasible) {
      refusal = infeasible.at(resolved.where("material"));
      return infeasible.found();
    } catch (const ErrorWith<Calibration>& ended) {
      failure = ended;
      return ended.found();
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::bad_input || !error.where().empty()) throw;
      throw Error(error.kind(), error.problem(), error.why(), error.remedy(), resolved.where("material"));
    }
  }();
  if (refusal) {
    Results results = problem_results(problem, problem.effects(), AssemblyKeys::size);
    add_wanted(results, wanted);
    add_range(results, found, wanted.plane);
    deliver(options, "not_feasible", results.append(refusal_results(*refusal)), problem.times, parts);
    throw *refusal;
  }
  const bool converged = !failure;
  StageTimes times = problem.times;
  times.add(found.times);
  Stopwatch watch;
  std::optional<MeanFieldGuess> guess;
  if (converged) failure = failure_of([&] { guess = mean_field_guess(problem.assembly, wanted, how); });
  if (converged && failure)
    failure =
        Error(failure->kind(), failure->problem(), "the springs are found, and not compared with the mean field", "");
  times.add("mean field", watch.lap());
  const StopsHeldBack held_back(failure);
  problem.springs = {
      bending_springs(problem.assembly, contact_springs(problem.assembly, found.springs, resolved.weighting),
                      resolved.bending),
      found.springs,
      fmt::format("kN = {:.9g} Pa, kT = {:.9g} Pa (kT/kN = {:.9g}), weighting {}", found.springs.kN, found.springs.kT,
                  found.springs.ratio(), to_string(resolved.weighting))};
  Results results = calibrated_results(problem, found, guess);
  converged ? springs_out.found(results, text_of_springs(resolved, problem.assembly, found))
            : springs_out.not_found(results, "what is above is the best that was found");
  deliver(options, "calibrated", std::move(results), std::move(times), parts, failure);
  springs_out.say_written(options);
}

}  // namespace

Run declare_calibrate(CLI::App& command) {
  const auto options = std::make_shared<CalibrateVerb>();
  add_common_options(command, *options);
  command.add_option("--springs", options->springs, "write the springs to this file, for springs = \"FILE\"")
      ->check(file_name())
      ->type_name("FILE");
  command.add_option("--strength", options->strength, "write the strengths to this file, for strength = \"FILE\"")
      ->check(file_name())
      ->type_name("FILE");
  return [options] { return calibrate(*options); };
}

}  // namespace equidem
