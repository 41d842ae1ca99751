// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem homogenize: the stiffness of the continuum that an assembly stands for.
#include "homogenize/homogenize.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/homogenize/viscoelastic_stiffness.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/plots/plot.hpp"

#include "accuracy.hpp"
#include "state_files.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

constexpr const char* viscoelastic_table_name = "viscoelastic.csv";
constexpr const char* moduli_over_frequency = "moduli_over_frequency";

using Modulus = std::complex<double> HarmonicModuli::*;

/// A complex modulus with its key in the JSON, which names its column too, and its name in the report; without a unit a
/// ratio.
struct ModulusName {
  const char* key;
  const char* symbol;
  const char* unit;
  Modulus value;
  bool shown;  ///< in the report
};
constexpr std::array modulus_names{
    ModulusName{"bulk_modulus_2d", "K", "Pa", &HarmonicModuli::bulk_modulus_2d, true},
    ModulusName{"shear_modulus", "G", "Pa", &HarmonicModuli::shear_modulus, true},
    ModulusName{"poisson_ratio/plane_strain", "nu", "", &HarmonicModuli::poisson_strain, true},
    ModulusName{"poisson_ratio/plane_stress", "nu", "", &HarmonicModuli::poisson_stress, false},
    ModulusName{"young_modulus/plane_strain", "E", "Pa", &HarmonicModuli::young_strain, false},
    ModulusName{"young_modulus/plane_stress", "E", "Pa", &HarmonicModuli::young_stress, false}};

Results frequency_row(const HarmonicStiffness& one) {
  const HarmonicModuli moduli = harmonic_moduli(one);
  Results row;
  row.add("frequency", "f", one.frequency, "Hz", {.digits = 5});
  for (const ModulusName& name : modulus_names) {
    const std::complex<double> value = moduli.*name.value;
    const std::string storage = fmt::format("{}/storage", name.key), loss = fmt::format("{}/loss", name.key);
    if (name.shown) {
      const bool ratio = *name.unit == '\0';
      row.add(storage, ratio ? fmt::format("Re {}", name.symbol) : fmt::format("{}'", name.symbol), value.real(),
              name.unit, {.digits = 7});
      row.add(loss, ratio ? fmt::format("Im {}", name.symbol) : fmt::format("{}''", name.symbol), value.imag(),
              name.unit, {.digits = 7});
    } else {
      row.set(storage, value.real()).set(loss, value.imag());
    }
  }
  row.set("normal_factor/storage", one.normal.real()).set("normal_factor/loss", one.normal.imag());
  row.set("tangential_factor/storage", one.tangential.real()).set("tangential_factor/loss", one.tangential.imag());
  row.set("stiffness/storage", one.storage).set("stiffness/loss", one.loss);
  row.set("relative_residual", one.relative_residual)
      .set("condition", one.condition)
      .set("error_bound", one.error_bound);
  return row;
}

Results viscoelastic_results(const Viscoelasticity& springs, const ViscoelasticStiffness& result) {
  Results out;
  out.block(
      "\nViscoelastic: the moduli above are those of the elastic springs, these of stress over strain as exp(i 2 "
      "pi f t), without inertia\n");
  std::vector<Results> rows;
  double residual = 0, error = 0, condition = 0;
  for (const HarmonicStiffness& one : result.harmonic) {
    rows.push_back(frequency_row(one));
    residual = std::max(residual, one.relative_residual);
    condition = std::max(condition, one.condition);
    error = std::max(error, one.error_bound / std::hypot(largest_entry(one.storage), largest_entry(one.loss)));
  }
  out.table("viscoelastic/harmonic", std::move(rows));
  out.line("accuracy")
      .add("", "error bound", error, "of the largest entry, or less", {Shown::power, 1})
      .add("", "residual", residual, "", {Shown::power, 1})
      .add("", "condition", condition, "", {Shown::power, 1});
  out.line("complex solver", result.solver).add("", "factor", result.factor_bytes, "", {Shown::bytes});
  out.set("viscoelastic/normal", to_string(springs.normal.model))
      .set("viscoelastic/tangential", to_string(springs.tangential.model))
      .set("viscoelastic/solver", result.solver)
      .set("viscoelastic/factor_bytes", result.factor_bytes);
  return out;
}

Table viscoelastic_table(const ViscoelasticStiffness& result) {
  Table table;
  const auto& rows = result.harmonic;
  table.add("frequency_Hz", rows, &HarmonicStiffness::frequency);
  table.add("omega_rad_per_s", rows, [](const HarmonicStiffness& one) { return 2 * std::numbers::pi * one.frequency; });
  for (const ModulusName& name : modulus_names) {
    const std::string unit = *name.unit == '\0' ? "" : fmt::format("_{}", name.unit);
    std::string column = name.key;
    std::ranges::replace(column, '/', '_');
    const auto value = [&](const HarmonicStiffness& one) { return harmonic_moduli(one).*name.value; };
    table.add(fmt::format("{}_storage{}", column, unit), rows,
              [&](const HarmonicStiffness& one) { return value(one).real(); });
    table.add(fmt::format("{}_loss{}", column, unit), rows,
              [&](const HarmonicStiffness& one) { return value(one).imag(); });
  }
  table.add("error_bound_Pa", rows, &HarmonicStiffness::error_bound);
  return table;
}

/// Storage and loss of K and G over frequency; without those that are 0 at every frequency.
Plot viscoelastic_plot(const std::string& title, const ViscoelasticStiffness& result) {
  Plot plot{.title = literal(title),
            .x = {.label = "frequency f = {/:Italic ω}/2π, Hz", .logarithmic = true},
            .y = {.label = "modulus, Pa", .logarithmic = true},
            .enhanced = true};
  const auto add = [&](const std::string& symbol, Modulus modulus, bool loss, PlotColour colour) {
    const std::string what = loss ? "loss" : "storage";
    Series series{.label = fmt::format("{} of {}", what, symbol),
                  .style = loss ? SeriesStyle::dashed_line : SeriesStyle::line,
                  .colour = colour,
                  .column = fmt::format("{}_{}", symbol, what)};
    bool any = false;
    for (const HarmonicStiffness& one : result.harmonic) {
      const std::complex<double> value = harmonic_moduli(one).*modulus;
      const double part = loss ? value.imag() : value.real();
      series.add(one.frequency, part > one.error_bound ? part : std::numeric_limits<double>::quiet_NaN());
      any = any || part > one.error_bound;
    }
    if (any) plot.series.push_back(std::move(series));
  };
  for (const bool loss : {false, true}) add("K", &HarmonicModuli::bulk_modulus_2d, loss, PlotColour::blue);
  for (const bool loss : {false, true}) add("G", &HarmonicModuli::shear_modulus, loss, PlotColour::vermilion);
  return plot;
}

/// viscoelastic/frequencies (n) in Hz; complex bulk_moduli_2d, shear_moduli, young_moduli in plane strain (n) in Pa,
/// poisson_ratios in plane strain (n) and stiffnesses (n, 9) by rows in Pa.
std::vector<ResultArray> viscoelastic_arrays(const ViscoelasticStiffness& result) {
  using Amplitudes = std::vector<std::complex<double>>;
  std::vector<double> frequencies;
  Amplitudes stiffness;
  for (const HarmonicStiffness& one : result.harmonic) {
    frequencies.push_back(one.frequency);
    for (int r = 0; r < 3; ++r) {
      for (int s = 0; s < 3; ++s) stiffness.emplace_back(one.storage[r][s], one.loss[r][s]);
    }
  }
  std::vector<ResultArray> arrays{array_of("viscoelastic/frequencies", "Hz", std::move(frequencies), 1)};
  const auto add = [&](const char* name, const char* unit, Amplitudes values, std::size_t columns) {
    const auto owner = std::make_shared<const Amplitudes>(std::move(values));
    arrays.push_back(
        {fmt::format("viscoelastic/{}", name), unit, owner, owner->data(), owner->size() / columns, columns, columns});
  };
  const auto all = [&](Modulus value) {
    Amplitudes values;
    for (const HarmonicStiffness& one : result.harmonic) values.push_back(harmonic_moduli(one).*value);
    return values;
  };
  add("bulk_moduli_2d", "Pa", all(&HarmonicModuli::bulk_modulus_2d), 1);
  add("shear_moduli", "Pa", all(&HarmonicModuli::shear_modulus), 1);
  add("young_moduli", "Pa", all(&HarmonicModuli::young_strain), 1);
  add("poisson_ratios", "", all(&HarmonicModuli::poisson_strain), 1);
  add("stiffnesses", "Pa", std::move(stiffness), 9);
  return arrays;
}

constexpr double visible_anisotropy = 1e-9;

std::string boundary_condition(Boundary boundary) {
  return boundary == Boundary::periodic       ? "the cell repeats for ever, its images move with the mean strain"
         : boundary == Boundary::displacement ? "the discs at the boundary follow the mean strain"
                                              : "the boundary carries the tractions of a uniform stress";
}

void add_mean_strain(Results& out, const Problem& problem, bool periodic, Boundary used) {
  const std::string boundary = to_string(used);
  out.line("mean strain").add("boundary", "", boundary).note(": " + boundary_condition(used));
  if (!periodic) {
    out.line("",
             "A free sample lacks the contacts across its boundary: it is softer than its bulk by about the share of "
             "the cells there.");
  }
  static constexpr std::array tables{"test", "support", "load"};
  const std::vector<std::string> unused = problem.resolved.headings(tables);
  if (!unused.empty()) out.line("not used", joined(unused) + ": the mean strain takes their place");
}

void add_rigidity(Results& out, const EffectiveStiffness& r) {
  std::vector<std::string> lines = r.removed;
  if (r.discs_removed > 0) lines.emplace_back("without them every force is the same, and so is the stiffness");
  std::vector<Results> described;
  for (const ZeroEnergyMode& motion : r.motions) {
    lines.push_back(fmt::format("{}: {}", motion.kind, motion.description));
    described.push_back(Results().set("kind", motion.kind).set("description", motion.description));
  }
  const std::int64_t motions = r.gear_modes + r.mechanisms;
  if (motions > 0) {
    lines.push_back(
        fmt::format("{} without energy ({}, {}){} held: no mean strain drives {}, so the stiffness is the same",
                    counted(motions, "motion"), counted(r.gear_modes, "gear mode"), counted(r.mechanisms, "other mode"),
                    motions > std::ssize(described) ? fmt::format(", {} of them named above,", described.size()) : "",
                    motions == 1 ? "it" : "them"));
  }
  if (r.discs_removed == 0 && motions == 0)
    lines.emplace_back(r.unstable_modes > 0 ? "every disc carries load"
                                            : "every disc carries load, and every motion costs energy");
  if (r.self_stresses) {
    lines.push_back(fmt::format("{} of self-stress: {}",
                                counted(*r.self_stresses, "independent state", "independent states"),
                                r.self_stresses == 0 ? "statically determinate, forces do not depend on the springs"
                                                     : "so many springs more than rigidity needs"));
  }
  const std::size_t unstable = r.unstable_modes > 0 ? lines.size() : SIZE_MAX;
  if (r.unstable_modes > 0) {
    lines.push_back(fmt::format("UNSTABLE: the network loses stability by {}; this stiffness is of no state of rest",
                                counted(*r.unstable_modes, "mode")));
    if (r.unstable_strains > 0) {
      lines.push_back(fmt::format("{} of the stiffness {} negative: such a mean strain gives energy back",
                                  counted(r.unstable_strains, "eigenvalue"), r.unstable_strains == 1 ? "is" : "are"));
    }
  } else if (!r.unstable_modes) {
    lines.push_back(fmt::format("stability {}", stability_not_known));
  }
  for (const std::string& text : lines) {
    out.line(&text == lines.data() ? "rigidity" : "", text);
    if (&text == lines.data() + unstable) out.warn();
  }
  out.set("rattlers", r.rattlers)
      .set("discs_removed", r.discs_removed)
      .set("left_out_parts", r.removed)
      .set("mechanisms", described)
      .set("gear_modes", r.gear_modes)
      .set("local_mechanisms", r.mechanisms)
      .set("self_stresses", r.self_stresses)
      .set("negative_pivots", r.negative_pivots)
      .set("unstable_modes", r.unstable_modes)
      .set("unstable_strains", r.unstable_strains);
}

void add_stiffness(Results& out, const EffectiveStiffness& r) {
  out.block("\n").line("stiffness").add("stiffness", "", r.stiffness, "Pa", {.digits = 9});
  out.line("", "rows: stress, columns: strain, both xx, yy, xy with engineering shear");
  out.line("error bound")
      .add("error_bound", "", r.error_bound, "Pa for an entry", {Shown::power, 1})
      .add("", "", r.error_bound / largest_entry(r.stiffness), "of the largest", {Shown::power, 0})
      .note(": ")
      .add("relative_residual", "residual", r.relative_residual, "", {Shown::power, 1});
  if (r.condition > 0) {
    out.add("condition", "condition", r.condition, "", {Shown::power, 1});
  } else {
    out.note(", estimated from the iterations");
  }
  out.note("; ").add("hill_mandel", "macroscopic and microscopic power differ by", r.hill_mandel, "",
                     {Shown::power, 0});
  out.set("tangential_part", r.tangential_part).set("normal_part", r.normal_part);
  if (r.effects.bending) out.set("bending_part", r.bending_part);
}

/// The stress that the forces at rest make, and the derivative of the Cauchy stress where it is not symmetric.
void add_prestress(Results& out, const EffectiveStiffness& r) {
  const Tensor2& s = r.stress_at_rest;
  out.line("stress at rest")
      .add("stress_at_rest/xx", "xx", s.xx, "Pa", {.digits = 6})
      .add("stress_at_rest/yy", "yy", s.yy, "Pa", {.digits = 6})
      .add("stress_at_rest/xy", "xy", s.xy, "Pa", {.digits = 6});
  double asymmetric = 0;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < a; ++b) asymmetric = std::max(asymmetric, std::abs(r.cauchy[a][b] - r.cauchy[b][a]));
  out.line("",
           "the stiffness is the derivative of the Cauchy stress by the strain, of which the symmetric part is shown: ")
      .add("cauchy_asymmetry", "", asymmetric / largest_entry(r.cauchy), "of the largest entry is not symmetric",
           {Shown::power, 1});
  out.set("cauchy_stiffness", r.cauchy).set("prestress_part", r.prestress_part);
}

void add_anisotropy(Results& out, const Matrix3& stiffness, double anisotropy) {
  const StiffnessAxes axes = stiffness_axes(stiffness);
  out.line("anisotropy")
      .add("anisotropy", "isotropic to", anisotropy, "", {anisotropy < 1e-4 ? Shown::power : Shown::percent, 3})
      .note(anisotropy <= visible_anisotropy ? ", round-off" : "; the moduli are the mean over all directions");
  std::vector<std::string> directions;
  const auto shown = [](double angle) { return fmt::format("{:.1f}°", angle * 180 / std::numbers::pi); };
  if (axes.one_axis > visible_anisotropy) {
    directions.push_back(
        fmt::format("along {} by {} (across it softer)", shown(axes.one_direction), percent(axes.one_axis)));
  }
  if (axes.two_axes > visible_anisotropy) {
    directions.push_back(fmt::format("along {} and at right angles to it by {} (between them softer)",
                                     shown(axes.two_directions), percent(axes.two_axes)));
  }
  if (anisotropy > visible_anisotropy && !directions.empty()) out.line("", "stiffest " + joined(directions, ", and "));
  out.set("stiffness_axes", Results()
                                .set("one_axis", axes.one_axis)
                                .set("one_direction", axes.one_direction)
                                .set("two_axes", axes.two_axes)
                                .set("two_directions", axes.two_directions));
}

void add_fabric(Results& out, const Fabric& f) {
  out.line("fabric").add("fabric/mean_branch", "mean branch", f.mean_branch, "m").note("; contacts prefer ");
  const auto axis = [&](const std::string& which, const char* label, double anisotropy, double direction) {
    const bool shown = anisotropy > visible_anisotropy;
    if (shown) out.add("", label, anisotropy, "", {Shown::percent, 3}).add("", "at", direction, "", {Shown::degrees});
    out.set("fabric/anisotropy_" + which, anisotropy).set("fabric/direction_" + which, direction);
    return shown;
  };
  const bool one = axis("2", "one axis by", f.anisotropy_2, f.direction_2);
  const bool two = axis("4", "two axes at right angles by", f.anisotropy_4, f.direction_4);
  if (!one && !two) out.note("no axis");
  out.set("fabric/normal", f.normal).set("fabric/branch", f.branch);
}

Results table_row(const std::string& name, double bulk, double shear) {
  return Results()
      .add("", "bounds and estimates", "  " + name)
      .add("", "K", bulk, "Pa", {.digits = 8})
      .add("", "G", shear, "Pa", {.digits = 8})
      .add("", "nu strain", (bulk - shear) / (2 * bulk), "", {Shown::decimals, 5})
      .add("", "nu stress", (bulk - shear) / (bulk + shear), "", {Shown::decimals, 5});
}

void add_order(Results& out, const BoundedStiffness& h, const ContactSprings& springs) {
  const std::vector<StiffnessBeside> order = h.ordered(springs);
  std::vector<Results> steps;
  std::vector<std::string> names, margins;
  bool holds = true;
  for (const StiffnessBeside& one : order) {
    names.push_back(one.key);
    if (names.size() == 1) continue;
    const StiffnessBeside& lower = *(&one - 1);
    const double m = margin(*lower.stiffness, *one.stiffness);
    holds = holds && m >= -1e-9;
    margins.push_back(std::abs(m) <= 1e-12 ? "0" : fmt::format("{:.2g}", m));
    steps.push_back(Results().set("lower", lower.key).set("upper", one.key).set("margin", m));
  }
  if (order.size() > 1) {
    out.line("order",
             fmt::format("{} as quadratic forms: {}; least eigenvalues of the differences over the larger: {}",
                         joined(names, " <= "), holds ? "holds" : "BROKEN, do not trust this result", joined(margins)));
    if (!holds) out.warn();
    out.line("", "K and G lie between their bounds; nu, a ratio of both, need not");
  } else if (springs.any_negative()) {
    out.line("order", "kT < 0: energies are no minima, and nothing above is a bound");
  } else if (springs.prestressed()) {
    out.line("order", "prestress: bounds of springs alone do not hold, and are left out");
  }
  out.set("order", steps);
}

std::string name_of(const std::string& key) {
  return key == "voigt"                     ? "Voigt: all discs follow the strain"
         : key == "uniform_stress_estimate" ? "uniform stress: an estimate, no bound"
                                            : key;
}

void add_bounds(Results& out, const BoundedStiffness& h, const std::optional<RelationBeside>& relation) {
  Results bounds, missing;
  const std::string own = to_string(h.result.boundary);
  const bool other_boundary = std::ranges::any_of(h.beside, [](const StiffnessBeside& one) {
    return one.key == to_string(Boundary::displacement) || one.key == to_string(Boundary::traction);
  });
  std::vector<StiffnessBeside> all = h.beside;
  all.push_back({own, h.result.stiffness, {}});
  std::vector<Results> rows;
  for (const std::string key : {"traction", "periodic", "displacement", "voigt", "uniform_stress_estimate"}) {
    for (const StiffnessBeside& one : all) {
      if (one.key != key) continue;
      if (one.stiffness) {
        const EffectiveModuli m = effective_moduli(*one.stiffness);
        rows.push_back(
            table_row(name_of(key) + (key == own ? " <- this result" : ""), m.bulk_modulus_2d, m.shear_modulus));
        if (key != own || other_boundary) bounds.set(key, *one.stiffness);
      } else {
        bounds.set(key, nullptr);
        missing.set(key, one.missing);
      }
    }
  }
  if (relation) rows.push_back(table_row(relation->name, relation->bulk_modulus_2d, relation->shear_modulus));
  out.block("\n").table("", rows);
  for (const StiffnessBeside& one : h.beside)
    if (!one.stiffness) out.line(name_of(one.key).substr(0, name_of(one.key).find(':')), "none: " + one.missing);
  out.set("bounds", bounds);
  if (!missing.parts().empty()) out.set("bounds_missing", missing);
}

void add_restrained(Results& out, const EffectiveStiffness& r) {
  const DisplacementOperator o = displacement_operator(r);
  out.block("\nrotation restrained: moments hold the discs, and the stress is not symmetric\n");
  out.line("  stress of").add("gradient_stiffness", "", r.gradient_stiffness, "Pa", {.digits = 9});
  out.line("  gradients", "rows s_xx, s_yy, s_xy, s_yx, columns u_x,x u_y,y u_x,y u_y,x; |s_xy - s_yx| is up to ")
      .add("", "", r.stress_asymmetry, "of the largest entry", {Shown::percent, 3});
  out.line("  displacements", "see ")
      .add("", "G' =", o.shear_modulus, "Pa", {.digits = 9})
      .add("", "K' =", o.bulk_modulus_2d, "Pa", {.digits = 9});
  if (o.bulk_modulus_2d > 0)
    out.add("", "nu' =", (o.bulk_modulus_2d - o.shear_modulus) / (2 * o.bulk_modulus_2d), "in plane strain");
  out.note(" (hexagonal lattice: Abe 1996, eq. 53)");
  out.line("",
           "These fit wave speeds and problems in which all of the boundary is displaced, not the stress: a uniaxial "
           "test still shows the moduli of the table above, nu = (1 - kT/kN)/4 on the hexagonal lattice, and the "
           "antisymmetric stress needs moments that a body without them does not have.");
  const EffectiveModuli moduli = effective_moduli(isotropic_stiffness(o.bulk_modulus_2d, o.shear_modulus));
  out.set("displacement_operator", moduli_results(moduli));
}

}  // namespace

std::optional<RelationBeside> relation_beside(const SpringConstants& springs, const ChosenRelation& chosen) {
  try {
    const ElasticModuli moduli = moduli_of(springs, chosen.relation, chosen.measures, Plane::stress);
    return RelationBeside{chosen.relation.name, moduli.bulk_modulus_2d(), moduli.shear_modulus};
  } catch (const Error&) {
    return {};
  }
}

Results homogenized_results(const Problem& problem, Results out, bool periodic, const BoundedStiffness& h,
                            const std::optional<Fabric>& fabric, const std::optional<RelationBeside>& relation) {
  const EffectiveStiffness& r = h.result;
  const EffectiveModuli moduli = effective_moduli(r.stiffness);
  add_mean_strain(out, problem, periodic, r.boundary);
  add_rigidity(out, r);
  add_stiffness(out, r);
  if (r.effects.prestress) add_prestress(out, r);
  out.append(moduli_results(moduli));
  add_anisotropy(out, r.stiffness, moduli.anisotropy);
  if (fabric) add_fabric(out, *fabric);
  add_bounds(out, h, relation);
  add_order(out, h, problem.springs.springs);
  if (relation) {
    const Matrix3 stiffness = isotropic_stiffness(relation->bulk_modulus_2d, relation->shear_modulus);
    out.set("relation", Results().set("name", relation->name).append(moduli_results(effective_moduli(stiffness))));
  }
  if (r.effects.restrained && r.boundary != Boundary::traction) add_restrained(out, r);
  out.set("stress_asymmetry", r.stress_asymmetry);
  out.block("\n").line("unknowns").add("unknowns", "", r.unknowns, "", {Shown::count});
  out.add("solver", "solver", r.solver);
  if (r.iterations > 0) out.add("iterations", "", r.iterations, "iteration", {Shown::count});
  return out.add("factor_bytes", r.iterations > 0 ? "grids" : "factor", r.factor_bytes, "", {Shown::bytes});
}

namespace {

struct HomogenizeVerb : CommonOptions {
  bool resume = false, sensitivities = false;
  int probes = 0;
  std::optional<double> accuracy;
};

/// Strains of the states that are written, and the names of their files.
constexpr double written_strain = 1e-3;
struct WrittenState {
  const char* suffix;  ///< suffix of the names of its files
  const char* label;
};
constexpr std::array written_states{WrittenState{"_strain_xx", "strain xx"}, WrittenState{"_strain_yy", "strain yy"},
                                    WrittenState{"_strain_xy", "shear strain"}};

BoundsOptions bounds_options(const Case& resolved) {
  BoundsOptions options = resolved.homogenize;
  options.rotation = resolved.rotation;
  options.solver = resolved.solver;
  return options;
}

/// \param failure set where the bounds are not finished
BoundedStiffness homogenize(const Problem& problem, std::optional<Error>& failure) {
  const Case& resolved = problem.resolved;
  return casefile::with_place(resolved.homogenize.boundary ? resolved.where("homogenize.boundary") : "", [&] {
    return found_by<BoundedStiffness>(failure, [&] {
      return bounded_stiffness(problem.assembly, problem.springs.springs, bounds_options(resolved));
    });
  });
}

void write_states(const CommonOptions& options, const Problem& problem, const EffectiveStiffness& result) {
  const OutputCase& wanted = problem.resolved.output;
  const Assembly& assembly = problem.assembly;
  const bool cells_known = cells_hold_area(assembly);
  const std::vector<StrainedState> states = strained_states(assembly, problem.springs.springs, result, written_strain);
  for (std::size_t k = 0; k < states.size(); ++k) {
    const auto& [gradient, fluctuations, changes, moments] = states[k];
    const std::vector<ContactForce> forces = forces_in_total(assembly, problem.springs.springs, changes);
    const auto& [suffix, label] = written_states[k];
    std::vector<DiscMotion> motions = fluctuations;
    for (std::size_t d = 0; d < motions.size(); ++d) motions[d].u += gradient * assembly.centres[d];
    const std::vector<Tensor2> stresses = cells_known ? disc_stresses(assembly, forces) : std::vector<Tensor2>{};
    AssemblyState state{.assembly = assembly,
                        .motions = motions,
                        .contact_forces = forces,
                        .stresses = stresses,
                        .bending_moments = moments};
    write_state(options, wanted, suffix, state);
    // A periodic cell is drawn undeformed but for what repeats with it: its images would have to move along.
    if (assembly.periodic()) state.motions = fluctuations;
    const std::string& title = problem.resolved.title;
    write_state_picture(options, wanted, suffix, state,
                        {.title = fmt::format("{}{}{} = {}{}", title, title.empty() ? "" : ": ", label, written_strain,
                                              assembly.periodic() ? ", discs moved beside the mean strain" : ""),
                         .colour = gradient.xy != 0 ? DiscColour::stress_xy : DiscColour::mean_stress});
  }
}

/// Complex moduli over frequency, where the case has [viscoelastic].
struct Harmonic {
  Viscoelasticity springs;
  ViscoelasticStiffness stiffness;
};

struct Homogenized {
  std::optional<MeanShift> shift = {};
  std::optional<Problem> problem = {};
  BoundedStiffness stiffness = {};
  std::optional<SpringSensitivities> sensitivities = {};
  std::optional<Harmonic> harmonic = {};
};

std::vector<OutputPart> output_parts(const Case& resolved, const std::shared_ptr<const Homogenized>& found,
                                     bool sensitivities) {
  std::vector<OutputPart> parts{case_part([=]() -> const Case& { return found->problem->resolved; })};
  if (resolved.viscoelastic) {
    const auto write = [=](const CommonOptions& into) {
      if (!found->harmonic) return;
      const ViscoelasticStiffness& stiffness = found->harmonic->stiffness;
      write_csv(*into.out / viscoelastic_table_name, viscoelastic_table(stiffness), true);
      write_plot(*into.out, moduli_over_frequency, viscoelastic_plot(found->problem->resolved.title, stiffness), true);
    };
    parts.push_back({viscoelastic_table_name, write, OutputPart::page, plot_files(moduli_over_frequency)});
    parts.back().files.insert(parts.back().files.begin(), viscoelastic_table_name);
  }
  if (sensitivities) {
    const auto write = [=](const CommonOptions& into) {
      if (found->sensitivities)
        write_sensitivities(into, *found->problem,
                            moduli_by_springs(found->stiffness.result.stiffness, *found->sensitivities));
    };
    parts.push_back({sensitivities_name, write, OutputPart::page,
                     files_of_sensitivities(resolved.output, pictures_of_sensitivities())});
  }
  parts.push_back(assembly_part(resolved.output, [=]() -> const Assembly& { return found->problem->assembly; }));
  const auto write_all = [=](const CommonOptions& into) {
    write_states(into, *found->problem, found->stiffness.result);
  };
  parts.push_back({"the states", write_all, OutputPart::page});
  for (const WrittenState& state : written_states)
    std::ranges::move(state_names(resolved.output, state.suffix), std::back_inserter(parts.back().files));
  return parts;
}

/// \param failure set where there are none or not all of them
std::optional<Harmonic> harmonic_of(const Problem& problem, Boundary boundary, std::optional<Error>& failure) {
  const Case& resolved = problem.resolved;
  if (!resolved.viscoelastic || failure) return {};
  Harmonic result{build_viscoelasticity(resolved, problem.springs.constants), {}};
  const std::vector<double> frequencies = frequencies_of(resolved, result.springs);
  const auto solve = [&] {
    try {
      result.stiffness =
          viscoelastic_stiffness(problem.assembly, problem.springs.springs, result.springs, frequencies,
                                 {.boundary = boundary, .rotation = resolved.rotation, .solver = resolved.solver});
    } catch (const ErrorWith<ViscoelasticStiffness>& ended) {
      result.stiffness = ended.found();
      throw;
    }
  };
  failure = failure_of([&] { casefile::with_place(resolved.where("viscoelastic"), solve); });
  if (failure && failure->kind() == ErrorKind::bad_input) throw Error(*failure);
  if (failure && result.stiffness.harmonic.empty()) return {};
  return result;
}

void refuse_viscoelastic_samples(const Case& resolved, bool accuracy) {
  if (!resolved.viscoelastic || !(resolved.ensemble || accuracy)) return;
  bad_input_at(resolved.where("viscoelastic"), "[viscoelastic] is given beside [ensemble] or --accuracy",
               "both are about the elastic moduli of random cells",
               "Homogenize one large cell, or use 'equidem sweep' over its seeds");
}

/// Another method, where it is asked for, is that of the elastic moduli alone.
void add_solver_of_complex(Results& results, const SolverOptions& asked) {
  if (asked.method == SolverMethod::automatic || asked.method == SolverMethod::umfpack) return;
  results.line("not used", fmt::format("solver.method = \"{}\" for complex moduli: UMFPACK factorizes complex matrices",
                                       to_string(asked.method)));
}

/// A disc, of the motions under one boundary that are kept beside the solution under the next: measured.
constexpr double bytes_beside_others = 350;

constexpr double of_stiffness = 9, of_moduli = 4;  // numbers that have derivatives by each spring

void dry_run_homogenization(const HomogenizeVerb& options, const Problem& problem) {
  const std::optional<double>& accuracy = options.accuracy;
  const std::vector<Boundary> boundaries =
      boundaries_of(problem.assembly, problem.springs.springs, bounds_options(problem.resolved));
  const std::string names = joined(boundaries, [](Boundary boundary) { return to_string(boundary); });
  Results results;
  results.line("mean strain", fmt::format("boundaries {}: one factorization and three solutions for each, every one "
                                          "about as large as this",
                                          names));
  results.set("factorizations", boundaries.size());
  if (problem.resolved.viscoelastic) {
    const Viscoelasticity springs = build_viscoelasticity(problem.resolved, problem.springs.constants);
    const std::vector<double> frequencies = frequencies_of(problem.resolved, springs);
    results.line("viscoelastic",
                 fmt::format("{} more, each of complex numbers", counted(std::ssize(frequencies), "factorization")));
    add_solver_of_complex(results, problem.resolved.solver);
  }
  if (accuracy) results.append(accuracy_plan(*accuracy, bound_is_compared));
  dry_run(options, problem, results, AssemblyKeys::all,
          {.of_complex = problem.resolved.viscoelastic.has_value(),
           .bytes_of_disc = (boundaries.size() > 1 ? bytes_beside_others : 0) +
                            (options.sensitivities ? bytes_of_sensitivities(problem, of_stiffness + of_moduli) : 0),
           .bytes_of_picture = bytes_of_state_picture(options, problem.resolved.output, problem.assembly)});
}

void homogenize(const HomogenizeVerb& options) {
  Case resolved = read_case(options);
  refuse_viscoelastic_samples(resolved, options.accuracy.has_value());
  if (options.sensitivities && (resolved.ensemble || (options.accuracy && resolved.assembly.random())))
    bad_input("--sensitivities is given beside [ensemble] or --accuracy", "it is about the contacts of one cell",
              "Homogenize one cell, or use 'equidem sweep' over its seeds");
  if (options.accuracy && resolved.assembly.random()) {
    if (options.resume)
      bad_input("--resume and --accuracy exclude each other", "what is sampled follows from the samples",
                "Run it anew");
    return homogenize_to_accuracy(options, resolved, *options.accuracy);
  }
  if (resolved.ensemble) return homogenize_ensemble(options, resolved, options.resume);
  if (options.resume)
    bad_input("--resume has nothing to continue", "the case has no [ensemble]", "Leave it out, or add [ensemble]");
  const auto found = std::make_shared<Homogenized>();
  const std::vector<OutputPart> parts = output_parts(resolved, found, options.sensitivities);
  expect_results(options, parts);
  const auto lock = lock_out(options);
  if (options.accuracy) resolved.solver.accuracy = std::sqrt(0.1 * *options.accuracy);  // errors of moduli are squares
  const Problem& problem = found->problem.emplace(prestressed(problem_of(std::move(resolved))));
  if (options.dry_run) return dry_run_homogenization(options, problem);

  std::optional<Error> failure;
  found->stiffness = homogenize(problem, failure);
  const EffectiveStiffness& result = found->stiffness.result;
  found->harmonic = harmonic_of(problem, result.boundary, failure);
  Stopwatch watch;
  if (options.sensitivities) found->sensitivities = sensitivities_of(problem, result, failure);
  if (options.probes > 0 && found->sensitivities)
    found->shift = mean_shift_of(problem, result, *found->sensitivities, options.probes, failure);
  const double seconds_of_sensitivities = watch.lap();
  const std::optional<Harmonic>& harmonic = found->harmonic;
  const StopsHeldBack held_back(failure);
  StageTimes times = problem.times;
  times.add(result.times);
  if (harmonic) times.add(harmonic->stiffness.times);
  if (found->sensitivities) times.add("sensitivities", seconds_of_sensitivities);
  std::optional<RelationBeside> relation;
  if (const auto& constants = problem.springs.constants)
    relation = relation_beside(*constants, spring_relation(problem.resolved, problem.assembly));
  Results results = homogenized_results(problem, problem_results(problem, result.effects), problem.assembly.periodic(),
                                        found->stiffness, fabric(problem.assembly), relation);
  if (found->sensitivities)
    results.append(spring_effects(problem, moduli_by_springs(result.stiffness, *found->sensitivities),
                                  "changes of the moduli (plane stress)"));
  if (found->shift) results.append(shift_results(result, *found->shift));
  results.set("strain_of_states", written_strain);
  if (options.accuracy)
    results.append(accuracy_results(solver_accuracy(
        *options.accuracy, result.error_bound / largest_entry(result.stiffness), result.condition, times.total())));
  if (harmonic) {
    results.append(viscoelastic_results(harmonic->springs, harmonic->stiffness));
    add_solver_of_complex(results, problem.resolved.solver);
  }
  if (options.out)
    results.line("files", result.fluctuations.empty()
                              ? "without states: those are of prescribed strains"
                              : fmt::format("states are those of strains of {}", written_strain));
  deliver(options, status_of(result.unstable_modes), std::move(results), std::move(times), parts, failure);
  constexpr const char* strains[] = {"xx", "yy", "xy"};
  for (std::size_t k = 0; arrays_wanted() && k < result.fluctuations.size(); ++k)
    hand_over(motion_arrays(fmt::format("fluctuations/{}/", strains[k]), {found, &result.fluctuations[k]}));
  if (arrays_wanted() && harmonic) hand_over(viscoelastic_arrays(harmonic->stiffness));
  if (arrays_wanted() && found->sensitivities) {
    hand_over(sensitivity_arrays({found, &*found->sensitivities}));
    const ContactSprings& springs = problem.springs.springs;
    if (has_shape_sensitivities(problem.assembly, springs))
      hand_over(shape_arrays(shape_sensitivities(problem.assembly, springs, result)));
  }
  hand_over(std::shared_ptr<const Assembly>(found, &problem.assembly));
}

}  // namespace

Run declare_homogenize(CLI::App& command) {
  const auto options = std::make_shared<HomogenizeVerb>();
  add_common_options(command, *options);
  add_require_stable(command, *options);
  command.add_flag("--resume", options->resume, "with [ensemble]: keep the samples in --out, compute the others");
  command.add_flag(
      "--sensitivities", options->sensitivities,
      "derivatives of the moduli by the springs of each contact:\nsensitivities.csv and pictures in --out");
  command
      .add_option("--second-order", options->probes,
                  "with --sensitivities: by how much scatter of the springs shifts the\nmean moduli, from N random "
                  "probes; each takes three solutions")
      ->check(whole_number(2, 10000))
      ->needs("--sensitivities")
      ->type_name("N");
  add_accuracy_option(
      command, options->accuracy,
      "random cells: the size and number that tell the moduli to X;\nelse: fail unless the error is below X");
  return [options] { return homogenize(*options); };
}

}  // namespace equidem
