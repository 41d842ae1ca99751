// SPDX-License-Identifier: GPL-3.0-or-later
// Rates that are proved to be unique, against all combinations of the statuses of contacts on limits.
#include "equidem/breakage/unbonded/unique_rates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/breakage/unbonded/limit_compliance.hpp"
#include "equidem/breakage/unbonded/rate_branches.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/core/random.hpp"
#include "equidem/statics/number_unknowns.hpp"

#include "support/assemblies.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

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

  void open(std::size_t contact) { status_[contact] = ContactStatus::open; }
  void bond(std::size_t contact) { status_[contact] = ContactStatus::bonded; }
  void limit(LimitContact at) { limits_.push_back(at); }
  [[nodiscard]] std::size_t contacts() const { return laws_.size(); }
  [[nodiscard]] std::size_t components() const { return contacts_.components(); }

  struct Answers {
    bool found = false, proved = false;
    Branches branches;
  };
  Answers load(std::vector<double> force) {
    const RightHandSide pattern{.force = std::move(force), .prescribed = std::vector<double>(components(), 0.0)};
    const RateProblem problem{contacts_, laws_, limits_, {.pattern = &pattern, .rate = 1}};
    RateAnswer answer = solve_rates(problem, solver_, status_);
    if (!answer.agrees || !answer.rates.balanced) {
      std::optional<RateAnswer> other = pivot_rates(problem, solver_, status_);
      if (!other) return {};
      answer = std::move(*other);
    }
    const std::vector<double> compliance = limit_compliance(problem, solver_);
    return {true, proved_unique(problem, compliance, answer.status), find_branches(problem, compliance, answer, {})};
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

}  // namespace

// What is not proved may still have one answer for these loads: the proof is of all loads, and fails where contacts
// that let go together hold nothing.
TEST_CASE("rates_that_are_proved_unique_have_no_other_combination_of_statuses") {
  std::int64_t loads = 0, found = 0, proved = 0, several = 0, usual = 0, usual_proved = 0;
  std::int64_t with_apex = 0, apex_proved = 0, apex_several = 0;  // some contact is at the apex
  for (std::uint64_t seed = 1; seed <= 600; ++seed) {
    Random random(seed);
    const Assembly assembly = delaunay_assembly({.discs = 9,
                                                 .points = PointProcess::perturbed_hexagonal,
                                                 .disorder = 0.25,
                                                 .seed = seed,
                                                 .radii = {.smallest = 0.5, .largest = 0.5}});
    std::vector<SpringConstants> springs;
    for (std::size_t c = 0; c < assembly.contacts.size(); ++c)
      springs.push_back({random.uniform(0.5, 2), random.uniform(0.1, 1)});
    const double friction = std::array{0.1, 0.3, 0.8, 2.0, 5.0}[seed % 5];
    LimitNetwork network(assembly, ContactSprings(std::move(springs)), {{"bottom", 0, 0, {}}}, friction);
    std::size_t on_limits = 0;
    bool at_apex = false;
    for (std::size_t c = 0; c < network.contacts(); ++c) {
      const double kind = random.uniform(0, 1);
      if (kind < 0.12) network.open(c);
      if (kind > 0.12 && kind < 0.3) network.bond(c);
      if (kind < 0.7 || on_limits == 5) continue;
      ++on_limits;
      const bool apex = random.uniform(0, 1) < 0.3;
      at_apex = at_apex || apex;
      network.limit({c, apex ? OnLimit::apex : OnLimit::friction, random.uniform(-1, 1) < 0 ? -1.0 : 1.0});
    }
    for (int k = 0; k < 4; ++k) {
      std::vector<double> force(network.components());
      for (double& f : force) f = random.uniform(-1, 1);
      const LimitNetwork::Answers answers = network.load(force);
      ++loads;
      found += answers.found ? 1 : 0;
      if (!answers.found || !answers.branches.all_tried) continue;
      CAPTURE(seed, friction, on_limits, answers.branches.others);
      proved += answers.proved ? 1 : 0;
      several += answers.branches.others > 0 ? 1 : 0;
      if (at_apex) {
        ++with_apex;
        apex_proved += answers.proved ? 1 : 0;
        apex_several += answers.branches.others > 0 ? 1 : 0;
      }
      if (friction < 0.5) ++usual, usual_proved += answers.proved ? 1 : 0;
      if (answers.proved) CHECK(answers.branches.others == 0);
    }
  }
  CAPTURE(loads, found, proved, several, usual, usual_proved, with_apex, apex_proved, apex_several);
  CHECK(found > 1000);  // other loads move discs that nothing holds, or have no answer
  CHECK(apex_proved > 100);
  CHECK(apex_several > 20);
  CHECK(proved > 300);
  CHECK(several > 50);
  CHECK(usual_proved > usual / 2);
}

TEST_CASE("one_contact_at_the_limit_of_friction_is_proved_unique_up_to_klarbrings_friction") {
  // The disc of where_friction_leaves_two_answers_both_are_told: the limit is mu = 1 in one direction, none in the
  // other.
  Assembly scene = chain_of_discs(2, 1);
  const double r = std::sqrt(2.0);
  scene.centres.push_back(scene.centres[1] + Vec2{r, r});
  scene.radii.push_back(1);
  scene.contacts.push_back({1, 2, 0, 0, 1, 1});
  scene.groups["held"] = {{0, 2}, {}};
  scene.groups["disc"] = {{1}, {}};
  const ContactSprings springs(std::vector<SpringConstants>{{1000, 300}, {1000, 0}});
  for (const double friction : {0.0, 0.5, 0.999, 1.001, 5.0}) {
    for (const double direction : {-1.0, 1.0}) {
      CAPTURE(friction, direction);
      LimitNetwork network(scene, springs, {{"held", 0, 0, 0}, {"disc", {}, {}, 0}}, friction);
      network.bond(1);
      network.limit({0, OnLimit::friction, direction});
      std::vector<double> force(network.components());
      force[3] = -1;
      const LimitNetwork::Answers answers = network.load(force);
      const bool unique = friction < 1 || direction > 0;
      if (unique) REQUIRE(answers.found);
      CHECK(answers.proved == unique);
    }
  }
}
