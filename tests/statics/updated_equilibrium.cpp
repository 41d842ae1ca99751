// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// States of rest from a factor that is updated, and the contacts that break next, against factorizing anew.
#include "equidem/statics/breaking/updated_equilibrium.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/random.hpp"

#include "statics/breaking_scenes.hpp"
#include "support/assemblies.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

double largest_force(const std::vector<ContactForce>& forces) {
  double largest = 0;
  for (const ContactForce& f : forces) largest = std::max({largest, std::abs(f.normal), std::abs(f.tangential)});
  return largest;
}

double force_difference(const std::vector<ContactForce>& a, const std::vector<ContactForce>& b) {
  double largest = 0;
  for (std::size_t c = 0; c < a.size(); ++c) {
    largest = std::max({largest, std::abs(a[c].normal - b[c].normal), std::abs(a[c].tangential - b[c].tangential)});
  }
  return largest / largest_force(b);
}

/// The least load factor by the definition, contact by contact; the next one must be apart for the contact to be
/// compared.
struct Least {
  double load_factor = std::numeric_limits<double>::infinity();
  std::int64_t contact = -1;
  double next = std::numeric_limits<double>::infinity();
};

Least first_to_break(const BreakingScene& scene, const std::vector<std::vector<ContactForce>>& forces,
                     const std::vector<std::uint8_t>& gone) {
  Least least;
  for (std::size_t c = 0; c < forces[0].size(); ++c) {
    if (gone[c] != 0) continue;
    const ContactForce dead = forces.size() > 1 ? forces[1][c] : ContactForce{};
    const double at = breaking_moment({dead, forces[0][c]}, scene.strengths[c], scene.friction, {}).t;
    if (at < least.load_factor) {
      least.next = least.load_factor;
      least.load_factor = at;
      least.contact = static_cast<std::int64_t>(c);
    } else {
      least.next = std::min(least.next, at);
    }
  }
  return least;
}

}  // namespace

TEST_CASE("contacts_break_in_the_order_that_factorizing_anew_finds") {
  std::int64_t skipped = 0;  // fronts, by the search
  for (const BreakingScene& scene : breaking_scenes()) {
    UpdatedEquilibrium lazy = scene.updated(true), read = scene.updated(true), eager = scene.updated(false);
    std::vector<std::uint8_t> gone(scene.assembly.contacts.size(), 0);
    std::int64_t held = 0;
    int events = 0;
    double first = 0;  // load factor
    for (; events < 120; ++events) {
      const CriticalContact next = lazy.critical(), behind = read.critical(), same = eager.critical();
      if (events == 0) first = next.moment.t;
      CAPTURE(scene.name, events, next.moment.t, next.contact, same.contact, held);
      if (next.contact < 0 || next.moment.t > 1e4 * first) break;
      REQUIRE(next.contact == same.contact);
      REQUIRE(next.contact == behind.contact);
      CHECK(next.moment.t == Approx(same.moment.t).epsilon(1e-11));
      CHECK(next.moment.t == Approx(behind.moment.t).epsilon(1e-11));
      CHECK(next.moment.in_shear == same.moment.in_shear);
      if (events % 12 == 0) {
        const auto forces = anew(scene, lazy.springs());
        const Least least = first_to_break(scene, forces, gone);
        CAPTURE(least.contact, least.next);
        CHECK(next.moment.t == Approx(least.load_factor).epsilon(1e-9));
        if (least.next > least.load_factor * (1 + 1e-8)) CHECK(next.contact == least.contact);
        for (std::size_t p = 0; p < scene.cases.size(); ++p) {
          CHECK(force_difference(eager.forces(p), forces[p]) < 1e-10);
          if (events % 60 == 0) CHECK(force_difference(lazy.forces(p), forces[p]) < 1e-10);
        }
        CHECK(relative_residual(scene, eager) < 1e-12);
      }
      gone[next.contact] = 1;
      const auto mechanisms = lazy.remove(next.contact), others = eager.remove(next.contact);
      CHECK(mechanisms.size() == others.size());
      read.remove(next.contact);
      static_cast<void>(read.forces(0));  // all blocks are brought up to date
      held += static_cast<std::int64_t>(mechanisms.size());
      if (!is_carried(mechanisms)) break;
    }
    const UpdateCounters& counters = lazy.counters();
    CAPTURE(scene.name, events, held, counters.refinements, counters.mended, counters.largest_residual, counters.fronts,
            eager.counters().fronts);
    CHECK(events > 20);
    CHECK(counters.updates >= events);
    CHECK(counters.largest_residual < 1e-9);
    CHECK(counters.fronts <= eager.counters().fronts);
    skipped += eager.counters().fronts - counters.fronts;
    CHECK(counters.factorizations == 1 + counters.mended);
  }
  CAPTURE(skipped);
  CHECK(skipped > 2000);
}

TEST_CASE("residuals_stay_below_what_is_claimed_of_them_to_the_last_contact") {
  double largest = 0;
  std::int64_t measured = 0, refined = 0;
  for (const BreakingScene& scene : breaking_scenes()) {
    for (const int every : {1, 17}) {  // residuals between are those of parts as old as the search leaves them
      UpdatedEquilibrium state = scene.updated();
      int events = 0;
      for (bool carried = true; carried; ++events) {
        const CriticalContact next = state.critical();
        if (next.contact < 0) break;
        if (events % every == 0) {
          const double told = state.estimated_residual();
          const double found = relative_residual(scene, state), claimed = state.estimated_residual();
          CAPTURE(scene.name, every, events, found, claimed);
          // Where hardly anything is left a new factor does not serve either, and the residual is told as it is.
          if (state.counters().mended == 0) CHECK(told <= UpdatedEquilibriumOptions{}.watched_residual);
          CHECK(found <= claimed);
          largest = std::max(largest, found / claimed);
          ++measured;
        }
        carried = is_carried(state.remove(next.contact));
      }
      CAPTURE(scene.name, events);
      CHECK(events > 40);
      CHECK(state.counters().most_over_claimed < 1);
      refined += state.counters().refinements;
    }
  }
  CAPTURE(largest, measured, refined);
  CHECK(largest > 0.1);  // a claim that is far off costs refinements
  CHECK(measured > 1000);
}

namespace {

/// Refinements that the rounding of solutions needs: that of a change x of the motion is a residual of 20 units of
/// round-off of sqrt(sum (K_kk x_k)²) times a share, of which squares add up (UpdatedState::rounding).
class NeededRefinements {
 public:
  /// \param share of the bound, which is learned from the residuals that are found: 1/8 to 1
  NeededRefinements(std::vector<double> stiffness, double load, double share)
      : stiffness_(std::move(stiffness)), units_(share * 20 * std::numeric_limits<double>::epsilon() / load) {}
  void add(const std::vector<double>& change) {
    double sum = 0;
    for (std::size_t k = 0; k < change.size(); ++k) sum += std::pow(stiffness_[k] * change[k], 2);
    square_ += units_ * units_ * sum;
    if (std::sqrt(square_) <= UpdatedEquilibriumOptions{}.watched_residual) return;
    ++count_;
    square_ = 0;
  }
  [[nodiscard]] std::int64_t count() const { return count_; }

 private:
  std::vector<double> stiffness_;
  double units_, square_ = 0;
  std::int64_t count_ = 0;
};

/// K_kk of components that are free, Pa.
std::vector<double> diagonal_stiffness(const BreakingScene& scene) {
  const auto b = static_cast<std::size_t>(scene.unknowns.per_disc);
  std::vector<double> k(scene.unknowns.held.size(), 0.0);
  for (std::size_t c = 0; c < scene.assembly.contacts.size(); ++c) {
    const auto g = deformation_gradient(frame_of(scene.assembly, c), scene.unknowns.rotation_scale);
    const SpringConstants springs = scene.springs[c];
    const Contact& contact = scene.assembly.contacts[c];
    for (std::size_t r = 0; r < b; ++r) {
      const auto entry = [&](double n, double t) { return springs.kN * n * n + springs.kT * t * t; };
      k[static_cast<std::size_t>(contact.i) * b + r] += entry(g.normal_i[r], g.tangential_i[r]);
      k[static_cast<std::size_t>(contact.j) * b + r] += entry(g.normal_j[r], g.tangential_j[r]);
    }
  }
  for (std::size_t c = 0; c < k.size(); ++c)
    if (scene.unknowns.held[c] != 0) k[c] = 0;
  return k;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

}  // namespace

// Behind a cut through most of a plate a break turns one half about what joins them, by more of the motion u that it
// has had when it was last refined. The change is a multiple of u, which leaves no rounding, and a rest. There are no
// more refinements than the rounding of the rests needs by the whole of its bound, and fewer than that of the whole
// changes would need by the least share of its bound.
TEST_CASE("a_plate_that_is_nearly_cut_through_turns_without_rounding_of_the_turn") {
  const Assembly assembly = hexagonal_lattice({.columns = 60, .rows = 60, .radius = 0.01});
  const BreakingScene scene = pulled("hexagonal", assembly, ContactSprings(SpringConstants{1e9, 4e8}), false, 1);
  Vec2 low = assembly.centres[0], high = low;
  for (const Vec2 x : assembly.centres) {
    low = {std::min(low.x, x.x), std::min(low.y, x.y)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y)};
  }
  const double cut = 0.5 * (low.x + high.x) + 0.001, joined = high.y - 0.1 * (high.y - low.y);
  std::vector<std::pair<double, std::size_t>> crossing;  // height, contact
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Vec2 a = assembly.centres[assembly.contacts[c].i], b = assembly.centres[assembly.contacts[c].j];
    const double height = 0.5 * (a.y + b.y);
    if ((a.x - cut) * (b.x - cut) < 0 && height < joined) crossing.emplace_back(height, c);
  }
  std::ranges::sort(crossing);
  // Motions are read from another one: what is read is brought up to date, and leaves more rounding.
  UpdatedEquilibrium state = scene.updated(), read = scene.updated();
  const std::vector<double> stiffness = diagonal_stiffness(scene), &load = scene.cases[0].force;
  const double size = std::sqrt(dot(load, load));
  NeededRefinements of_rests(stiffness, size, 1), of_changes(stiffness, size, 0.125);
  std::vector<double> before_break = read.motion(0).high, base = before_break;
  std::int64_t refinements = state.counters().refinements;
  const std::size_t soft = crossing.size() * 2 / 3;  // breaks before it are not counted
  std::int64_t before = 0;
  double largest = 0;
  for (std::size_t k = 0; k < crossing.size(); ++k) {
    if (k == soft) before = state.counters().refinements;
    CHECK(state.remove(crossing[k].second).empty());
    CHECK(read.remove(crossing[k].second).empty());
    const std::vector<double> motion = read.motion(0).high;
    std::vector<double> change(motion.size()), rest(motion.size());
    for (std::size_t c = 0; c < motion.size(); ++c) change[c] = motion[c] - before_break[c];
    const double share = dot(load, change) / dot(load, base);
    for (std::size_t c = 0; c < motion.size(); ++c) rest[c] = change[c] - share * base[c];
    if (k >= soft) of_changes.add(change), of_rests.add(rest);
    if (state.counters().refinements > refinements) base = motion;
    refinements = state.counters().refinements;
    before_break = motion;
    if (k % 5 == 0) largest = std::max(largest, relative_residual(scene, state));
  }
  const auto counted = static_cast<std::int64_t>(crossing.size() - soft);
  const std::int64_t refined = state.counters().refinements - before;
  CAPTURE(crossing.size(), counted, refined, of_rests.count(), of_changes.count(), largest);
  CHECK(largest < 1e-12);
  CHECK(refined <= of_rests.count());
  CHECK(refined < of_changes.count());
}

TEST_CASE("breaking_has_the_same_bits_on_every_number_of_threads") {
  for (const BreakingScene& scene : breaking_scenes()) {
    std::vector<std::vector<double>> found;
    for (const int threads : {1, 2, 3}) {
      const ThreadsFor set(threads);
      UpdatedEquilibrium state = scene.updated();
      std::vector<double> numbers;
      for (int event = 0; event < 25; ++event) {
        const CriticalContact next = state.critical();
        numbers.push_back(next.moment.t);
        numbers.push_back(static_cast<double>(next.contact));
        static_cast<void>(state.remove(next.contact));
      }
      for (const ContactForce& f : state.forces(0)) numbers.push_back(f.normal), numbers.push_back(f.tangential);
      found.push_back(std::move(numbers));
    }
    CAPTURE(scene.name);
    CHECK(std::memcmp(found[0].data(), found[1].data(), found[0].size() * sizeof(double)) == 0);
    CHECK(std::memcmp(found[0].data(), found[2].data(), found[0].size() * sizeof(double)) == 0);
  }
}

TEST_CASE("contacts_that_go_and_come_back_leave_no_trace") {
  for (const BreakingScene& scene : breaking_scenes()) {
    UpdatedEquilibrium state = scene.updated();
    std::vector<std::vector<ContactForce>> first;
    for (std::size_t p = 0; p < scene.cases.size(); ++p) first.push_back(state.forces(p));
    Random random(11);
    std::vector<std::size_t> gone;
    ContactSprings weaker = scene.springs;
    for (int step = 0; step < 60; ++step) {
      const std::size_t contact = random.below(scene.assembly.contacts.size());
      if (std::find(gone.begin(), gone.end(), contact) != gone.end()) continue;
      SpringConstants k = scene.springs[contact];
      const double share = step % 3 == 0 ? random.uniform() : 0;
      k = {share * k.kN, share * k.kT};
      weaker.set(contact, k, scene.assembly.contacts.size());
      CHECK(state.change(contact, k).empty());
      gone.push_back(contact);
    }
    const auto forces = anew(scene, weaker);
    CAPTURE(scene.name, state.counters().refinements, state.counters().mended);
    for (std::size_t p = 0; p < scene.cases.size(); ++p) CHECK(force_difference(state.forces(p), forces[p]) < 1e-10);
    for (const std::size_t contact : gone) CHECK(state.change(contact, scene.springs[contact]).empty());
    for (std::size_t p = 0; p < scene.cases.size(); ++p) CHECK(force_difference(state.forces(p), first[p]) < 1e-10);
    CHECK(relative_residual(scene, state) < 1e-12);
  }
}

TEST_CASE("what_comes_loose_is_held_and_named_and_a_load_on_it_is_not_carried") {
  // A strip held at both ends is cut through twice: the piece between floats.
  const Assembly strip = hexagonal_lattice({.columns = 24, .rows = 6, .radius = 0.01});
  const ContactSprings springs(SpringConstants{1e9, 5e8});
  const std::vector<Support> supports = {{"left", 0.0, 0.0, std::nullopt}, {"right", 0.0, 0.0, std::nullopt}};
  BreakingScene scene{"strip", strip, springs, unknowns_of(strip, springs, supports), {}, {}, 0};
  scene.strengths.resize(strip.contacts.size());
  const bool loaded = GENERATE(false, true);
  const std::array<double, 2> cuts = {strip.centres[8].x + 0.003, strip.centres[16].x + 0.003};
  const auto piece_of = [&](std::size_t disc) {
    return (strip.centres[disc].x > cuts[0] ? 1 : 0) + (strip.centres[disc].x > cuts[1] ? 1 : 0);
  };
  RightHandSide load;
  load.force.resize(3 * strip.size());
  for (std::size_t d = 0; d < strip.size(); ++d) {
    if (piece_of(d) == (loaded ? 1 : 0)) load.force[3 * d + 1] = 1;
  }
  scene.cases.push_back(load);
  UpdatedEquilibrium state = scene.updated();
  std::vector<HeldMechanism> held;
  for (std::size_t c = 0; c < strip.contacts.size(); ++c) {
    if (piece_of(strip.contacts[c].i) == piece_of(strip.contacts[c].j)) continue;
    for (HeldMechanism& m : state.remove(c)) held.push_back(std::move(m));
  }
  CAPTURE(loaded, held.size());
  bool reacts = false;
  for (const HeldMechanism& m : held) {
    CAPTURE(m.component, m.stiffness, m.reaction[0]);
    CHECK(piece_of(static_cast<std::size_t>(m.component) / 3) == 1);
    CHECK(m.stiffness > 0);
    reacts |= std::abs(m.reaction[0]) > 1e-6;
  }
  CHECK(held.size() == 3);
  CHECK(reacts == loaded);
  bool told = false;
  for (const HeldMechanism& m : held) {
    const std::vector<DiscMotion> motion = state.driven_mechanism(m.component);
    for (std::size_t d = 0; d < motion.size(); ++d) {
      if (piece_of(d) != 1) CHECK((norm(motion[d].u) < 1e-9 && std::abs(motion[d].theta) < 1e-9));
    }
    told |= !motion.empty();
  }
  CHECK(told == loaded);
  if (!loaded) CHECK(force_difference(state.forces(0), anew(scene, state.springs())[0]) < 1e-11);
}

TEST_CASE("a_factor_that_is_updated_needs_little_memory_beside_itself") {
  const Assembly assembly = hexagonal_lattice({.columns = 60, .rows = 60, .radius = 0.01});
  const BreakingScene scene = pulled("hexagonal", assembly, ContactSprings(SpringConstants{1e9, 4e8}), false, 1);
  UpdatedEquilibrium state = scene.updated();
  for (int event = 0; event < 10; ++event) static_cast<void>(state.remove(state.critical().contact));
  CAPTURE(state.bytes(), state.factor_bytes());
  CHECK(state.bytes() < 1.3 * state.factor_bytes());
}

TEST_CASE("updates_refuse_networks_that_are_not_positive_definite") {
  const Assembly assembly = hexagonal_lattice({.columns = 6, .rows = 6, .radius = 0.01});
  const BreakingScene scene = pulled("hexagonal", assembly, ContactSprings(SpringConstants{1e9, 4e8}), false, 1);
  BreakingScene negative = scene, loose = scene, stiffer = scene;
  negative.springs = ContactSprings(SpringConstants{1e9, -1e7});
  CHECK(refusal_of([&] { static_cast<void>(negative.updated()); }).says("negative tangential spring"));
  loose.unknowns = all_free(assembly, 3);
  CHECK(refusal_of([&] { static_cast<void>(loose.updated()); }).says("mechanism"));
  const auto in_little_memory = [&] {
    const UpdatedEquilibrium none(scene.assembly, scene.springs, scene.unknowns, scene.cases, scene.strengths,
                                  {.memory_limit = 1000});
  };
  CHECK(refusal_of(in_little_memory).says("needs about"));
  UpdatedEquilibrium state = scene.updated();
  CHECK(refusal_of([&] { static_cast<void>(state.change(0, {2e9, 4e8})); }).says("Weaken springs"));
}
