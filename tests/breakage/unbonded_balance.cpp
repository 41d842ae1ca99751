// SPDX-License-Identifier: GPL-3.0-or-later
// States of frictional contacts are in equilibrium, and their reported residual is that of their reported forces.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "equidem/statics/number_unknowns.hpp"

#include "breakage/random_packings.hpp"
#include "breakage/unbonded_scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// The forces that do not balance, from nothing but contact forces, frames and loads, summed in extended precision.
class Imbalance {
 public:
  /// \param path not begun: the loads that balance the forces at rest are those that balance its state
  explicit Imbalance(Unbonded& path)
      : path_(path),
        unknowns_(number_unknowns(path.assembly(), path.springs(), path.effects(), path.supports())),
        rest_(internal()) {}

  /// The largest component that is not balanced, N/m.
  [[nodiscard]] double largest() const {
    const UnbondedState& state = path_.run().contact_state();
    const LoadPath& loads = path_.path();
    const std::vector<long double> inside = internal();
    long double most = 0;
    for (std::size_t k = 0; k < inside.size(); ++k) {
      if (unknowns_.held[k] != 0) continue;
      long double outside = rest_[k];
      if (!loads.pattern.force.empty()) outside += static_cast<long double>(state.lambda()) * loads.pattern.force[k];
      if (loads.dead) outside += static_cast<long double>(state.dead()) * loads.dead->force[k];
      most = std::max(most, std::abs(outside - inside[k]));
    }
    return static_cast<double>(most);
  }
  [[nodiscard]] double largest_contact_force() const {
    double most = 0;
    for (const ContactForce& f : path_.run().contact_state().forces())
      most = std::max({most, std::abs(f.normal), std::abs(f.tangential)});
    return most;
  }

 private:
  [[nodiscard]] std::vector<long double> internal() const {
    const Assembly& assembly = path_.assembly();
    const auto b = static_cast<std::size_t>(unknowns_.per_disc);
    const std::span<const ContactForce> forces = path_.run().contact_state().forces();
    std::vector<long double> sum(unknowns_.held.size(), 0);
    for (std::size_t c = 0; c < forces.size(); ++c) {
      const ContactFrame frame = frame_of(assembly, c);
      const Contact& contact = assembly.contacts[c];
      const std::size_t i = static_cast<std::size_t>(contact.i) * b, j = static_cast<std::size_t>(contact.j) * b;
      const long double n = forces[c].normal, t = forces[c].tangential;
      const long double x = n * frame.normal.x + t * frame.tangent().x, y = n * frame.normal.y + t * frame.tangent().y;
      sum[i] -= x, sum[i + 1] -= y, sum[j] += x, sum[j + 1] += y;
      if (b < 3) continue;
      sum[i + 2] -= frame.lever_i * t / unknowns_.rotation_scale;
      sum[j + 2] -= frame.lever_j * t / unknowns_.rotation_scale;
    }
    return sum;
  }

  Unbonded& path_;
  DegreesOfFreedom unknowns_;
  std::vector<long double> rest_;
};

}  // namespace

// In these cells hardly anything holds some discs: they move by 1e5 times the deformation that their forces need, and
// contacts that slip without a force change sides.
TEST_CASE("forces_of_frictional_contacts_balance_where_discs_move_far_and_hardly_anything_holds_them") {
  std::int64_t states = 0, events = 0;
  double largest = 0;
  for (const std::uint64_t seed : {360,  697,  744,  1194, 1417, 1641, 2274, 2361, 2393, 2664, 2691, 3264, 3459,
                                   3480, 3609, 4104, 4209, 4224, 4569, 4944, 5064, 5289, 5409, 5529, 5889}) {
    const DrawnPacking d = draw_packing(seed);
    Unbonded path(d.assembly, d.springs, d.strengths, d.path, d.unbonded, d.rotation);
    const Imbalance imbalance(path);
    double force = 0;
    for (int steps = 0; steps < 100 && path.run().advance(); ++steps) {
      const UnbondedState& state = path.run().contact_state();
      const double told = state.relative_residual(), found = imbalance.largest();
      force = std::max(force, imbalance.largest_contact_force());
      CAPTURE(d.name, steps, told, found, force);
      CHECK(told < 1e-12);
      // The largest force so far may have been between two events. Sums of forces round differently.
      if (told > 0) CHECK(found <= 1e-12 * state.largest_force());
      if (told > 0) CHECK(found == Approx(told * state.largest_force()).margin(4e-15 * state.largest_force()));
      if (told > 0) CHECK(state.largest_force() >= force);
      largest = std::max(largest, told);
      ++states;
    }
    CAPTURE(d.name, path.run().why());
    CHECK(path.run().solver().largest_residual < 1e-12);
    events += std::ssize(path.events());
  }
  CAPTURE(states, events, largest);
  CHECK(states > 500);
  CHECK(largest > 0);
}

// In the first four cells discs that hardly anything holds move far while all forces are round-off, before contacts
// carry some; in the next one all forces vanish at once, at an event that is met to a share of the largest; in the last
// one a contact closes that overlaps by 1e-10 of the largest force. Contacts change their state while their force is
// below what UnbondedState calls negligible: the work of such forces on the way is missing. A ledger calls negligible
// 1e5 times the work of rounded forces on the whole way.
TEST_CASE("energies_of_frictional_contacts_close_where_all_forces_were_round_off_or_have_vanished") {
  for (const std::uint64_t seed : {321, 4089, 4104, 5328, 1665, 4505}) {
    const DrawnPacking d = draw_packing(seed);
    Unbonded path(d.assembly, d.springs, d.strengths, d.path, d.unbonded, d.rotation);
    const UnbondedState& state = path.run().contact_state();
    Way way(state.motion().high);
    double largest = 0, met = 0;
    bool more = true;
    for (int steps = 0; more && steps < 400; ++steps) {
      more = path.run().advance();
      const PathLedger& ledger = state.ledger();
      const double missing = ledger.missing(), before = way.length();
      way.go_to(state.motion().high);
      met += state.negligible_force() * (way.length() - before);
      largest = std::max({largest, std::abs(ledger.work), ledger.elastic});
      CAPTURE(d.name, steps, missing, largest, met, ledger.negligible);
      CHECK(std::abs(missing) <= met + 1e-5 * ledger.negligible);
    }
    CAPTURE(d.name, largest, path.run().why());
    CHECK(path.run().energy_error() < 1e-10);
    CHECK(largest > path.run().ledger().negligible);
  }
}
