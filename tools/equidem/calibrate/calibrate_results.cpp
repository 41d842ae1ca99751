// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibrate/calibrate_results.hpp"

#include <cmath>

#include "equidem/core/text.hpp"
#include "equidem/material/wave_speed_springs.hpp"
#include "equidem/waves/vibration.hpp"

#include "calibrate/engine_table.hpp"

namespace equidem {
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
