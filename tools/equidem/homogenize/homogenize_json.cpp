// SPDX-License-Identifier: GPL-3.0-or-later
#include "homogenize/homogenized.hpp"

namespace equidem {
namespace {

template <std::size_t N>
std::vector<std::vector<double>> rows_of(const SquareMatrix<N>& matrix) {
  std::vector<std::vector<double>> rows;
  for (const auto& row : matrix) rows.emplace_back(row.begin(), row.end());
  return rows;
}

JsonObject both_readings(double strain, double stress) {
  JsonObject object;
  object.set("plane_strain", strain).set("plane_stress", stress);
  return object;
}

/// Keys of two-dimensional moduli, nu and E in both readings.
void add_moduli(JsonObject& object, const EffectiveModuli& m) {
  object.set("shear_modulus", m.shear_modulus)
      .set("bulk_modulus_2d", m.bulk_modulus_2d)
      .set("poisson_ratio", both_readings(m.poisson_strain, m.poisson_stress))
      .set("young_modulus", both_readings(m.young_strain, m.young_stress));
}

void add_problem(JsonObject& object, const Problem& problem) {
  object.set("title", problem.resolved.title)
      .set("discs", problem.assembly.size())
      .set("contacts", problem.assembly.contacts.size())
      .set("coordination_number", problem.assembly.coordination_number())
      .set("area", problem.assembly.area())
      .set("solid_fraction", problem.assembly.solid_fraction());
  if (problem.springs.constants)
    object.set("kN", problem.springs.constants->kN).set("kT", problem.springs.constants->kT);
}

void add_rigidity(JsonObject& object, const EffectiveStiffness& r) {
  std::vector<JsonObject> motions;
  for (const HarmlessMotion& motion : r.motions) {
    JsonObject one;
    one.set("kind", motion.kind).set("description", motion.description);
    motions.push_back(std::move(one));
  }
  object.set("rattlers", r.rattlers)
      .set("discs_removed", r.discs_removed)
      .set("left_out", r.removed)
      .set("mechanisms", motions)
      .set("gear_modes", r.gear_modes)
      .set("local_mechanisms", r.local_mechanisms)
      .set("self_stresses", r.self_stresses)
      .set("negative_pivots", r.negative_pivots)
      .set("unstable_modes", r.unstable_modes)
      .set("unstable_strains", r.unstable_strains);
  if (r.self_stresses < 0) object.set_null("self_stresses");
  if (r.negative_pivots < 0) object.set_null("negative_pivots");
  if (r.unstable_modes < 0) object.set_null("unstable_modes");
}

void add_bounds(JsonObject& object, const Homogenized& h) {
  JsonObject bounds, missing, margins;
  bool any_missing = false;
  for (const StiffnessBeside& one : h.beside) {
    if (one.stiffness) {
      bounds.set(one.key, rows_of(*one.stiffness));
    } else {
      bounds.set_null(one.key);
      missing.set(one.key, one.missing);
      any_missing = true;
    }
  }
  if (bounds.contains(to_string(Boundary::displacement)) || bounds.contains(to_string(Boundary::traction)))
    bounds.set(to_string(h.result.boundary), rows_of(h.result.stiffness));
  object.set("bounds", bounds);
  if (any_missing) object.set("bounds_missing", missing);
  const std::vector<StiffnessBeside> order = h.ordered();
  std::vector<JsonObject> steps;
  for (std::size_t k = 1; k < order.size(); ++k) {
    JsonObject step;
    step.set("lower", order[k - 1].key)
        .set("upper", order[k].key)
        .set("margin", margin(*order[k - 1].stiffness, *order[k].stiffness));
    steps.push_back(std::move(step));
  }
  object.set("order", steps);
  if (!h.relation) return;
  const double K = h.relation->bulk_modulus_2d, G = h.relation->shear_modulus;
  JsonObject relation;
  relation.set("name", h.relation->name);
  add_moduli(relation, effective_moduli(isotropic_stiffness(K, G)));
  object.set("relation", relation);
}

}  // namespace

void add_homogenized(JsonObject& object, const Homogenized& h) {
  const EffectiveStiffness& r = h.result;
  add_problem(object, h.problem);
  object.set("boundary", to_string(r.boundary)).set("stiffness", rows_of(r.stiffness));
  if (r.effects.restrained && r.boundary != Boundary::traction) {
    const DisplacementOperator seen = displacement_operator(r);
    JsonObject waves;
    add_moduli(waves, effective_moduli(isotropic_stiffness(seen.bulk_modulus_2d, seen.shear_modulus)));
    object.set("gradient_stiffness", rows_of(r.gradient_stiffness)).set("displacement_operator", waves);
  }
  object.set("stress_asymmetry", r.stress_asymmetry);
  add_moduli(object, h.moduli);
  object.set("anisotropy", h.moduli.anisotropy);
  const StiffnessAxes axes = stiffness_axes(r.stiffness);
  JsonObject directions;
  directions.set("one_axis", axes.one_axis)
      .set("one_direction", axes.one_direction)
      .set("two_axes", axes.two_axes)
      .set("two_directions", axes.two_directions);
  object.set("stiffness_axes", directions);
  JsonObject fabric;
  fabric.set("normal", h.fabric.normal)
      .set("branch", h.fabric.branch)
      .set("anisotropy_2", h.fabric.anisotropy_2)
      .set("direction_2", h.fabric.direction_2)
      .set("anisotropy_4", h.fabric.anisotropy_4)
      .set("direction_4", h.fabric.direction_4)
      .set("mean_branch", h.fabric.mean_branch);
  object.set("fabric", fabric);
  add_bounds(object, h);
  add_rigidity(object, r);
  object.set("error_bound", r.error_bound)
      .set("relative_residual", r.relative_residual)
      .set("condition", r.condition)
      .set("hill_mandel", r.hill_mandel)
      .set("tangential_part", rows_of(r.tangential_part))
      .set("normal_part", rows_of(r.normal_part))
      .set("unknowns", r.unknowns)
      .set("solver", r.solver)
      .set("factor_bytes", r.factor_bytes);
}

}  // namespace equidem
