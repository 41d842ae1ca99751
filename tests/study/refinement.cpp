// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The accuracy asked of a refinement is kept, at little more than the least cost, on problems with a closed form.
#include "equidem/study/refinement.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/homogenize/tension_test.hpp"
#include "equidem/material/spring_relations.hpp"
#include "equidem/waves/bloch.hpp"

#include "support/catch.hpp"
#include "support/requests.hpp"

using namespace equidem;

namespace {

using Values = std::vector<double>;

constexpr double radius = 0.005, kN = 1e9;
constexpr double near = std::numbers::sqrt2;  // levels apart, as `equidem run` takes them

/// (35) and the logarithm of (36) on a block of rows x rows.
Values tension_of(std::int64_t rows, double ratio, GaugePlacement gauge) {
  const auto n = static_cast<int>(rows);
  const Assembly block = hexagonal_lattice({.columns = n, .rows = n, .radius = radius});
  const ContactSprings springs(SpringConstants{kN, ratio * kN});
  const TensionTest test{.gauge = gauge};
  const TensionSetup setup = tension_setup(block, test);
  const Equilibrium rest = solve_equilibrium(block, springs, setup.supports, setup.loads);
  const TensionResult result = evaluate_tension(block, springs, test, setup, rest);
  return {result.poisson_ratio, std::log(result.stiffness_ratio)};
}

std::int64_t one_beyond_a_multiple_of_four(std::int64_t n) {
  return n + (5 - n % 4) % 4;
}

double largest(const Values& a, const Values& b) {
  double far = 0;
  for (std::size_t k = 0; k < a.size(); ++k) far = std::max(far, std::abs(a[k] - b[k]));
  return far;
}

double relative(const Values& a, const Values& b) {
  const double apart = largest(a, b);
  return apart > 0 ? apart / largest(b, Values(b.size())) : 0;
}

/// Waves of a bonded lattice, of which there is a closed form: each moves as exp(-alpha t/2) sin(w t), w² = omega² -
/// alpha²/4.
class Waves {
 public:
  struct Wave {
    double omega = 0;
    std::vector<DiscMotion> shape;
  };
  struct Sum {
    std::vector<std::pair<const Wave*, double>> waves;  ///< with their amplitudes
    double alpha = 0, time = 0;
  };

  explicit Waves(double ratio)
      : lattice_(hexagonal_lattice({.columns = columns, .rows = rows, .radius = 0.5, .periodic = true})),
        springs_(SpringConstants{1, ratio}),
        inertia_(inertia_of(lattice_.radii, 1, Body::disc)) {
    const BlochWaves bloch(primitive_cell(lattice_, springs_), inertia_, true);
    for (int i = 0; i < columns; ++i) {
      for (int j = 0; j < rows; ++j) {
        const Vec2 q{2 * std::numbers::pi * i / lattice_.period->x, 2 * std::numbers::pi * j / lattice_.period->y};
        const HermitianSpectrum modes = spectrum(bloch.dynamic_matrix(q));
        for (std::size_t branch = 0; branch < modes.values.size(); ++branch) add(modes, branch, q);
      }
    }
    for (std::size_t d = 0; d < lattice_.size(); ++d)
      lattice_.groups[std::to_string(d)] = {{static_cast<std::int32_t>(d)}, {}};
  }

  [[nodiscard]] double fastest() const {
    double omega = 0;
    for (const Wave& wave : waves_) omega = std::max(omega, wave.omega);
    return omega;
  }

  /// One to eight waves over half to eight periods of the slowest, damped or not.
  [[nodiscard]] Sum random_sum(Random& random) const {
    Sum sum{.waves = {}, .alpha = random.below(2) == 0 ? 0 : 0.02 * random.uniform() * fastest()};
    double slowest = fastest();
    for (std::size_t left = 1 + random.below(8); left > 0;) {
      const Wave& wave = waves_[random.below(waves_.size())];
      if (wave.omega < sum.alpha) continue;
      sum.waves.emplace_back(&wave, random.uniform(-1, 1) / wave.omega);
      slowest = std::min(slowest, wave.omega);
      --left;
    }
    sum.time = random.uniform(0.5, 8) * 2 * std::numbers::pi / slowest;
    return sum;
  }

  /// Displacements at its time.
  [[nodiscard]] Values exact(const Sum& sum) const {
    return displacements(
        motions(sum, [&](double w) { return std::exp(-0.5 * sum.alpha * sum.time) * std::sin(w * sum.time); }));
  }
  [[nodiscard]] Values run(const Sum& sum, Integrator integrator, std::int64_t steps) const {
    Scene scene(lattice_, springs_, inertia_);
    const std::vector<DiscMotion> begin = motions(sum, [](double w) { return w; });
    for (std::size_t d = 0; d < begin.size(); ++d)
      scene.velocities.push_back({std::to_string(d), begin[d].u, begin[d].theta});
    SimulationOptions options{.integrator = integrator, .time_step = sum.time / static_cast<double>(steps)};
    options.damping.mass = sum.alpha;
    Simulation simulation(scene, options);
    simulation.advance(steps);
    return displacements(simulation.motions());
  }

 private:
  static constexpr int columns = 6, rows = 4;

  void add(const HermitianSpectrum& modes, std::size_t branch, Vec2 q) {
    if (modes.values[branch] < 1e-6) return;  // the lattice as a whole
    Wave wave{.omega = std::sqrt(modes.values[branch]), .shape = {}};
    for (std::size_t d = 0; d < lattice_.size(); ++d) {
      const Complex phase = std::polar(1.0, dot(q, lattice_.centres[d]) + 1);
      const auto part = [&](std::size_t r, double mass) {
        return std::real(modes.vectors(r, branch) * phase) / std::sqrt(mass);
      };
      wave.shape.push_back({{part(0, inertia_[d].mass), part(1, inertia_[d].mass)}, part(2, inertia_[d].moment)});
    }
    const bool moves =
        std::any_of(wave.shape.begin(), wave.shape.end(), [](const DiscMotion& m) { return norm(m.u) > 1e-6; });
    if (moves) waves_.push_back(std::move(wave));  // others turn the discs alone
  }

  template <class Factor>
  [[nodiscard]] std::vector<DiscMotion> motions(const Sum& sum, Factor factor) const {
    std::vector<DiscMotion> all(lattice_.size());
    for (const auto& [wave, amplitude] : sum.waves) {
      const double now = amplitude * factor(std::sqrt(wave->omega * wave->omega - 0.25 * sum.alpha * sum.alpha));
      for (std::size_t d = 0; d < all.size(); ++d) {
        all[d].u += now * wave->shape[d].u;
        all[d].theta += now * wave->shape[d].theta;
      }
    }
    return all;
  }

  static Values displacements(const std::vector<DiscMotion>& motions) {
    Values values;
    for (const DiscMotion& motion : motions) values.push_back(motion.u.x), values.push_back(motion.u.y);
    return values;
  }

  Assembly lattice_;
  ContactSprings springs_;
  std::vector<Inertia> inertia_;
  std::vector<Wave> waves_;
};

/// Outcome of a request.
struct Got {
  std::int64_t level = 0;
  Values values;
  double pilots = 0;  ///< levels of all that was computed beside it, over its own
};

Got refine(const std::function<Values(std::int64_t)>& evaluate, const RefinementOptions& options) {
  Refinement search(evaluate, options);
  Got got;
  double tried = 0;
  do {
    tried += static_cast<double>(got.level);
    got.level = search.propose();
    got.values = evaluate(got.level);
  } while (!search.accepts(got.level, got.values));
  for (const std::int64_t pilot : search.pilots()) tried += static_cast<double>(pilot);
  got.pilots = tried / static_cast<double>(got.level);
  return got;
}

/// Requests that were kept, and that cost at most twice the least.
struct Score {
  int requests = 0, kept = 0, cheap = 0;

  void check(const std::string& task) const {
    CAPTURE(kept, cheap, requests);
    CHECK(kept >= 0.95 * requests);
    CHECK(cheap >= 0.95 * requests);
    write_down({.task = task, .requests = requests, .kept = kept, .cheap = cheap});
  }
};

}  // namespace

TEST_CASE("accuracy_asked_of_abes_test_is_kept_at_most_twice_the_least_cost") {
  std::map<std::tuple<std::int64_t, double, int>, Values> known;
  Random random(31);
  Score score{.requests = 200};
  double dearest = 0;
  for (int k = 0; k < score.requests; ++k) {
    const double ratio = 0.3 * static_cast<double>(1 + random.below(3));
    const GaugePlacement gauge = std::vector{GaugePlacement::centre, GaugePlacement::quarter,
                                             GaugePlacement::ends}[static_cast<std::size_t>(random.below(3))];
    const double accuracy = 4e-3 * std::pow(8.0, random.uniform());
    const auto evaluate = [&](std::int64_t rows) {
      const std::tuple key(rows, ratio, static_cast<int>(gauge));
      if (!known.contains(key)) known[key] = tension_of(rows, ratio, gauge);
      return known[key];
    };
    const Got got = refine(
        evaluate,
        {.accuracy = accuracy, .order = 1, .first = 9, .most = 129, .admissible = one_beyond_a_multiple_of_four});
    const Values truth{poisson_ratio_of_ratio(ratio), std::log(hexagonal_stiffness_ratio(ratio))};
    score.kept += largest(got.values, truth) <= accuracy ? 1 : 0;
    // The least: the largest block that does not do, and one row of gauges more.
    std::int64_t least = got.level;
    while (least > 9 && largest(evaluate(least - 4), truth) <= accuracy) least -= 4;
    const double dearer = std::pow(static_cast<double>(got.level) / static_cast<double>(least), 2.2);
    score.cheap += dearer <= 2 ? 1 : 0;
    dearest = std::max(dearest, dearer);
  }
  CAPTURE(dearest);
  score.check("equidem solve: Abe's tension test");
}

TEST_CASE("accuracy_asked_of_an_oscillator_is_kept_at_most_twice_the_least_cost") {
  // Leapfrog on x'' = -w^2 x over a time of 1 from x = 1 at rest: x_n = cos(2 n asin(w h/2)) (its own closed form
  // differs from the truth, cos w, by second order).
  Random random(51);
  Score score{.requests = 200};
  for (int k = 0; k < score.requests; ++k) {
    const double w = random.uniform(1, 40), accuracy = std::pow(10.0, random.uniform(-6, -1.5));
    const auto evaluate = [&](std::int64_t n) {
      const double angle = 2 * static_cast<double>(n) * std::asin(0.5 * w / static_cast<double>(n));
      return Values{std::cos(angle), std::sin(angle)};
    };
    const Values truth{std::cos(w), std::sin(w)};
    const auto first = static_cast<std::int64_t>(std::ceil(w / 1.6));
    const Got got =
        refine(evaluate, {.accuracy = accuracy, .order = 2, .first = first, .most = 10000000, .apart = near});
    score.kept += largest(got.values, truth) <= accuracy ? 1 : 0;
    const std::int64_t half = got.level / 2;
    score.cheap += half < first || largest(evaluate(half), truth) > accuracy ? 1 : 0;
  }
  score.check("time step: an oscillator, leapfrog");
}

TEST_CASE("accuracy_asked_of_bonded_waves_is_kept_at_most_twice_the_least_cost") {
  const Integrator integrator = GENERATE(Integrator::leapfrog, Integrator::fourth_order);
  const double finest = integrator == Integrator::leapfrog ? 1e-4 : 1e-7;
  const Waves waves(0.5);
  Random random(61);
  Score score{.requests = 200};
  std::vector<double> pilots;
  for (int k = 0; k < score.requests; ++k) {
    const double accuracy = std::pow(10.0, random.uniform(std::log10(finest), -1));
    const Waves::Sum sum = waves.random_sum(random);
    const auto evaluate = [&](std::int64_t n) { return waves.run(sum, integrator, n); };
    const Values truth = waves.exact(sum);
    const auto first = static_cast<std::int64_t>(
        std::ceil(sum.time * waves.fastest() / (0.8 * scheme_of(integrator).stability_limit(0))));
    const Got got = refine(evaluate, {.accuracy = accuracy,
                                      .order = static_cast<double>(scheme_of(integrator).order),
                                      .first = first,
                                      .most = 4096 * first,
                                      .apart = near,
                                      .distance = relative});
    score.kept += relative(got.values, truth) <= accuracy ? 1 : 0;
    const std::int64_t half = got.level / 2;
    score.cheap += half < first || relative(evaluate(half), truth) > accuracy ? 1 : 0;
    pilots.push_back(got.pilots);
  }
  score.check("equidem run: bonded waves, " + std::string(to_string(integrator)));
  std::sort(pilots.begin(), pilots.end());
  CAPTURE(pilots.front(), pilots[pilots.size() / 2], pilots.back());
  CHECK(pilots[pilots.size() / 2] < 3);  // 1 + 1.4 + 2 of a run that the case's own step does
}

TEST_CASE("accuracy_that_no_level_reaches_is_refused_with_what_can_be_reached") {
  const auto refused = [](const std::function<Values(std::int64_t)>& evaluate, const char* words) {
    try {
      Refinement search(evaluate, {.accuracy = 1e-6, .order = 1, .first = 8, .most = 1000});
      CAPTURE(search.propose());
      FAIL("reached");
    } catch (const Error& error) {
      CHECK(error.kind() == ErrorKind::computation_failed);
      CHECK_THAT(error.what(), Catch::Contains("cannot be reached") && Catch::Contains(words));
    }
  };
  SECTION("too fine") {
    std::int64_t finest = 0;
    refused(
        [&](std::int64_t n) {
          finest = n;
          return Values{1 + 1.0 / static_cast<double>(n)};
        },
        "about 0.001");
    CHECK(finest <= 32);  // the third level suffices to see it
  }
  SECTION("errors that do not fall") {
    refused([](std::int64_t n) { return Values{n % 3 == 0 ? 1.0 : 2.0 + static_cast<double>(n % 7)}; },
            "and not as levels^-1");
  }
}
