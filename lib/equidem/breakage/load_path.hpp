// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A path of loading: loads, imposed motions or a mean strain that grow in proportion to lambda, dead loads beside
/// them, and the legs along which lambda goes.
/// How a network answers lambda: load, motion, stress, elastic energy and work.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/breakage/breakable_system.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/statics/loads.hpp"
#include "equidem/statics/stiffness_solver.hpp"

namespace equidem {

/// The quantity that is kept from falling while contacts break.
enum class LoadControl {
  path,    ///< nothing: lambda may fall from one event to the next (snap-back)
  load,    ///< the load
  motion,  ///< the motion through which the load works
};

template <>
struct EnumNames<LoadControl> {
  using enum LoadControl;
  static constexpr const char* what = "control of a path";
  static constexpr NamedValue<LoadControl> list[] = {{path, "path"}, {load, "load"}, {motion, "motion"}};
};

/// The quantity that lambda multiplies.
enum class DrivenBy { loads, motions, strain };

struct LoadPathOptions {
  std::vector<Support> supports;  ///< their motions are multiplied by lambda
  LoadCase loads;                 ///< multiplied by lambda
  LoadCase dead_loads;
  std::optional<Voigt> strain;  ///< of a periodic cell, xy engineering; multiplied by lambda
  LoadControl control = LoadControl::path;
  std::vector<double> legs;     ///< lambda at the end of each; empty: one leg without an end
  std::int64_t max_events = 0;  ///< after which the path ends; 0: no limit
};

/// Forces are N0 + lambda N1. The pair (load, motion) works together: per metre of depth the work done by what lambda
/// drives is d(work) = load d(motion), times the area where a mean strain drives.
///   loads    load = lambda S with S = sum of the magnitudes |f_d| of the loads on discs, motion = sum f_d . u_d / S
///   motions  motion = lambda S with S the largest relative motion of two supports (the length of the difference of the
///            components that both prescribe, or of their rotations times a, from rest where all are alike),
///            load = sum of reactions . motions / S
///   strain   motion = lambda S with S the largest component, load = stress : strain / S, Pa
struct LoadPath {
  DrivenBy driven_by = DrivenBy::loads;
  RightHandSide pattern;              ///< at lambda = 1
  std::optional<RightHandSide> dead;  ///< none: there are no dead loads
  double size = 1;                    ///< S: N/m, m, or a strain
  LoadControl control = LoadControl::path;
  std::vector<double> legs;
  std::int64_t max_events = 0;

  /// Whether the control keeps lambda itself from falling.
  [[nodiscard]] bool controls_lambda() const {
    return control == (driven_by == DrivenBy::loads ? LoadControl::load : LoadControl::motion);
  }
};

/// \throws Error (bad_input) where an end is not finite, or a leg leads nowhere: to the lambda that it begins at
void check_legs(const std::vector<double>& legs);

/// \throws Error (bad_input) where contacts bend, or some kT < 0
void check_breaking_springs(const ContactSprings& springs);

/// \throws Error (bad_input) where nothing, or more than one of loads, motions and strain, grows with lambda, where a
///         strain is asked of a free assembly, a number is not finite or out of range, a leg leads nowhere, some kT <
///         0, or as number_unknowns and assemble_loads
LoadPath make_load_path(const Assembly& assembly, const ContactSprings& springs, const Effects& effects,
                        const LoadPathOptions& options);

/// Forces and motions are f0 + lambda f1 and u0 + lambda u1, so that load, motion and stress are linear in lambda and
/// energies quadratic. Arrays hold the coefficients of 1, lambda, lambda².
struct NetworkResponse {
  std::array<double, 2> load{};              ///< LoadPath, N/m or Pa
  std::array<double, 2> motion{};            ///< LoadPath, m or a strain
  std::array<Tensor2, 2> stress{};           ///< Pa, (1/A) sum F_i l_j over contacts; 0 where its area is not known
  std::array<double, 3> energy{};            ///< N, elastic
  std::array<double, 3> loads_by_motions{};  ///< N, sum f . u of all loads
  std::array<double, 2> power{};             ///< N, work of everything from outside over d(lambda)

  static double at(const std::array<double, 2>& c, double lambda) { return c[0] + lambda * c[1]; }
  static double at(const std::array<double, 3>& c, double lambda) { return c[0] + lambda * (c[1] + lambda * c[2]); }
  [[nodiscard]] Tensor2 stress_at(double lambda) const { return stress[0] + lambda * stress[1]; }
  [[nodiscard]] double energy_at(double lambda) const { return at(energy, lambda); }
  /// The energy that grows with lambda², N, as half of the work of the pattern (Clapeyron).
  [[nodiscard]] double pattern_energy_by_work() const { return 0.5 * power[1]; }
  /// Work of everything from outside while lambda goes from one value to another, N.
  [[nodiscard]] double work(double from, double to) const {
    return (to - from) * power[0] + 0.5 * (to * to - from * from) * power[1];
  }
};

/// m², of the assembly; 0: not known, and with it no stress.
double area_of_stress(const Assembly& assembly);

/// N/m, the largest component of any contact.
double largest_force(std::span<const ContactForce> forces);

/// \param area as area_of_stress
NetworkResponse response_of(const EquilibriumSums& sums, const LoadPath& path, double area);

/// \param system with the right-hand sides of the path, the pattern first
NetworkResponse response_of(const BreakableSystem& system, const Assembly& assembly, const ContactSprings& springs,
                            const LoadPath& path);

}  // namespace equidem
