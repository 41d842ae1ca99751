// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/core/text.hpp"

#include "homogenize/homogenized.hpp"
#include "solve/report.hpp"

namespace equidem {
namespace {

constexpr double round_off = 1e-12;

double largest_entry(const Matrix3& c) {
  double largest = 0;
  for (const auto& row : c)
    for (const double entry : row) largest = std::max(largest, std::abs(entry));
  return largest;
}

std::string degrees(double angle) {
  return fmt::format("{:.1f}°", angle * 180 / std::numbers::pi);
}

std::string percent(double share) {
  return share < 1e-4 ? fmt::format("{:.1e}", share) : fmt::format("{:.3g} %", 100 * share);
}

/// Rows of a matrix as lines of the report; what is round-off beside the largest entry reads as 0.
template <std::size_t N>
std::string matrix_lines(const std::string& name, const SquareMatrix<N>& c, const std::string& unit) {
  double largest = 0;
  for (const auto& row : c)
    for (const double entry : row) largest = std::max(largest, std::abs(entry));
  std::string out;
  for (std::size_t r = 0; r < N; ++r) {
    std::string line;
    for (const double entry : c[r])
      line += std::abs(entry) <= round_off * largest ? fmt::format("{:>17}", "0") : fmt::format("{:>17.9g}", entry);
    out += fmt::format("{:<16}{}{}\n", r == 0 ? name : "", line, r == 0 ? "  " + unit : "");
  }
  return out;
}

std::string where_the_strain_enters(Boundary boundary) {
  switch (boundary) {
    case Boundary::periodic:
      return "periodic: the cell repeats for ever, its images move with the mean strain";
    case Boundary::displacement:
      return "displacement: the discs at the boundary follow the mean strain";
    case Boundary::traction:
      return "traction: the boundary carries the tractions of a uniform stress";
  }
  return {};
}

void append_rigidity(std::string& out, const EffectiveStiffness& r) {
  bool first = true;
  const auto line = [&](const std::string& text) {
    out += report_line(first ? "rigidity" : "", text);
    first = false;
  };
  for (const std::string& sentence : r.removed) line(sentence);
  if (r.discs_removed > 0) line("without them every force is the same, and so is the stiffness");
  for (const HarmlessMotion& motion : r.motions) line(fmt::format("{}: {}", motion.kind, motion.description));
  const auto described = static_cast<std::int64_t>(r.motions.size());
  const std::int64_t motions = r.gear_modes + r.local_mechanisms;
  if (motions > 0) {
    line(fmt::format(
        "{} without energy ({}, {}){} held: no mean strain drives {}, so the stiffness is the same",
        counted(motions, "motion"), counted(r.gear_modes, "gear mode"), counted(r.local_mechanisms, "local mechanism"),
        motions > described ? fmt::format(", {} of them named above,", described) : "", motions == 1 ? "it" : "them"));
  }
  if (r.discs_removed == 0 && motions == 0)
    line(r.unstable_modes > 0 ? "every disc carries load" : "every disc carries load, and every motion costs energy");
  if (r.self_stresses >= 0) {
    line(fmt::format("{} of self-stress: {}", counted(r.self_stresses, "independent state", "independent states"),
                     r.self_stresses == 0 ? "statically determinate, forces do not depend on the springs"
                                          : "so many springs more than rigidity needs"));
  }
  if (r.unstable_modes > 0) {
    line(fmt::format("UNSTABLE: {} by which the network would give way; this stiffness is no state of rest",
                     counted(r.unstable_modes, "mode")));
    if (r.unstable_strains > 0) {
      line(fmt::format("{} of the stiffness {} negative: such a mean strain gives energy back",
                       counted(r.unstable_strains, "eigenvalue"), r.unstable_strains == 1 ? "is" : "are"));
    }
  } else if (r.unstable_modes < 0) {
    line("stability NOT KNOWN: this solver does not count the negative pivots that would tell; method = \"auto\" does");
  }
}

void append_moduli(std::string& out, const Homogenized& h) {
  const EffectiveModuli& m = h.moduli;
  out += report_line("moduli", fmt::format("K = {:.9g} Pa (two-dimensional bulk modulus), G = {:.9g} Pa",
                                           m.bulk_modulus_2d, m.shear_modulus));
  out += report_line("  plane strain", fmt::format("nu = {:.9g}, E = {:.9g} Pa", m.poisson_strain, m.young_strain));
  out += report_line("  plane stress", fmt::format("nu = {:.9g}, E = {:.9g} Pa", m.poisson_stress, m.young_stress));
  constexpr double visible = 1e-9;
  if (m.anisotropy <= visible) {
    out += report_line("anisotropy", fmt::format("isotropic to round-off ({:.0e})", m.anisotropy));
    return;
  }
  const StiffnessAxes axes = stiffness_axes(h.result.stiffness);
  std::string line = fmt::format("isotropic to {}; the moduli are the mean over all directions", percent(m.anisotropy));
  std::string directions;
  if (axes.one_axis > visible)
    directions += fmt::format("along {} by {} (across it softer)", degrees(axes.one_direction), percent(axes.one_axis));
  if (axes.two_axes > visible) {
    directions += fmt::format("{}along {} and at right angles to it by {} (between them softer)",
                              directions.empty() ? "" : ", and ", degrees(axes.two_directions), percent(axes.two_axes));
  }
  out += report_line("anisotropy", line);
  if (!directions.empty()) out += report_line("", "stretch meets more stiffness " + directions);
}

void append_fabric(std::string& out, const Homogenized& h) {
  const Assembly& a = h.problem.assembly;
  const Fabric& f = h.fabric;
  out += report_line("fabric", fmt::format("z = {:.6g} contacts of a disc, solid fraction {:.6g}, mean branch {:.6g} m",
                                           a.coordination_number(), a.solid_fraction(), f.mean_branch));
  constexpr double visible = 1e-9;
  std::string preferred;
  if (f.anisotropy_2 > visible)
    preferred = fmt::format("one axis by {} ({})", percent(f.anisotropy_2), degrees(f.direction_2));
  if (f.anisotropy_4 > visible) {
    preferred += fmt::format("{}two axes at right angles by {} ({})", preferred.empty() ? "" : ", ",
                             percent(f.anisotropy_4), degrees(f.direction_4));
  }
  out += report_line("", preferred.empty() ? "contacts prefer no axis" : "contacts prefer " + preferred);
}

void append_table(std::string& out, const Homogenized& h) {
  out += fmt::format("\n{:<40}{:>15}{:>15}{:>12}{:>12}\n", "bounds and estimates", "K, Pa", "G, Pa", "nu strain",
                     "nu stress");
  const auto row = [&](const std::string& name, double bulk, double shear) {
    const auto ratio = [](double nu) { return fmt::format("{:>12.5f}", nu); };
    out += fmt::format("{:<40}{:>15.8g}{:>15.8g}{}{}\n", "  " + name, bulk, shear, ratio((bulk - shear) / (2 * bulk)),
                       ratio((bulk - shear) / (bulk + shear)));
  };
  const auto tensor_row = [&](const std::string& name, const Matrix3& c) {
    const EffectiveModuli m = effective_moduli(c);
    row(name, m.bulk_modulus_2d, m.shear_modulus);
  };
  std::vector<StiffnessBeside> rows = h.beside;
  rows.push_back(
      {to_string(h.result.boundary), to_string(h.result.boundary) + " <- this result", h.result.stiffness, {}});
  for (const std::string key : {"traction", "periodic", "displacement", "voigt", "uniform_stress_estimate"}) {
    for (const StiffnessBeside& one : rows) {
      if (one.key != key) continue;
      if (one.stiffness) {
        tensor_row(one.name, *one.stiffness);
      } else {
        out += report_line(one.name.substr(0, one.name.find(':')), "none: " + one.missing);
      }
    }
  }
  if (h.relation) row(h.relation->name, h.relation->bulk_modulus_2d, h.relation->shear_modulus);

  const std::vector<StiffnessBeside> order = h.ordered();
  if (order.size() > 1) {
    std::string names, margins;
    bool holds = true;
    for (std::size_t k = 0; k < order.size(); ++k) {
      names += (k == 0 ? "" : " <= ") + order[k].key;
      if (k == 0) continue;
      const double m = margin(*order[k - 1].stiffness, *order[k].stiffness);
      holds = holds && m >= -1e-9;
      margins += (k == 1 ? "" : ", ") + (std::abs(m) <= round_off ? std::string("0") : fmt::format("{:.2g}", m));
    }
    out += report_line("order", fmt::format("{} as quadratic forms: {}; least eigenvalues of the differences over the "
                                            "larger: {}",
                                            names, holds ? "holds" : "BROKEN, do not trust this result", margins));
  } else if (h.problem.springs.springs.any_negative()) {
    out += report_line("order", "kT < 0: energies are no minima, and nothing above is a bound");
  }
}

void append_restrained(std::string& out, const EffectiveStiffness& r) {
  const DisplacementOperator o = displacement_operator(r);
  out += "\nrotation restrained: moments hold the discs, and the stress is not symmetric\n";
  out += matrix_lines("  stress of", r.gradient_stiffness, "Pa");
  out += report_line("  gradients",
                     fmt::format("rows s_xx, s_yy, s_xy, s_yx, columns u_x,x u_y,y u_x,y u_y,x; |s_xy - s_yx| is up "
                                 "to {} of the largest entry",
                                 percent(r.stress_asymmetry)));
  std::string seen = fmt::format("G' = {:.9g} Pa, K' = {:.9g} Pa", o.shear_modulus, o.bulk_modulus_2d);
  if (o.bulk_modulus_2d > 0)
    seen +=
        fmt::format(", nu' = {:.6g} in plane strain", (o.bulk_modulus_2d - o.shear_modulus) / (2 * o.bulk_modulus_2d));
  out += report_line("  displacements", "see " + seen + " (hexagonal lattice: Abe 1996, eq. 53)");
  out += report_line("",
                     "These fit wave speeds and problems in which all of the boundary is displaced, not the stress: a "
                     "uniaxial test still shows the moduli of the table above, nu = (1 - kT/kN)/4 on the hexagonal "
                     "lattice, and the antisymmetric stress needs moments that a body without them does not have.");
}

}  // namespace

std::string describe_homogenized(const Homogenized& h) {
  const EffectiveStiffness& r = h.result;
  std::string out = report_line("mean strain", where_the_strain_enters(r.boundary));
  if (!h.problem.assembly.periodic()) {
    out += report_line("",
                       "A free sample lacks the contacts across its boundary: it is softer than its bulk by about the "
                       "share of the cells there.");
  }
  std::string unused;
  for (const char* table : {"test", "support", "load"}) {
    const TomlValue* given = h.problem.resolved.document.find(table);
    if (given != nullptr)
      unused += fmt::format("{}{}", unused.empty() ? "" : ", ",
                            given->is_array() ? fmt::format("[[{}]]", table) : fmt::format("[{}]", table));
  }
  if (!unused.empty()) out += report_line("not used", unused + ": the mean strain takes their place");
  append_rigidity(out, r);
  out += "\n" + matrix_lines("stiffness", r.stiffness, "Pa");
  const double largest = largest_entry(r.stiffness);
  out += report_line("", "rows: stress, columns: strain, both xx, yy, xy with engineering shear");
  out +=
      report_line("error bound",
                  fmt::format("{:.1e} Pa for an entry, {:.0e} of the largest: residual {:.1e}, condition {:.1e}; "
                              "macroscopic and microscopic power differ by {:.0e}",
                              r.error_bound, r.error_bound / largest, r.relative_residual, r.condition, r.hill_mandel));
  append_moduli(out, h);
  append_fabric(out, h);
  append_table(out, h);
  if (r.effects.restrained && r.boundary != Boundary::traction) append_restrained(out, r);
  out += fmt::format("\n{}", report_line("unknowns", fmt::format("{}, solver {}, factor {}", r.unknowns, r.solver,
                                                                 readable_bytes(r.factor_bytes))));
  std::string stages;
  for (const auto& [stage, seconds] : h.times.stages())
    if (seconds >= 0.02 * h.times.total()) stages += fmt::format(", {} {:.2g} s", stage, seconds);
  return out + report_line("times", fmt::format("{:.2g} s in all{}", h.times.total(), stages));
}

}  // namespace equidem
