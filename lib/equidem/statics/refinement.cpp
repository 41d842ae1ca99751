// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/refinement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/ordered_sums.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr std::size_t components_each = 1 << 14;
constexpr double of_one_pass = 2e-6;  // accuracy of iterations, which multiply by a matrix in single precision

double norm_of(std::span<const double> x) {
  return std::sqrt(sums_over<1>(x.size(), components_each, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (const double value : x.subspan(begin, end - begin)) sum += value * value;
    return std::array{sum};
  })[0]);
}

}  // namespace

StiffnessSolver::Refinement::Refinement(const StiffnessSolver& solver_in, const RightHandSide& given_in,
                                        std::span<double> residual, double good_enough_in)
    : solver(solver_in), given(given_in), good_enough(good_enough_in) {
  const auto& unknowns = solver.unknowns_;
  solution.motion = PreciseMotion(unknowns.held.size());
  bool moves = given.gradient.has_value();
  for (std::size_t k = 0; k < given.prescribed.size(); ++k) {
    if (unknowns.held[k] == 0 || given.prescribed[k] == 0) continue;
    solution.motion.high[k] = given.prescribed[k];
    moves = true;
  }
  if (moves) {
    evaluate(residual);
  } else {
    parallel_ranges(residual.size(), components_each, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        residual[k] = unknowns.held[k] != 0 || given.force.empty() ? 0 : given.force[k];
      }
    });
  }
  solution.residual = solver.norm_of_free(residual);
  solution.scale = std::max(solution.residual, affine_force());
  done = solution.residual == 0;
}

void StiffnessSolver::Refinement::correct(std::span<double> x, int pass) {
  parallel_ranges(x.size(), components_each, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      if (solver.unknowns_.held[k] != 0) x[k] = 0;
    }
  });
  ++corrections_;
  add_correction(x, pass);
}

void StiffnessSolver::Refinement::solve_to(double accuracy, std::span<double> x) {
  double energy = 0, reached = 1;
  do {
    reached = std::max(accuracy, of_one_pass * reached);
    energies = solver.factor_->solve_to(reached, energy, x);
    solution.motion.add(x);
    solution.residual = evaluate(x);
    solution.energy_error = energies.error;
    energy = std::max(energy, energies.solution);
  } while (reached > accuracy);
  done = true;
}

void StiffnessSolver::Refinement::add_correction(std::span<double> x, int pass) {
  constexpr double slow = 0.05;         // share of the error that a pass leaves
  constexpr double negligible = 1e-13;  // residual over its scale
  const double step = solver.norm_of_free(x);
  const bool scaled = pass > 0 && step > slow * last_step_ && scale_to_least_energy(x);
  last_step_ = step;
  if (pass > 0) previous_ = solution.motion;
  solution.motion.add(x);
  if (pass == 0) solution.motion.quadruple = rounding_of_forces() > negligible * solution.scale;
  const double before = solution.residual;
  const double now = evaluate(x);
  if (pass > 0 && !scaled && !(now < before)) {  // no better: keep the previous motion
    solution.motion = std::move(previous_);
    done = true;
    return;
  }
  previous_ = PreciseMotion(0);
  solution.residual = now;
  solution.refinements = pass;
  solution.energy_error =
      scaled ? energies.solution : std::max(energies.error, of_one_pass * of_one_pass * energies.solution);
  done = now <= good_enough * solution.scale || (pass > 0 && !scaled && now > 0.5 * before);
}

Solution StiffnessSolver::Refinement::finish() {
  constexpr const char* too_soft = "the stiffness matrix is too close to singular for the digits of a double";
  constexpr const char* remedy =
      "Hold a slender assembly in more places, make springs less different in size, or use fewer discs";
  constexpr double worthless = 1e-3;
  const double relative = solution.relative_residual();
  if (!std::isfinite(relative)) {
    bad_input("the numbers of this case overflow a double", fmt::format("the residual comes out as {}", relative),
              "Check the units of sizes, springs and loads");
  }
  if (!(relative <= worthless) && (solver.options_.accuracy == 0 || solution.energy_error == 0)) {
    computation_failed(fmt::format("the solution leaves a relative residual of {:.1e}", relative), too_soft, remedy);
  }
  const double size = std::hypot(norm_of(solution.motion.high), affine_length());
  if (corrections_ > 1 && relative > 0 && !(last_step_ <= worthless * size)) {
    computation_failed(fmt::format("the last of {} refinements still changed the motions by {:.1e} of their size",
                                   corrections_ - 1, last_step_ / size),
                       too_soft, remedy);
  }
  return std::move(solution);
}

double StiffnessSolver::Refinement::evaluate(std::span<double> residual) const {
  solver.evaluate_residual(given, solution.motion, residual);
  return solver.norm_of_free(residual);
}

/// Size of what the rounding of extended precision, 2^-64 of the motion of one body against the other, does to the
/// forces of contacts, N/m.
double StiffnessSolver::Refinement::rounding_of_forces() const {
  const Assembly& assembly = solver.assembly_;
  const auto b = static_cast<std::size_t>(solver.unknowns_.per_disc);
  const double scale = solver.unknowns_.rotation_scale;
  const std::vector<double>& u = solution.motion.high;
  const auto squared = [](double x) { return x * x; };
  return 0x1.0p-64 *
         std::sqrt(sums_over<1>(assembly.contacts.size(), components_each, [&](std::size_t begin, std::size_t end) {
           double sum = 0;
           for (std::size_t c = begin; c < end; ++c) {
             const Contact& contact = assembly.contacts[c];
             const std::size_t i = contact.i * b, j = contact.j * b;
             double square = squared(u[j] - u[i]) + squared(u[j + 1] - u[i + 1]);
             if (b == 3)
               square += squared(contact.lever_i * u[i + 2] / scale) + squared(contact.lever_j * u[j + 2] / scale);
             const SpringConstants& k = solver.springs_[c];
             sum += (squared(k.kN) + squared(k.kT)) * square;
           }
           return std::array{sum};
         })[0]);
}

/// x := (x.r / x.K x) x, the multiple of x at which the energy is stationary; false where there is none.
bool StiffnessSolver::Refinement::scale_to_least_energy(std::span<double> x) const {
  std::vector<double> residual(x.size());
  evaluate(residual);
  long double work = 0;
  for (std::size_t k = 0; k < x.size(); ++k) work += static_cast<long double>(x[k]) * residual[k];
  const double factor = static_cast<double>(work) / solver.twice_energy(x);
  constexpr double most = 100;  // more: the motions of the factor are not those of K
  if (!(factor > 0 && factor < most)) return false;
  for (double& value : x) value *= factor;
  return true;
}

/// Root of the sum of square(contact, deformation by the mean strain) over the contacts.
template <typename Square>
double StiffnessSolver::Refinement::norm_of_affine(const Square& square) const {
  if (!given.gradient) return 0;
  const Assembly& assembly = solver.assembly_;
  return std::sqrt(sums_over<1>(assembly.contacts.size(), components_each, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t c = begin; c < end; ++c) {
      sum +=
          square(c, affine_deformation(frame_of(assembly, c), assembly.branch(assembly.contacts[c]), *given.gradient));
    }
    return std::array{sum};
  })[0]);
}

double StiffnessSolver::Refinement::affine_length() const {
  return norm_of_affine(
      [](std::size_t, const ContactDeformation& d) { return d.normal * d.normal + d.tangential * d.tangential; });
}

/// Size of the forces that the mean strain causes, before they cancel on each disc.
double StiffnessSolver::Refinement::affine_force() const {
  return std::sqrt(2.0) * norm_of_affine([&](std::size_t c, const ContactDeformation& d) {
           const ContactForce f = linear_spring_force(solver.springs_[c], d);
           return f.normal * f.normal + f.tangential * f.tangential;
         });
}

}  // namespace equidem
