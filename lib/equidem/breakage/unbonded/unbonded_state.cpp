// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/unbonded_state.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "equidem/breakage/load_path.hpp"
#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

constexpr std::size_t contacts_at_once = 1 << 12;
constexpr double on_limit = 1e-11;  // of the largest force: a contact is on a limit of its law
constexpr double no_force = 1e5;    // of the force of rounded motions: nothing carries a force as long as all are below

ContactForce operator+(const ContactForce& a, const ContactForce& b) {
  return {a.normal + b.normal, a.tangential + b.tangential};
}

double largest_of(const ContactForce& f) {
  return std::max(std::abs(f.normal), std::abs(f.tangential));
}

ContactForce scaled(const ContactForce& f, double by) {
  return {by * f.normal, by * f.tangential};
}

/// Mean force times deformation, of a path along which both are linear.
double work_of(const ContactForce& from, const ContactForce& to, const PreciseDeformation& d0,
               const PreciseDeformation& d1) {
  return 0.5 * ((from.normal + to.normal) * static_cast<double>(d1.normal - d0.normal) +
                (from.tangential + to.tangential) * static_cast<double>(d1.tangential - d0.tangential));
}

}  // namespace

UnbondedState::UnbondedState(const Assembly& assembly, const ContactSprings& springs, const LoadPath& path,
                             const DegreesOfFreedom& unknowns, const ContactOperator& contacts,
                             std::span<const UnbondedLaw> laws, std::vector<ContactStatus> status)
    : assembly_(assembly),
      springs_(springs),
      path_(path),
      unknowns_(unknowns),
      contacts_(contacts),
      laws_(laws),
      graph_(assembly),
      affine_(contacts.affine(path.pattern.gradient)),
      status_(std::move(status)),
      slip_(laws.size(), 0),
      motion_(contacts.components()),
      rest_load_(contacts.components(), 0.0),
      kept_(laws.size()),
      released_by_(laws.size(), 0.0),
      deformation_(laws.size()),
      forces_(laws.size()),
      carried_(laws.size(), 1),
      internal_(contacts.components(), 0.0) {
  evaluate();
  for (std::size_t k = 0; k < internal_.size(); ++k) rest_load_[k] = unknowns_.held[k] != 0 ? 0 : internal_[k];
  rest_energy_ = elastic_energy();
  std::vector<double> residual(contacts_.components());
  measure_residual(residual);
}

void UnbondedState::evaluate() {
  const SpringNetwork network{assembly_, graph_, springs_, unknowns_};
  std::optional<Tensor2> gradient;
  if (path_.pattern.gradient) gradient = lambda_ * *path_.pattern.gradient;
  parallel_ranges(laws_.size(), contacts_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      deformation_[c] = precise_deformation_of(network, motion_, gradient, c);
      forces_[c] = laws_[c].force(status_[c], deformation_[c], slip_[c]) + scaled(kept_[c], share_);
    }
  });
  internal_force(assembly_, graph_, unknowns_, forces_, internal_);
}

double UnbondedState::outside(std::size_t k) const {
  const std::vector<double>& load = path_.pattern.force;
  double f = rest_load_[k] + (load.empty() ? 0 : lambda_ * load[k]);
  if (path_.dead) f += dead_ * path_.dead->force[k];
  return f;
}

void UnbondedState::measure_residual(std::vector<double>& residual) {
  double largest = 0, force = 0;
  for (const ContactForce& f : forces_) force = std::max(force, largest_of(f));
  for (std::size_t k = 0; k < residual.size(); ++k) {
    const double from_outside = outside(k);
    force = std::max(force, std::abs(from_outside));
    residual[k] = unknowns_.held[k] != 0 ? 0 : from_outside - internal_[k];
    largest = std::max(largest, std::abs(residual[k]));
  }
  round_off_force_ = std::max(round_off_force_, rounded_motion * springs_.largest() * farthest());
  force_scale_ = std::max({force_scale_, force, round_off_force_});
  residual_ = carries() ? largest / force_scale_ : 0;
}

bool UnbondedState::carries() const {
  return force_scale_ > no_force * round_off_force_;
}

void UnbondedState::correct(bool by_motion, TangentSolver& solver) {
  constexpr double good = 4e-15;
  constexpr int most = 40;
  constexpr double slowest = 0.8;  // the ground leaves as much of a residual where motions are four times as soft
  std::vector<double> residual(contacts_.components());
  std::optional<MotionControl> control;
  evaluate();
  measure_residual(residual);
  // Contacts that slip without a force may have changed sides behind the rates.
  if (residual_ > good) solver.set(tangents_of(laws_, status_));
  for (int k = 0; k < most && residual_ > good; ++k) {
    const double before = residual_;
    const auto kept = std::pair(motion_, lambda_);
    solver.solve(residual);
    if (by_motion && !control) control.emplace(contacts_, solver, path_.pattern.force);
    if (control) lambda_ += control->hold(residual, 0);
    motion_.add(residual);
    evaluate();
    measure_residual(residual);
    if (residual_ < slowest * before) continue;
    if (residual_ >= before) {
      motion_ = kept.first;
      lambda_ = kept.second;
      evaluate();
      measure_residual(residual);
    }
    break;
  }
}

void UnbondedState::move(double t, const Rates& rates, bool dead, bool by_motion, TangentSolver& solver) {
  const std::vector<PreciseDeformation> deformation = deformation_;
  const std::vector<ContactForce> forces = forces_;
  const std::vector<DoubleDouble> slip = slip_;
  const std::vector<double> internal = internal_;
  const PreciseMotion before = motion_;
  const double lambda = lambda_, dead_before = dead_, was_kept = kept_share_;
  std::vector<double> loads(contacts_.components()), step(rates.motion);
  for (std::size_t k = 0; k < loads.size(); ++k) loads[k] = outside(k);
  for (double& x : step) x *= t;
  motion_.add(step);
  (dead ? dead_ : lambda_) += t * rates.lambda;
  try {
    correct(by_motion, solver);
  } catch (...) {  // the path ends with the last state that balances
    motion_ = before, lambda_ = lambda, dead_ = dead_before, share_ = was_kept;
    deformation_ = deformation, forces_ = forces, internal_ = internal;
    throw;
  }
  // Round-off on long ways is no work, as long as nothing carries a force.
  const bool works = carries();
  for (std::size_t k = 0; works && k < loads.size(); ++k) {
    const double by = motion_.high[k] - before.high[k];
    ledger_.work += 0.5 * by * (unknowns_.held[k] != 0 ? internal[k] + internal_[k] : loads[k] + outside(k));
  }
  for (std::size_t c = 0; c < laws_.size(); ++c) {
    if (is_slipping(status_[c])) {
      slip_[c] = laws_[c].slip_at(deformation_[c], forces_[c].tangential - share_ * kept_[c].tangential);
      const double then = forces[c].tangential - was_kept * kept_[c].tangential;
      const double now = forces_[c].tangential - share_ * kept_[c].tangential;
      if (works) ledger_.friction += 0.5 * (then + now) * static_cast<double>(slip_[c] - slip[c]);
    }
    if (works && !affine_.empty())
      ledger_.work +=
          work_of(forces[c], forces_[c], {}, {affine_[c].normal, affine_[c].tangential}) * (lambda_ - lambda);
  }
  for (const std::size_t c : releasing_) {
    const double by = work_of(scaled(kept_[c], was_kept), scaled(kept_[c], share_), deformation[c], deformation_[c]);
    released_by_[c] += by;
    ledger_.released += by;
  }
  kept_share_ = share_;
  const double none = negligible_force();
  for (std::size_t c = 0; c < laws_.size(); ++c) {
    const double then = releasing_.empty() && t > 0 ? largest_of(forces[c]) : 0;
    carried_[c] = std::max(then, largest_of(forces_[c])) > none ? 1 : 0;
  }
  if (works) ledger_.take(elastic_energy() - rest_energy_);
  ledger_.negligible = std::max(ledger_.negligible, no_force * round_off_force() * farthest());
}

double UnbondedState::negligible_force() const {
  return on_limit * force_scale_ + 4 * round_off_force();
}

double UnbondedState::farthest() const {
  double far = 0, strained = 0;
  for (const double u : motion_.high) far = std::max(far, std::abs(u));
  for (const ContactDeformation& d : affine_)
    strained = std::max({strained, std::abs(d.normal), std::abs(d.tangential)});
  return std::max(far, std::abs(lambda_) * strained);
}

void UnbondedState::set_status(std::size_t c, ContactStatus status) {
  if (status_[c] == status) return;
  const ContactForce before = law_force(c);
  const ContactStatus was = std::exchange(status_[c], status);
  const UnbondedLaw& law = laws_[c];
  const PreciseDeformation& d = deformation_[c];
  // A contact that closes has no tangential force; where it leaves a limit it keeps that of the limit.
  if (was == ContactStatus::open) slip_[c] = law.slip_at(d, 0);
  const ContactForce after = law_force(c);
  const double jump = std::max(std::abs(after.normal - before.normal), std::abs(after.tangential - before.tangential));
  if (jump <= negligible_force()) return;
  if (is_slipping(status)) slip_[c] = law.slip_at(d, after.tangential);
  forces_[c] = after + scaled(kept_[c], share_);
  unsettled_ = true;
}

void UnbondedState::settle(const Rates& rates, bool dead, bool by_motion, TangentSolver& solver) {
  if (std::exchange(unsettled_, false)) move(0, rates, dead, by_motion, solver);
}

void UnbondedState::break_bond(std::size_t c, ContactStatus status) {
  const UnbondedLaw& law = laws_[c];
  // Bonds that are already being released begin anew with what they have kept.
  for (const std::size_t other : releasing_) kept_[other] = scaled(kept_[other], share_);
  const double bond = linear_spring_energy_of(law.k, forces_[c]);
  const ContactForce force = forces_[c];
  status_[c] = status;
  ContactForce after = law.force(status, deformation_[c], slip_[c]);
  if (is_slipping(status)) slip_[c] = law.slip_at(deformation_[c], after.tangential);
  const double left = linear_spring_energy_of(law.k, after);
  released_by_[c] = bond - left;
  ledger_.released += bond - left;
  kept_[c] = {force.normal - after.normal, force.tangential - after.tangential};
  releasing_.push_back(c);
  share_ = kept_share_ = 1;
  ledger_.take(elastic_energy() - rest_energy_);
}

void UnbondedState::end_release() {
  for (const std::size_t c : releasing_) kept_[c] = {};
  releasing_.clear();
  share_ = kept_share_ = 0;
}

std::vector<double> UnbondedState::unreleased() const {
  std::vector<double> f(contacts_.components(), 0.0);
  for (const std::size_t c : releasing_) contacts_.add_internal(c, scaled(kept_[c], share_), f);
  return f;
}

double UnbondedState::normal_coordinate(std::size_t c) const {
  return laws_[c].normal_coordinate(deformation_[c]);
}

double UnbondedState::elastic_energy() const {
  double sum = 0;
  for (std::size_t c = 0; c < laws_.size(); ++c)
    sum += linear_spring_energy_of(laws_[c].k, laws_[c].force(status_[c], deformation_[c], slip_[c]));
  return sum;
}

double UnbondedState::load() const {
  if (path_.driven_by == DrivenBy::loads) return lambda_ * path_.size;
  double sum = 0;
  if (path_.driven_by == DrivenBy::motions) {
    const std::vector<double>& moved = path_.pattern.prescribed;
    for (std::size_t k = 0; k < moved.size(); ++k) {
      if (unknowns_.held[k] != 0) sum += moved[k] * (internal_[k] - outside(k));
    }
    return sum / path_.size;
  }
  for (std::size_t c = 0; c < laws_.size(); ++c)
    sum += forces_[c].normal * affine_[c].normal + forces_[c].tangential * affine_[c].tangential;
  return sum / (path_.size * assembly_.area());
}

double UnbondedState::mean_motion() const {
  if (path_.driven_by != DrivenBy::loads) return lambda_ * path_.size;
  double sum = 0;
  for (std::size_t k = 0; k < motion_.high.size(); ++k) sum += path_.pattern.force[k] * motion_.high[k];
  return sum / path_.size;
}

Tensor2 UnbondedState::stress() const {
  const double area = area_of_stress(assembly_);
  Tensor2 sum;
  if (area <= 0) return sum;
  for (std::size_t c = 0; c < laws_.size(); ++c)
    sum += outer(force_on_i(frame_of(assembly_, c), forces_[c]), assembly_.branch(assembly_.contacts[c]));
  return (1 / area) * sum;
}

}  // namespace equidem
