// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The rates at which a network with unbonded contacts goes on: motions, load factor and deformations, per unit of a
/// parameter that grows along the path.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "equidem/breakage/path_numbers.hpp"
#include "equidem/breakage/unbonded/contact_law.hpp"
#include "equidem/breakage/unbonded/contact_operator.hpp"
#include "equidem/breakage/unbonded/tangent_solver.hpp"
#include "equidem/statics/stiffness_solver.hpp"

namespace equidem {

/// The cause of a motion: the pattern times the rate of lambda, and forces beside it.
struct Driving {
  const RightHandSide* pattern = nullptr;
  std::span<const ContactDeformation> affine{};  ///< of the pattern's mean gradient; empty: none
  std::span<const double> beside{};              ///< N/m per component and unit; empty: none
  bool by_motion = false;  ///< the motion f . u of the pattern's loads f is prescribed, and lambda follows
  double rate = 0;         ///< of lambda, or of f . u
};

struct Rates {
  std::vector<double> motion;                     ///< per component
  std::vector<ContactDeformation> deformation{};  ///< per contact, that of a mean gradient included
  double lambda = 0;
  double force_scale = 0;  ///< the largest rate of a contact force or load
  double round_off = 0;    ///< of rates of forces, by the rounding of motions
  double negligible = 0;   ///< rates of forces, and of gaps times kN, below are round-off
  bool balanced = false;   ///< false: loads drive a motion that nothing resists

  void pass(PathNumbers& n) {
    EQUIDEM_PASS(n, motion, deformation, lambda, force_scale, round_off, negligible, balanced);
  }
};

/// Where the work of loads on a motion is prescribed, and not the loads.
class MotionControl {
 public:
  /// \param load N/m, per component; must outlive the object
  MotionControl(const ContactOperator& contacts, const TangentSolver& solver, std::span<const double> load);
  /// Adds the motion by lambda times the loads, so that these do the work `wanted`. \return lambda
  double hold(std::span<double> motion, double wanted) const;
  /// The work of the loads on the motion that they cause.
  [[nodiscard]] double work() const { return work_; }

 private:
  std::span<const double> load_;
  std::vector<double> along_;
  double work_ = 0;
};

/// The motion of held components at this rate of lambda, all others at rest.
Rates driven_rates(const ContactOperator& contacts, const Driving& driving, double lambda);
ContactDeformation deformation_of(const ContactOperator& contacts, const Driving& driving, const Rates& rates,
                                  std::size_t contact);
/// The residual of the rates: driving forces less those that contacts take. Sets deformations and scales of `rates`.
/// \return its largest component over the largest rate of a force
double residual_of(const ContactOperator& contacts, std::span<const ContactTangent> tangents, const Driving& driving,
                   Rates& rates, std::vector<double>& residual);

/// One linear problem with given tangents, refined until forces balance without the springs that hold what nothing
/// resists: those motions are then the least ones.
Rates rates_of(const ContactOperator& contacts, TangentSolver& solver, std::span<const ContactTangent> tangents,
               const Driving& driving);

struct RateProblem {
  const ContactOperator& contacts;
  std::span<const UnbondedLaw> laws;
  std::span<const LimitContact> limits;
  Driving driving;
  double rounded = 1e-11;  ///< rates of force below this share of the largest spring times its rate are round-off
};

struct RateAnswer {
  bool agrees = false;                ///< false: no set of statuses was found that agrees with its rates
  std::vector<ContactStatus> status;  ///< per contact
  Rates rates;
};

std::vector<ContactTangent> tangents_of(std::span<const UnbondedLaw> laws, std::span<const ContactStatus> status);

/// The statuses of the contacts on limits that agree with the rates which follow from them, by Newton's method on the
/// piecewise linear problem from the statuses given. It may go round in circles; rate_path.hpp does not.
RateAnswer solve_rates(const RateProblem& problem, TangentSolver& solver, std::vector<ContactStatus> status);

}  // namespace equidem
