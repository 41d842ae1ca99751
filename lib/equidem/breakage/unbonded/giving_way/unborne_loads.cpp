// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/giving_way/unborne_loads.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "equidem/breakage/unbonded/giving_way/nearest_in_cone.hpp"

namespace equidem {
namespace {

constexpr std::size_t most_components = 1500;       // dense vectors of that length: 20 MB, some seconds
constexpr double lacking = 1e-6, proved_to = 1e-8;  // shares: a remainder below, or edges beyond, prove nothing

class ConeOfForces {
 public:
  ConeOfForces(const RateProblem& problem, std::span<const ContactStatus> status) : contacts_(problem.contacts) {
    std::vector<std::uint8_t> on_limit(problem.laws.size(), 0);
    for (const LimitContact& at : problem.limits) on_limit[at.contact] = 1;
    for (std::size_t c = 0; c < problem.laws.size(); ++c) {
      if (on_limit[c] != 0 || status[c] == ContactStatus::open) continue;
      line(c, {1, 0});
      const bool tangential = status[c] == ContactStatus::bonded ? problem.laws[c].k.kT > 0 : problem.laws[c].rough();
      if (tangential) line(c, {0, 1});
    }
    for (const LimitContact& at : problem.limits) {
      const UnbondedLaw& law = problem.laws[at.contact];
      const double mu = law.rough() ? law.friction : 0;
      if (at.limit == OnLimit::friction) {
        line(at.contact, {-1, at.direction * mu});
        edge(at.contact, {-1, 0});
        continue;
      }
      edge(at.contact, {-1, mu});
      if (mu > 0) edge(at.contact, {-1, -mu});
    }
  }
  [[nodiscard]] Cone take() { return std::move(cone_); }

 private:
  void line(std::size_t contact, const ContactForce& f) { cone_.lines.push_back(on_discs(contact, f)); }
  void edge(std::size_t contact, const ContactForce& f) { cone_.edges.push_back(on_discs(contact, f)); }
  /// The forces on discs that balance it, on components that are not held.
  [[nodiscard]] std::vector<double> on_discs(std::size_t contact, const ContactForce& f) const {
    std::vector<double> sum(contacts_.components(), 0.0);
    contacts_.add_internal(contact, f, sum);
    const auto& held = contacts_.unknowns().held;
    for (std::size_t k = 0; k < held.size(); ++k)
      if (held[k] != 0) sum[k] = 0;
    return sum;
  }

  const ContactOperator& contacts_;
  Cone cone_;
};

}  // namespace

std::optional<UnborneLoads> unborne_loads(const RateProblem& problem, std::span<const ContactStatus> status) {
  const Driving& driving = problem.driving;
  const auto& held = problem.contacts.unknowns().held;
  if (driving.by_motion || held.size() > most_components) return {};
  std::vector<double> load(held.size(), 0.0);
  for (std::size_t k = 0; k < load.size(); ++k) {
    if (held[k] != 0) continue;
    if (!driving.pattern->force.empty()) load[k] = driving.rate * driving.pattern->force[k];
    if (!driving.beside.empty()) load[k] += driving.beside[k];
  }
  if (std::ranges::all_of(load, [](double f) { return f == 0; })) return {};
  ConeRemainder found = remainder_outside(ConeOfForces(problem, status).take(), load);
  if (found.share < lacking || found.beyond > proved_to) return {};
  return UnborneLoads{std::move(found.remainder)};
}

}  // namespace equidem
