// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibrate/calibrate_results.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "equidem/core/text.hpp"
#include "equidem/material/engine_springs.hpp"
#include "equidem/material/wave_speed_springs.hpp"
#include "equidem/waves/vibration.hpp"

namespace equidem {
namespace {

/// One value, or the two ends of a range.
std::string range_text(double first, double last) {
  return first == last ? fmt::format("{:.9g}", first) : fmt::format("{:.6g} .. {:.6g}", first, last);
}

Results engine_row(const std::string& engine, const std::string& normal, const std::string& tangential,
                   const std::string& unit, const std::string& note) {
  Results row;
  row.add("", "other programs, per metre of depth", "  " + engine).add("", "normal", normal);
  return row.add("", "tangential", tangential).add("", "unit", unit).note(note);
}

}  // namespace

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
  const auto pair = [&](const char* normal, const char* tangential) {
    return std::pair(fmt::format("{} = {:.9g}", normal, force * k.kN),
                     fmt::format("{} = {:.9g}", tangential, force * k.kT));
  };
  const auto [k_r, k_s] = pair("k_r", "k_s");
  const auto [kn, kt] = pair("kn", "kt");
  const auto [pfc_kn, pfc_ks] = pair("kn", "ks");
  const bool alike = least == most;
  std::vector<Results> rows;
  rows.push_back(engine_row("LAMMPS bond_coeff, bpm/rotational", k_r, k_s, "N/m",
                            "k_t = k_b = 0; contact points in the middle of the branch" + left_out));
  rows.push_back(engine_row("LAMMPS gran/hooke/history", kn, kt, "N/m", "contacts that may open" + left_out));
  rows.push_back(engine_row("YADE CohFrictMat, FrictMat",
                            fmt::format("young = {}", range_text(large.young, small.young)),
                            fmt::format("poisson = {:.9g}", small.poisson), "Pa, 1",
                            (alike ? "of both bodies"
                                   : fmt::format("young = {:.9g}/r of each body of radius r (m): one material for each "
                                                 "radius",
                                                 force * k.kN)) +
                                left_out));
  rows.push_back(engine_row("PFC linear, linearcbond", pfc_kn, pfc_ks, "N/m", "per bond" + left_out));
  rows.push_back(engine_row(
      "PFC linearpbond", fmt::format("pb_kn = {}", range_text(of_large.kN, of_small.kN)),
      fmt::format("pb_ks = {}", range_text(of_large.kT, of_small.kT)), "Pa/m",
      fmt::format(
          "per area of bond{}{}",
          alike ? ""
                : fmt::format(", kN/({0:.6g} r) and kT/({0:.6g} r) with the smaller radius r of each pair", 2 * width),
          bends ? fmt::format("; pb_rmul = {:.6g}: it resists bending as these do", width)
                : "; it also resists bending, which these springs do not")));
  out.table("", rows);
  out.set("engines/depth", engine_depth);
  out.set("engines/lammps/k_r", force * k.kN).set("engines/lammps/k_s", force * k.kT);
  out.set("engines/lammps/kn", force * k.kN).set("engines/lammps/kt", force * k.kT);
  out.set("engines/yade/young", std::vector<double>{large.young, small.young});
  out.set("engines/yade/young_times_radius", force * k.kN).set("engines/yade/poisson", small.poisson);
  out.set("engines/pfc/kn", force * k.kN).set("engines/pfc/ks", force * k.kT);
  out.set("engines/pfc/pb_kn", std::vector<double>{of_large.kN, of_small.kN});
  out.set("engines/pfc/pb_ks", std::vector<double>{of_large.kT, of_small.kT});
  if (bends) out.set("engines/pfc/pb_rmul", width);
  out.set("engines/radii", std::vector<double>{most, least});
  return out;
}

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

namespace {

std::string percent_beside(double value, double wanted) {
  constexpr double rounding = 1e-12;
  const double off = value / wanted - 1;
  return std::abs(off) < rounding ? "as wanted" : fmt::format("{:+.3g} %", 100 * off);
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
      out.line("", "WARNING: with free edges it gives way already at kT/kN near -0.26; see equidem stability");
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

/// Moduli of an assembly with their keys alone.
Results moduli_keys(const EffectiveModuli& m) {
  return moduli_results(m, "", true).set("anisotropy", m.anisotropy);
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
  out.set("mean_field/achieved", moduli_keys(m));
  out.line("",
           fmt::format("with them this assembly has G = {:.6g} Pa ({}), K = {:.6g} Pa ({}), nu = {:.6g} in plane {} "
                       "in place of {:.6g}",
                       m.shear_modulus, percent_beside(m.shear_modulus, wanted.shear_modulus), m.bulk_modulus_2d,
                       percent_beside(m.bulk_modulus_2d, wanted.bulk_modulus_2d()),
                       wanted.plane == Plane::strain ? m.poisson_strain : m.poisson_stress, to_string(wanted.plane),
                       wanted.poisson_ratio));
}

/// Density, wave speeds and the time step that it allows.
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
  const ContactSprings& springs = problem.springs.springs;
  const bool rotation = derive_effects(a, springs, problem.resolved.rotation).rotation;
  const double omega = std::sqrt(element_bound(a, springs, inertia, rotation));
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

}  // namespace

Results calibrated_results(const Problem& problem, const Calibration& found,
                           const std::optional<MeanFieldGuess>& guess) {
  const SpringConstants& k = found.springs;
  const Case& resolved = problem.resolved;
  const ElasticModuli& wanted = resolved.material->moduli;
  Results out = problem_results(problem, derive_effects(problem.assembly, problem.springs.springs, resolved.rotation),
                                AssemblyKeys::size);
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

Results feasible_results(const Problem& problem, const Calibration& range) {
  const Case& resolved = problem.resolved;
  Results out = problem_results(problem, derive_effects(problem.assembly, problem.springs.springs, resolved.rotation),
                                AssemblyKeys::size);
  add_wanted(out, resolved.material->moduli);
  add_range(out, range, resolved.material->moduli.plane);
  return out;
}

Results refusal_results(const Error& refusal) {
  return Results().line("NOT FEASIBLE", refusal.what()).set("refusal", refusal.what());
}

}  // namespace equidem
