// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"

#include "breakage/dense_network.hpp"
#include "breakage/scenes.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

struct Drawn {
  std::string name;
  Assembly assembly;
  ContactSprings springs{SpringConstants{1, 0.3}};
  ContactStrengths strengths;
  LoadPathOptions path;
  Rotation rotation = Rotation::from_scene;
};

/// Assemblies of about `discs` discs with springs, levers and strengths at random, in every combination of what drives
/// them, tangential springs, friction and rotation.
Drawn draw(std::uint64_t seed, std::int64_t discs) {
  Random random(seed);
  Drawn d;
  const bool periodic = seed % 2 == 0;
  d.assembly = delaunay_assembly({.discs = periodic ? discs : discs + 2,
                                  .points = PointProcess::perturbed_hexagonal,
                                  .disorder = 0.25,
                                  .seed = seed,
                                  .radii = {.smallest = 0.5, .largest = 0.5},
                                  .periodic = periodic});
  const double tangential[] = {0.3, 0, 1, 0.05, 0.5};
  const double kT = tangential[seed / 2 % 5];
  std::vector<SpringConstants> springs;
  for (Contact& contact : d.assembly.contacts) {
    springs.push_back({random.uniform(0.5, 2), kT * random.uniform(0.5, 2)});
    d.strengths.tension.push_back(random.uniform(0.2, 1.5));
    d.strengths.shear.push_back(random.uniform(0.2, 1.5));
    if (seed % 3 == 0) contact.lever_i *= random.uniform(0.7, 1.3), contact.lever_j *= random.uniform(0.7, 1.3);
  }
  d.springs = ContactSprings(std::move(springs));
  const double friction[] = {0, 0.5, 10};
  d.strengths.friction = friction[seed / 3 % 3];
  if (seed % 7 == 0) d.rotation = Rotation::restrained;
  d.name = fmt::format("seed {}, kT {}, friction {}", seed, kT, d.strengths.friction);
  const auto part = [&] { return random.uniform(-1, 1); };
  if (periodic) {
    d.path.strain = Voigt{part(), part(), part()};
    d.name += ", strain";
    return d;
  }
  d.path.supports = {{"bottom", 0, 0, {}}};
  if (seed % 4 == 1) {
    d.path.supports.push_back({"top", part(), part(), {}});
    d.name += ", motion";
  } else {
    d.path.loads = {{"top", LoadKind::per_disc, {part(), part()}, 0}};
    d.name += ", loads";
  }
  if (seed % 8 >= 5) {
    d.assembly.groups["middle"] = {{static_cast<std::int32_t>(d.assembly.size() / 2)}, {}};
    if (seed % 4 != 1) d.path.dead_loads = {{"top", LoadKind::per_disc, {0.2 * part(), 0.2 * part()}, 0}};
    d.path.dead_loads.push_back({"middle", LoadKind::per_disc, {0.2 * part(), 0.2 * part()}, 0});
    d.name += ", dead loads";
  }
  return d;
}

/// Where a network alone is refused, updates refuse it for the same reason, or still follow it with forces in balance.
void check_refused_or_balanced(Broken& broken, const Error& alone) {
  try {
    broken.run().advance();
    CHECK(broken.events().back().relative_residual < 1e-12);
  } catch (const Error& error) {
    CHECK(error.problem() == alone.problem());
  }
}

}  // namespace

TEST_CASE("random_assemblies_break_as_dense_matrices_say") {
  const Factor factor = GENERATE(Factor::updated, Factor::anew);
  std::int64_t events = 0, by_shear = 0, snap_backs = 0, loosened = 0, released = 0, at_zero = 0, too_soft = 0;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    const Drawn d = draw(seed, 8);
    CAPTURE(d.name, factor == Factor::updated);
    Broken broken(d.assembly, d.springs, d.strengths, d.path, d.rotation, factor);
    const DegreesOfFreedom unknowns =
        number_unknowns(broken.assembly(), broken.springs(), broken.effects(), d.path.supports);
    DenseNetwork dense(broken.assembly(), broken.springs(), broken.strengths(), broken.path(), unknowns);
    double work = 0, largest = 0;
    bool soft = false;
    while (true) {
      CAPTURE(broken.events().size());
      const DenseNetwork::Event expected = dense.carried() ? dense.next() : DenseNetwork::Event{};
      soft = dense.softest() < 1e-6;
      if (soft) {  // its eigenvectors leave no digits for the forces that are left
        ++too_soft;
        break;
      }
      const bool more = broken.run().advance();
      CAPTURE(broken.run().why(), expected.lambda);
      REQUIRE(more == (expected.contact >= 0));
      if (!more) break;
      const BreakEvent& event = broken.events().back();
      CAPTURE(event.lambda, expected.lambda, event.gap, expected.gap, dense.null_motions());
      REQUIRE(event.contact == expected.contact);
      REQUIRE((event.mode == BreakMode::shear) == expected.shear);
      REQUIRE(std::abs(event.lambda - expected.lambda) <= 1e-9 * expected.lambda);
      REQUIRE(event.relative_residual < 1e-12);
      const double lambda = expected.lambda, before = dense.energy(lambda);
      // A dense matrix leaves fewer digits of the forces at large load factors.
      REQUIRE(event.energy_before == Approx(before).epsilon(lambda > 1e4 ? 1e-8 : 1e-9));
      REQUIRE(event.unstable_modes == dense.negative());
      const auto c = static_cast<std::size_t>(event.contact);
      const double n = dense.dead().normal[c] + lambda * dense.pattern().normal[c];
      const double t = dense.dead().tangential[c] + lambda * dense.pattern().tangential[c];
      const int null_motions = dense.null_motions();
      dense.remove(c);
      if (dense.carried())
        REQUIRE(event.energy_after == Approx(dense.energy(lambda)).epsilon(lambda > 1e4 ? 1e-8 : 1e-9).margin(1e-12));
      // Where nothing comes loose the contact lets go along its opening d: the crack takes f.d/2 of its force f.
      if (dense.carried() && dense.null_motions() == null_motions) {
        const ContactDeformation d_after = dense.opening(c, lambda);
        REQUIRE(event.energy_released ==
                Approx(0.5 * (n * d_after.normal + t * d_after.tangential)).epsilon(1e-6).margin(1e-11 * before));
        ++released;
      }
      work += event.energy_released;
      largest = std::max(largest, event.lambda);
      ++events;
      by_shear += event.mode == BreakMode::shear ? 1 : 0;
      at_zero += event.lambda == 0 ? 1 : 0;
      loosened += event.loosened.empty() ? 0 : 1;
      if (broken.events().size() > 1) snap_backs += event.lambda < broken.event(broken.events().size() - 2).lambda;
    }
    CHECK(broken.run().ledger().released == Approx(work).epsilon(1e-12));
    // Where what is left carries a share of 1e-5 of the first forces, the round-off of imposed motions is seen.
    if (!soft && largest < 1e4) CHECK(broken.run().energy_error() < 1e-10);
  }
  CAPTURE(events, by_shear, snap_backs, loosened, released, at_zero, too_soft);
  CHECK(events > 800);
  CHECK(by_shear > 100);
  CHECK(events - by_shear > 100);
  CHECK(snap_backs > 100);
  CHECK(loosened > 30);
  CHECK(released > 500);
  CHECK(too_soft < 10);
}

TEST_CASE("paths_with_an_updated_factor_have_the_events_of_factorizing_anew") {
  std::int64_t events = 0, refused = 0, by_control = 0, loosened = 0;
  double worst_lambda = 0, worst_work = 0, worst_stress = 0, worst_load = 0, worst_residual = 0;
  int alone = 0;  // paths whose last networks were solved one by one
  std::string worst;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Drawn d = draw(seed, seed % 10 < 3 ? 400 : 40);
    const LoadControl controls[] = {LoadControl::path, LoadControl::load, LoadControl::motion};
    d.path.control = controls[seed % 3];
    if (seed % 5 == 0) d.path.legs = {1.5, -1, 50};
    CAPTURE(d.name, to_string(d.path.control));
    Broken fast(d.assembly, d.springs, d.strengths, d.path, d.rotation, Factor::updated);
    Broken slow(d.assembly, d.springs, d.strengths, d.path, d.rotation, Factor::anew);
    double largest_stress = 0, largest_work = 0, largest_load = 0;
    while (slow.events().size() < 400) {
      CAPTURE(slow.events().size());
      bool more = false;
      try {
        more = slow.run().advance();
      } catch (const Error& error) {  // a motion that resists no more than round-off, and is no mechanism of discs
        ++refused;
        check_refused_or_balanced(fast, error);
        break;
      }
      CAPTURE(slow.run().why());
      REQUIRE(fast.run().advance() == more);
      if (!more) break;
      const BreakEvent &a = fast.events().back(), &b = slow.events().back();
      CAPTURE(a.lambda, b.lambda, a.gap, b.gap, a.contact, b.contact);
      if (a.contact != b.contact && std::min(a.gap, b.gap) < 1e-8) break;  // no order to the digits that there are
      REQUIRE(a.contact == b.contact);
      REQUIRE(a.mode == b.mode);
      REQUIRE(a.leg == b.leg);
      REQUIRE(a.ties == b.ties);
      REQUIRE(a.loosened == b.loosened);
      if (b.gap < 1e6) CHECK(a.gap == Approx(b.gap).epsilon(1e-6).margin(1e-8));
      largest_stress = std::max({largest_stress, std::abs(b.stress.xx), std::abs(b.stress.yy), std::abs(b.stress.xy)});
      largest_work = std::max({largest_work, std::abs(b.work), b.energy_before});
      largest_load = std::max(largest_load, std::abs(b.load));
      ++events;
      by_control += d.path.control != LoadControl::path ? 1 : 0;
      loosened += a.loosened.empty() ? 0 : 1;
      worst_residual = std::max(worst_residual, a.relative_residual);
      if (std::abs(b.lambda) > 1e3) continue;  // what is left is as soft, and its digits as few
      const double off = std::abs(a.lambda - b.lambda) / std::abs(b.lambda != 0 ? b.lambda : 1);
      if (off > worst_lambda) worst = fmt::format("{}, event {}", d.name, slow.events().size());
      worst_lambda = std::max(worst_lambda, off);
      for (const auto quantity :
           {&BreakEvent::energy_before, &BreakEvent::energy_after, &BreakEvent::energy_released, &BreakEvent::work}) {
        worst_work = std::max(worst_work, std::abs(a.*quantity - b.*quantity) / largest_work);
      }
      for (const auto component : {&Tensor2::xx, &Tensor2::xy, &Tensor2::yx, &Tensor2::yy})
        worst_stress = std::max(worst_stress, std::abs(a.stress.*component - b.stress.*component) / largest_stress);
      worst_load = std::max(worst_load, std::abs(a.load - b.load) / largest_load);
      CHECK(a.motion == Approx(b.motion).epsilon(1e-8).margin(1e-10));
    }
    alone += fast.system().report().name.find("did not serve") != std::string::npos ? 1 : 0;
    if (slow.run().end() != PathEnd::none) CHECK(fast.run().end() == slow.run().end());
  }
  CAPTURE(events, refused, by_control, loosened, worst, worst_lambda, worst_work, worst_stress, worst_load,
          worst_residual, alone);
  CHECK(alone > 0);
  CHECK(events > 3000);
  CHECK(refused < 10);
  CHECK(by_control > 1000);
  CHECK(loosened > 100);
  CHECK(worst_lambda < 1e-9);
  CHECK(worst_work < 1e-9);
  CHECK(worst_stress < 1e-9);
  CHECK(worst_load < 1e-9);
  CHECK(worst_residual < 1e-12);
}

TEST_CASE("paths_have_the_same_bits_on_every_number_of_threads") {
  for (const std::uint64_t seed : {3, 4, 5, 8, 13}) {
    const Drawn d = draw(seed, 300);
    CAPTURE(d.name);
    std::vector<std::vector<double>> found;
    for (const int threads : {1, 2, 3}) {
      const ThreadsFor set(threads);
      Broken broken(d.assembly, d.springs, d.strengths, d.path, d.rotation);
      std::vector<double> numbers;
      while (broken.events().size() < 60 && broken.run().advance()) {
        const BreakEvent& e = broken.events().back();
        numbers.insert(numbers.end(), {e.lambda, e.gap, e.load, e.motion, e.stress.xx, e.stress.xy, e.energy_before,
                                       e.energy_after, e.work, e.relative_residual, static_cast<double>(e.contact)});
      }
      found.push_back(std::move(numbers));
    }
    CHECK(found[0].size() > 200);
    REQUIRE(found[1].size() == found[0].size());
    REQUIRE(found[2].size() == found[0].size());
    CHECK(std::memcmp(found[0].data(), found[1].data(), found[0].size() * sizeof(double)) == 0);
    CHECK(std::memcmp(found[0].data(), found[2].data(), found[0].size() * sizeof(double)) == 0);
  }
}

TEST_CASE("networks_of_springs_far_apart_are_solved_alone_or_as_well_as_alone") {
  std::int64_t events = 0, soft = 0;
  for (const std::uint64_t seed : {5, 6, 7, 11, 15, 19, 23}) {
    Drawn d = draw(seed, 150);
    Random random(seed);
    const double decades = seed == 7 ? 9 : 5.6;
    std::vector<SpringConstants> springs;
    for (std::size_t c = 0; c < d.assembly.contacts.size(); ++c) {
      const double k = std::pow(10, random.uniform(-decades, 0));
      springs.push_back({k, 0.5 * k});
    }
    d.springs = ContactSprings(std::move(springs));
    CAPTURE(d.name, decades);
    Broken fast(d.assembly, d.springs, d.strengths, d.path, d.rotation, Factor::updated);
    Broken slow(d.assembly, d.springs, d.strengths, d.path, d.rotation, Factor::anew);
    CHECK((fast.system().report().name == slow.system().report().name) == (decades > 6));
    while (true) {
      CAPTURE(fast.events().size());
      bool more = false;
      try {
        more = slow.run().advance();
      } catch (const Error& error) {
        check_refused_or_balanced(fast, error);
        break;
      }
      const bool as_well = fast.run().advance();
      CAPTURE(slow.run().why(), fast.run().why());
      if (more && slow.events().back().relative_residual > 1e-12) {  // factorized alone it has no digits to compare
        ++soft;
        break;
      }
      REQUIRE(as_well == more);
      if (!more) break;
      const BreakEvent &a = fast.events().back(), &b = slow.events().back();
      CAPTURE(a.lambda, b.lambda, a.gap, b.gap, a.relative_residual, b.relative_residual);
      REQUIRE(a.contact == b.contact);
      CHECK(a.lambda == Approx(b.lambda).epsilon(1e-6));
      ++events;
    }
  }
  CAPTURE(events, soft);
  CHECK(events > 300);
  CHECK(soft < 4);
}
