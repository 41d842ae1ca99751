// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "equidem/core/text.hpp"

#include "calibrate/calibrated.hpp"
#include "solve/report.hpp"

namespace equidem {
namespace {

std::string percent_beside(double value, double wanted) {
  constexpr double rounding = 1e-12;
  const double off = value / wanted - 1;
  return std::abs(off) < rounding ? "as wanted" : fmt::format("{:+.3g} %", 100 * off);
}

/// G >= 3K, nu <= -1 in plane strain.
constexpr const char* no_solid = "no isotropic solid has these moduli: K <= G/3";

std::string shown_springs(const SpringConstants& k) {
  return fmt::format("kN = {:.9g} Pa, kT = {:.9g} Pa (kT/kN = {:.6g})", k.kN, k.kT, k.ratio());
}

void append_wanted(std::string& out, const ElasticModuli& m) {
  const Plane other = m.plane == Plane::strain ? Plane::stress : Plane::strain;
  out += report_line("wanted", fmt::format("G = {:.9g} Pa, K = {:.9g} Pa, nu = {:.9g} in plane {}", m.shear_modulus,
                                           m.bulk_modulus_2d(), m.poisson_ratio, to_string(m.plane)));
  const double nu = m.read_as(other).poisson_ratio;
  out += report_line("", nu > -1 ? fmt::format("the same body in plane {}: nu = {:.9g}", to_string(other), nu)
                                 : fmt::format("in plane {} {}", to_string(other), no_solid));
}

void append_method(std::string& out, const Calibration& found) {
  if (found.iterations > 0) {
    out +=
        report_line("method", fmt::format("{}: {}, {} in all with {}", found.method, counted(found.iterations, "step"),
                                          counted(found.factorizations, "factorization"),
                                          found.scanned ? "a scan of the range" : "the two ends of the range"));
  } else {
    out += report_line("method", fmt::format("{}{}", found.method,
                                             found.verified ? "; checked by one factorization of this cell" : ""));
  }
  if (!found.verified) {
    out += report_line("",
                       "It is that of the infinite lattice: a block with free edges is softer near them, and its own "
                       "stiffness is what equidem homogenize says");
    if (found.springs.kT < 0)
      out +=
          report_line("", "WARNING: with free edges it gives way already at kT/kN near -0.26; see equidem stability");
  } else if (found.achieved.boundary != Boundary::periodic) {
    out += report_line(
        "boundary",
        fmt::format("{}: the sample is not periodic, so the moduli are those of this sample with {}",
                    to_string(found.achieved.boundary),
                    found.achieved.boundary == Boundary::displacement
                        ? "a uniform displacement gradient at its boundary, stiffer than the large sample"
                        : "the tractions of a uniform stress at its boundary, softer than the large sample"));
  }
}

void append_reached(std::string& out, const Calibration& found) {
  const EffectiveModuli& m = found.moduli;
  const std::string moduli = fmt::format("G = {:.9g} Pa, K = {:.9g} Pa", m.shear_modulus, m.bulk_modulus_2d);
  out += found.verified ? report_line("reached", fmt::format("{}, relative error {:.1e}", moduli, found.relative_error))
                        : report_line("lattice", moduli + ", where it has no edges");
  out += report_line("  plane strain", m.poisson_strain > -1
                                           ? fmt::format("nu = {:.9g}, E = {:.9g} Pa", m.poisson_strain, m.young_strain)
                                           : no_solid);
  out += report_line("  plane stress", fmt::format("nu = {:.9g}, E = {:.9g} Pa", m.poisson_stress, m.young_stress));
  out += report_line("anisotropy",
                     m.anisotropy < 1e-9
                         ? std::string("none, to round-off")
                         : fmt::format("{:.3g} %; the moduli are the mean over all directions", 100 * m.anisotropy));
  if (found.springs.kT < 0) {
    out += report_line("statics only", "kT < 0: this equilibrium exists, and no motion of the discs is stable");
  }
}

void append_range(std::string& out, const Calibration& found) {
  const auto range = [&](Plane plane) {
    return fmt::format("{:.6g} to {:.6g} in plane {}", found.lowest_poisson_ratio(plane),
                       found.highest_poisson_ratio(plane), to_string(plane));
  };
  const std::string ranges = range(Plane::strain) + ", " + range(Plane::stress) + ", without negative springs";
  out += report_line("feasible nu", found.scanned ? ranges : "at least " + ranges);
  if (found.iterations == 0) return;
  if (found.scanned) {
    out += report_line("", "These are the extremes over all kT/kN up to 1e6" +
                               std::string(found.rising ? ""
                                                        : "; nu does not fall throughout with kT/kN here, so that "
                                                          "other springs may give the same moduli"));
    return;
  }
  out += report_line("", "The ends are those of tangential springs much stiffer than the normal ones, and of none; " +
                             std::string(found.rising ? "nu fell with kT/kN wherever it was tried"
                                                      : "between them nu does not always fall with kT/kN here, so "
                                                        "other springs may give the same moduli"));
}

void append_mean_field(std::string& out, const Calibrated& c) {
  const MeanFieldGuess& guess = *c.mean_field;
  if (guess.springs.kN == 0) {
    out += report_line("mean field", "no springs for this: " + guess.missing);
    return;
  }
  out += report_line("mean field", "Abe (1996), eqs. (21) and (22), advise " + shown_springs(guess.springs));
  if (!guess.moduli) {
    out += report_line("", guess.missing);
    return;
  }
  const EffectiveModuli& m = *guess.moduli;
  const bool strain = c.wanted().plane == Plane::strain;
  out +=
      report_line("", fmt::format("with them this assembly has G = {:.6g} Pa ({}), K = {:.6g} Pa ({}), nu = {:.6g} in "
                                  "plane {} in place of {:.6g}",
                                  m.shear_modulus, percent_beside(m.shear_modulus, c.wanted().shear_modulus),
                                  m.bulk_modulus_2d, percent_beside(m.bulk_modulus_2d, c.wanted().bulk_modulus_2d()),
                                  strain ? m.poisson_strain : m.poisson_stress, to_string(c.wanted().plane),
                                  c.wanted().poisson_ratio));
}

/// Eq. (53) beside the springs of a lattice whose discs do not turn.
void append_operator(std::string& out, const Calibrated& c) {
  const SpringConstants k = springs_for(c.wanted(), Packing::hexagonal_restrained, {}, NegativeTangential::static_only);
  out +=
      report_line("displacements", fmt::format("eq. (53) advises {}: it fits wave speeds and problems in which all of "
                                               "the boundary is displaced, not the stress, which is calibrated here",
                                               shown_springs(k)));
}

}  // namespace

std::string describe_calibrated(const Calibrated& c) {
  std::string out;
  append_wanted(out, c.wanted());
  append_method(out, c.found);
  append_reached(out, c.found);
  append_range(out, c.found);
  if (c.mean_field) append_mean_field(out, c);
  const Case& resolved = c.problem.resolved;
  if (resolved.assembly.kind == AssemblyKind::hexagonal && resolved.rotation == Rotation::restrained) {
    append_operator(out, c);
  }
  std::string stages;
  for (const auto& [stage, seconds] : c.times.stages())
    if (seconds >= 0.02 * c.times.total()) stages += fmt::format(", {} {:.2g} s", stage, seconds);
  return out + report_line("times", fmt::format("{:.2g} s in all{}", c.times.total(), stages));
}

}  // namespace equidem
