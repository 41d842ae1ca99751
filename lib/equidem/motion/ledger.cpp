// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/motion/ledger.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace equidem {
namespace {

using enum EnergyRole;
constexpr int bonded = 1, colliding = 2;

struct ListedTerm {
  EnergyTerm term;
  int families;
};

constexpr ListedTerm all_terms[] = {
    {{"kinetic", "kinetic", stored, &EnergyLedger::kinetic}, bonded | colliding},
    {{"elastic", "elastic", stored, &EnergyLedger::elastic_bonded}, bonded},
    {{"elastic_normal", "normal springs", stored, &EnergyLedger::elastic_normal}, colliding},
    {{"elastic_tangential", "tangential springs", stored, &EnergyLedger::elastic_tangential}, colliding},
    {{"elastic_rolling", "rolling springs", stored, &EnergyLedger::elastic_rolling}, colliding},
    {{"cohesion", "cohesion", stored, &EnergyLedger::cohesion}, colliding},
    {{"elastic_bond", "springs of bonds", stored, &EnergyLedger::elastic_bond}, colliding},
    {{"potential", "potential", stored, &EnergyLedger::potential}, bonded | colliding},
    {{"sway", "sway of leapfrog", sway, &EnergyLedger::sway}, bonded},
    {{"damped_mass", "mass damping", lost, &EnergyLedger::damped_mass}, bonded},
    {{"damped_contact", "contacts", lost, &EnergyLedger::damped_contact}, bonded},
    {{"damped_local", "local damping", lost, &EnergyLedger::damped_local}, bonded},
    {{"lost_restitution", "restitution", lost, &EnergyLedger::lost_restitution}, colliding},
    {{"lost_dashpot", "normal dashpots", lost, &EnergyLedger::lost_dashpot}, colliding},
    {{"lost_slip", "slip", lost, &EnergyLedger::lost_slip}, colliding},
    {{"lost_tangential_dashpot", "tangential dashpots", lost, &EnergyLedger::lost_tangential_dashpot}, colliding},
    {{"lost_rolling", "rolling", lost, &EnergyLedger::lost_rolling}, colliding},
    {{"lost_release", "released when contacts opened", lost, &EnergyLedger::lost_release}, colliding},
    {{"lost_bond", "bonds", lost, &EnergyLedger::lost_bond}, colliding},
    {{"lost_breaking", "bonds that broke", lost, &EnergyLedger::lost_breaking}, colliding},
    {{"work_of_loads", "loads", work, &EnergyLedger::work_of_loads}, bonded},
    {{"work_of_supports", "supports", work, &EnergyLedger::work_of_supports}, bonded},
    {{"work_of_walls", "walls", work, &EnergyLedger::work_of_walls}, bonded | colliding},
    {{"work_of_cell", "periodic cell", work, &EnergyLedger::work_of_cell}, colliding},
    {{"work_of_stages", "changes between stages", work, &EnergyLedger::work_of_stages}, colliding},
    {{"initial", "at the start", initial, &EnergyLedger::initial}, bonded | colliding},
};
static_assert(sizeof(EnergyLedger) == std::size(all_terms) * sizeof(double), "a term of the ledger is not listed");

double total(const EnergyLedger& ledger, EnergyRole role) {
  double sum = 0;
  for (const ListedTerm& listed : all_terms)
    if (listed.term.role == role) sum += ledger.*listed.term.value;
  return sum;
}

std::vector<EnergyTerm> terms_of(int family) {
  std::vector<EnergyTerm> terms;
  for (const ListedTerm& listed : all_terms)
    if ((listed.families & family) != 0) terms.push_back(listed.term);
  return terms;
}

}  // namespace

double EnergyLedger::lost() const {
  return total(*this, EnergyRole::lost);
}

double EnergyLedger::work() const {
  return total(*this, EnergyRole::work);
}

double EnergyLedger::error() const {
  return total(*this, EnergyRole::stored) - sway + lost() - work() - initial;
}

double EnergyLedger::largest() const {
  double most = 0;
  for (const double energy : {kinetic, elastic(), potential, cohesion, lost(), work(), initial})
    most = std::max(most, std::abs(energy));
  return most;
}

std::span<const EnergyTerm> energy_terms(BodyFamily family) {
  static const std::vector<EnergyTerm> of_bonded = terms_of(bonded), of_colliding = terms_of(colliding);
  return family == BodyFamily::bonded ? of_bonded : of_colliding;
}

std::span<const EnergyTerm> energy_terms() {
  static const std::vector<EnergyTerm> of_all = terms_of(bonded | colliding);
  return of_all;
}

}  // namespace equidem
