// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The response of a contact in a step beside plain formulas, and of several at once beside each alone.
#include <algorithm>
#include <cmath>

#include "equidem/core/random.hpp"
#include "equidem/grains/kernels/respond.hpp"

#include "contact/numbers.hpp"
#include "support/catch.hpp"

// unscoped names of columns, kept from the other files of a unity build
namespace response_of_contacts {

using namespace equidem;
using namespace equidem::test;

using eight::ResponseKind;
using simd::One;

/// Numbers of a contact in the order in which the response takes them.
enum Number {
  stiffness,
  least,
  friction,
  spring,
  dashpot,
  slip_dashpot,  // laws
  overlap,
  closing,
  middle_closing,
  half_mobility,
  mean_closing,
  overlap_before,  // motion
  slip,
  mobility,
  mean_slip,
  impulse,
  tangential,
  stretch,  // memory
  slip_loss,
  dashpot_loss,
  released,
  normal_loss,
  numbers
};
constexpr double dt = 0.01;

/// Eight contacts; some begin, some end, some are apart.
struct Contacts {
  double of[numbers][8] = {};
  std::int64_t touch[8] = {}, alive[8] = {};
};

Contacts random_contacts(Random& random, bool verlet) {
  Contacts c;
  for (std::size_t k = 0; k < 8; ++k) {
    c.touch[k] = random.below(4) > 0 ? -1 : 0;
    c.alive[k] = random.below(4) > 0 ? -1 : 0;
    for (const Number n : {closing, middle_closing, mean_closing, slip, mean_slip})
      c.of[n][k] = random.uniform(-1, 1) * magnitude(1, random);
    for (const Number n : {stiffness, spring, dashpot, slip_dashpot, half_mobility, mobility})
      c.of[n][k] = magnitude(2, random);
    c.of[friction][k] = random.uniform(0, 1);
    c.of[least][k] = random.below(2) > 0 ? 0 : -std::numeric_limits<double>::infinity();
    c.of[overlap][k] = (c.touch[k] != 0 ? 1 : -1) * magnitude(1, random);
    c.of[overlap_before][k] = std::max(0.0, c.of[overlap][k] - dt * c.of[mean_closing][k]);
    if (c.alive[k] == 0) continue;
    c.of[impulse][k] = random.uniform(-0.2, 1);
    c.of[tangential][k] = random.uniform(-1, 1);
    c.of[stretch][k] = random.uniform(-1, 1);
  }
  if (!verlet)
    for (std::size_t k = 0; k < 8; ++k) c.of[mean_closing][k] = c.of[mean_slip][k] = 0;
  return c;
}

/// respond() for the contacts from k on.
template <class Law, ResponseKind kind, class Lanes>
void respond_from(Contacts& c, std::size_t k) {
  using namespace eight;
  const auto at = [&](Number n) { return load<Lanes>(c.of[n] + k); };
  ContactChanges<Lanes> changes;
  changes.touch = load<eight::Bits<Lanes>>(c.touch + k);
  changes.alive = load<eight::Bits<Lanes>>(c.alive + k);
  changes.begun = changes.touch & ~changes.alive;
  changes.ended = changes.alive & ~changes.touch;
  changes.any = eight::any(changes.begun | changes.ended);
  changes.first = false;
  const LawLanes<Lanes> law{dt * at(stiffness), at(least), sliding_law(at(friction), at(spring), dt)};
  const eight::ContactMotion<Lanes> motion{at(overlap),       at(closing),      at(middle_closing),
                                           at(half_mobility), at(mean_closing), at(overlap_before),
                                           at(slip),          at(mobility),     at(mean_slip)};
  ContactMemory<Lanes> memory{at(impulse), at(tangential), at(stretch), {}};
  EffectLanes<Lanes> none;
  ContactLosses<Lanes> losses{};
  respond<Law, kind>(law, dt * at(dashpot), dt * at(slip_dashpot), motion, changes, dt, none, memory, losses);
  const auto set = [&](Number n, const Lanes& lanes) { store(lanes, c.of[n] + k); };
  set(impulse, memory.impulse), set(tangential, memory.tangential), set(stretch, memory.stretch);
  set(slip_loss, losses.slip), set(dashpot_loss, losses.dashpot);
  set(released, losses.released), set(normal_loss, losses.normal);
}

/// Semi-implicit Euler with friction, contact k.
template <class Law>
void respond_plainly(Contacts& c, std::size_t k) {
  const auto at = [&](Number n) -> double& { return c.of[n][k]; };
  const bool touches = c.touch[k] != 0, ends = c.alive[k] != 0 && !touches;
  const double x = at(stretch), before = at(impulse);
  at(slip_loss) = at(dashpot_loss) = at(normal_loss) = 0;
  at(released) = ends ? 0.5 * at(spring) * x * x : 0;
  const double velocity = at(slip) - at(mobility) * at(tangential);
  at(impulse) = at(tangential) = at(stretch) = 0;
  if (!touches) return;
  const double elastic = dt * Law::spring(at(stiffness), at(overlap));
  const double viscous = dt * Law::dashpot(at(dashpot), at(overlap)) * at(closing);
  at(impulse) = std::max(at(least), elastic + viscous);
  at(normal_loss) = (at(impulse) - elastic) * (at(middle_closing) + at(half_mobility) * (before - at(impulse)));
  const double rate = 0.5 * dt * dt * at(spring) + dt * at(slip_dashpot);
  const double sticking = (dt * at(spring) * x + rate * velocity) / (1 + at(mobility) * rate);
  const double most = at(friction) * std::max(at(impulse), 0.0);
  const double against = std::clamp(sticking, -most, most), mean = velocity - at(mobility) * against;
  const bool slides = std::abs(sticking) > most;
  at(tangential) = -against;
  const double limit = most / (dt * at(spring));
  at(stretch) = slides ? std::clamp(x + dt * mean, -limit, limit) : x + dt * mean;
  if (slides) {
    at(slip_loss) = against * mean + 0.5 * at(spring) * (x * x - at(stretch) * at(stretch));
  } else {
    at(dashpot_loss) = dt * at(slip_dashpot) * mean * mean;
  }
}

template <class Law, bool verlet>
void compare(bool with_friction) {
  Random random(verlet ? 5 : 4);
  int slid = 0, stuck = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const Contacts given = random_contacts(random, verlet);
    Contacts together = given, alone = given, plain = given;
    const auto respond_by = [&]<class Lanes>(Contacts& c, std::size_t k) {
      with_friction ? respond_from<Law, ResponseKind{.friction = true, .verlet = verlet}, Lanes>(c, k)
                    : respond_from<Law, ResponseKind{.verlet = verlet}, Lanes>(c, k);
    };
    respond_by.template operator()<simd::Twice<simd::Twice<simd::Two>>>(together, 0);
    for (std::size_t k = 0; k < 8; ++k) {
      respond_by.template operator()<One>(alone, k);
      respond_plainly<Law>(plain, k);
      for (int n = impulse; n < numbers; ++n) {
        CAPTURE(Law::facts.name, verlet, with_friction, trial, k, n, given.touch[k], given.alive[k]);
        // what springs of ended contacts held is set only where some begin or end
        if (n != released || given.touch[k] != given.alive[k]) REQUIRE(alone.of[n][k] == together.of[n][k]);
        if (verlet || (!with_friction && n != impulse && n != normal_loss)) continue;
        const double size = std::abs(plain.of[n][k]) + 1e3;
        REQUIRE(std::abs(alone.of[n][k] - plain.of[n][k]) <= 64 * epsilon * size);
      }
      (plain.of[slip_loss][k] != 0 ? slid : stuck) += 1;
    }
  }
  CAPTURE(slid, stuck);
  CHECK(slid > 1000);
  CHECK(stuck > 1000);
}

}  // namespace response_of_contacts

TEST_CASE("a_contact_responds_by_the_plain_formulas_and_several_as_each_alone") {
  using namespace response_of_contacts;
  const bool with_friction = GENERATE(false, true);
  compare<laws::LinearDashpot, false>(with_friction);
  compare<laws::LinearDashpot, true>(with_friction);
  compare<laws::HertzDashpot, false>(with_friction);
  compare<laws::HertzDashpot, true>(with_friction);
}
