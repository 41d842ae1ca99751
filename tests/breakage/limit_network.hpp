// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Rate problems of contacts on their limits, as the library solves them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/breakage/unbonded/rate_path.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/core/random.hpp"
#include "equidem/statics/number_unknowns.hpp"

namespace equidem::test {

/// A network with contacts on limits, to be loaded at will.
class LimitNetwork {
 public:
  LimitNetwork(Assembly assembly, ContactSprings springs, std::vector<Support> supports, double friction)
      : assembly_(std::move(assembly)),
        springs_(std::move(springs)),
        unknowns_(
            number_unknowns(assembly_, springs_, derive_effects(assembly_, springs_, Rotation::from_scene), supports)),
        contacts_(assembly_, unknowns_),
        solver_(contacts_, 1e-9 * springs_.largest()),
        status_(assembly_.contacts.size(), ContactStatus::stuck) {
    for (std::size_t c = 0; c < assembly_.contacts.size(); ++c) laws_.push_back({springs_[c], friction, {}});
  }

  LimitNetwork(const LimitNetwork&) = delete;
  LimitNetwork& operator=(const LimitNetwork&) = delete;

  void open(std::size_t contact) { status_[contact] = ContactStatus::open; }
  void bond(std::size_t contact) { status_[contact] = ContactStatus::bonded; }
  void limit(LimitContact at) { limits_.push_back(at); }
  void friction(std::size_t contact, double mu) { laws_[contact].friction = mu; }
  [[nodiscard]] const Assembly& assembly() const { return assembly_; }
  [[nodiscard]] const DegreesOfFreedom& unknowns() const { return unknowns_; }
  [[nodiscard]] const std::vector<UnbondedLaw>& laws() const { return laws_; }
  [[nodiscard]] const std::vector<LimitContact>& limits() const { return limits_; }
  [[nodiscard]] const std::vector<ContactStatus>& status() const { return status_; }
  [[nodiscard]] std::size_t contacts() const { return laws_.size(); }
  [[nodiscard]] std::size_t components() const { return contacts_.components(); }

  struct Answers {
    bool found = false;
    bool driven = false;                  ///< none is found: loads drive a motion that nothing resists
    std::vector<ContactStatus> status{};  ///< per contact, of the answer
    std::vector<ContactForce> force{};    ///< per contact on a limit
  };
  Answers load(std::vector<double> force) {
    const RightHandSide pattern{.force = std::move(force), .prescribed = std::vector<double>(components(), 0.0)};
    const RateProblem problem = problem_of(pattern);
    const RateSearch search = search_rates(problem, solver_, status_);
    if (!search.found) return {.driven = search.answer.agrees};
    return {.found = true, .status = search.answer.status, .force = forces_of(search.answer)};
  }
  [[nodiscard]] RateProblem problem_of(const RightHandSide& pattern) const {
    return {contacts_, laws_, limits_, {.pattern = &pattern, .rate = 1}};
  }
  /// Rates of force, per contact on a limit.
  [[nodiscard]] std::vector<ContactForce> forces_of(const RateAnswer& answer) const {
    std::vector<ContactForce> forces;
    for (const LimitContact& at : limits_) {
      const ContactTangent tangent = laws_[at.contact].tangent(answer.status[at.contact]);
      forces.push_back(tangent.rate(answer.rates.deformation[at.contact]));
    }
    return forces;
  }

 private:
  Assembly assembly_;
  ContactSprings springs_;
  DegreesOfFreedom unknowns_;
  ContactOperator contacts_;
  TangentSolver solver_;
  std::vector<UnbondedLaw> laws_;
  std::vector<LimitContact> limits_;
  std::vector<ContactStatus> status_;
};

/// Nine discs of which the lowest are held, with up to `most` contacts on limits, `apex` of them without a force.
/// \param kinds shares of open contacts and of bonds, and of contacts off their limits or either
inline std::unique_ptr<LimitNetwork> random_limit_network(std::uint64_t seed, Random& random, double friction,
                                                          std::size_t most = 5, double apex = 0.3,
                                                          std::array<double, 3> kinds = {0.12, 0.3, 0.7}) {
  const Assembly assembly = delaunay_assembly({.discs = 9,
                                               .points = PointProcess::perturbed_hexagonal,
                                               .disorder = 0.25,
                                               .seed = seed,
                                               .radii = {.smallest = 0.5, .largest = 0.5}});
  std::vector<SpringConstants> springs;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c)
    springs.push_back({random.uniform(0.5, 2), random.uniform(0.1, 1)});
  auto made = std::make_unique<LimitNetwork>(assembly, ContactSprings(std::move(springs)),
                                             std::vector<Support>{{"bottom", 0, 0, {}}}, friction);
  LimitNetwork& network = *made;
  for (std::size_t c = 0; c < network.contacts(); ++c) {
    const double kind = random.uniform(0, 1);
    if (kind < kinds[0]) network.open(c);
    if (kind > kinds[0] && kind < kinds[1]) network.bond(c);
    if (kind < kinds[2] || network.limits().size() == most) continue;
    const bool at_apex = random.uniform(0, 1) < apex;
    network.limit({c, at_apex ? OnLimit::apex : OnLimit::friction, random.uniform(-1, 1) < 0 ? -1.0 : 1.0});
  }
  return made;
}

}  // namespace equidem::test
