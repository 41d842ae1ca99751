// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Motions in words, and the quotient of energies that distinguishes a mechanism from a soft mode.
#include "equidem/statics/motion_description.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

constexpr double radius = 0.005;

Assembly hexagonal(int columns, int rows, bool periodic = false) {
  return hexagonal_lattice({.columns = columns, .rows = rows, .radius = radius, .periodic = periodic});
}

Assembly square_block(int columns, int rows) {
  return square_lattice({.columns = columns, .rows = rows, .radius = radius});
}

std::vector<DiscMotion> rigid_motion(const Assembly& assembly, Vec2 t, double omega, Vec2 about) {
  std::vector<DiscMotion> motions;
  for (const Vec2 x : assembly.centres) motions.push_back({t + omega * perpendicular(x - about), omega});
  return motions;
}

/// theta = +-1 on the squares of a chess board.
std::vector<DiscMotion> gears(const Assembly& square_assembly) {
  std::vector<DiscMotion> motions;
  for (const Vec2 x : square_assembly.centres) {
    const auto square = static_cast<int>(x.x / (2 * radius)) + static_cast<int>(x.y / (2 * radius));
    motions.push_back({{}, square % 2 == 0 ? 1.0 : -1.0});
  }
  return motions;
}

void check_says(const Assembly& assembly, std::vector<DiscMotion> motions, const std::vector<std::string>& words) {
  const std::string first = describe_motion(assembly, motions);
  INFO("the words: " << first);
  for (const std::string& word : words) {
    INFO("looked for: " << word);
    CHECK(first.find(word) != std::string::npos);
  }
  // Powers of two leave every rounding as it is.
  for (const double scale : {-1.0, 0x1p-400, 0x1p+400}) {
    std::vector<DiscMotion> scaled = motions;
    for (DiscMotion& m : scaled) m = {scale * m.u, scale * m.theta};
    CHECK(describe_motion(assembly, scaled) == first);
  }
}

/// Cholesky factor of K + shift max(diag K) over the free components, in a band; discs of lattices are numbered along
/// their rows, so that the band of a slender one is narrow.
class BandSolver {
 public:
  BandSolver(const Assembly& assembly, const ContactSprings& springs, const DegreesOfFreedom& unknowns, double shift) {
    const ContactGraph graph(assembly);
    columns_ = compress(assemble_stiffness(assembly, graph, springs, unknowns), assembly, graph, unknowns);
    const std::int64_t n = columns_.size;
    for (std::int64_t c = 0; c < n; ++c) {
      for (std::int64_t e = columns_.first[c]; e < columns_.first[c + 1]; ++e) {
        band_ = std::max(band_, columns_.rows[e] - c);
      }
    }
    l_.assign(n * (band_ + 1), 0.0);
    for (std::int64_t c = 0; c < n; ++c) {
      for (std::int64_t e = columns_.first[c]; e < columns_.first[c + 1]; ++e) {
        at(columns_.rows[e], c) += columns_.values[e];
      }
      at(c, c) += shift * springs.largest();
    }
    for (std::int64_t c = 0; c < n; ++c) {
      for (std::int64_t k = std::max<std::int64_t>(0, c - band_); k < c; ++k) {
        for (std::int64_t r = c; r <= std::min(n - 1, k + band_); ++r) at(r, c) -= at(r, k) * at(c, k);
      }
      REQUIRE(at(c, c) > 0);
      at(c, c) = std::sqrt(at(c, c));
      for (std::int64_t r = c + 1; r <= std::min(n - 1, c + band_); ++r) at(r, c) /= at(c, c);
    }
  }

  /// The eigenvector of the smallest eigenvalue by inverse iteration, as motions.
  std::vector<DiscMotion> softest_mode(const Assembly& assembly, const DegreesOfFreedom& unknowns) {
    const std::int64_t n = columns_.size;
    Random random(3);
    std::vector<double> x(n);
    for (double& value : x) value = random.uniform(-1, 1);
    for (int iteration = 0; iteration < 30; ++iteration) {
      for (std::int64_t c = 0; c < n; ++c) {
        x[c] /= at(c, c);
        for (std::int64_t r = c + 1; r <= std::min(n - 1, c + band_); ++r) x[r] -= at(r, c) * x[c];
      }
      for (std::int64_t c = n; c-- > 0;) {
        for (std::int64_t r = c + 1; r <= std::min(n - 1, c + band_); ++r) x[c] -= at(r, c) * x[r];
        x[c] /= at(c, c);
      }
      double square = 0;
      for (const double value : x) square += value * value;
      for (double& value : x) value /= std::sqrt(square);
    }
    std::vector<DiscMotion> motions(assembly.size());
    for (std::int64_t c = 0; c < n; ++c) {
      const std::int64_t disc = columns_.component[c] / unknowns.per_disc;
      const std::int64_t k = columns_.component[c] % unknowns.per_disc;
      DiscMotion& m = motions[disc];
      (k == 0 ? m.u.x : k == 1 ? m.u.y : m.theta) = k == 2 ? x[c] / unknowns.rotation_scale : x[c];
    }
    return motions;
  }

 private:
  double& at(std::int64_t r, std::int64_t c) { return l_[c * (band_ + 1) + r - c]; }

  CompressedColumns columns_;
  std::int64_t band_ = 0;
  std::vector<double> l_;
};

/// The first row held in all components.
DegreesOfFreedom clamp_first_row(const Assembly& assembly, int columns, int per_disc) {
  DegreesOfFreedom unknowns;
  unknowns.per_disc = per_disc;
  unknowns.rotation_scale = assembly.mean_radius();
  unknowns.held.assign(assembly.size() * per_disc, 0);
  unknowns.prescribed.assign(unknowns.held.size(), 0.0);
  std::fill_n(unknowns.held.begin(), columns * per_disc, std::uint8_t{1});
  return unknowns;
}

}  // namespace

TEST_CASE("rigid_motions_are_named") {
  const Assembly assembly = hexagonal(5, 6);
  check_says(assembly, rigid_motion(assembly, {2, 0}, 0, {}), {"rigid translation along x of all 27 discs"});
  check_says(assembly, rigid_motion(assembly, {0, -3}, 0, {}), {"rigid translation along y"});
  check_says(assembly, rigid_motion(assembly, {0.6, 0.8}, 0, {}), {"translation along (0.6, 0.8)"});
  const Vec2 point = GENERATE(Vec2{0, 0}, Vec2{0.025, 0.0433}, Vec2{-0.3, 0.1});
  check_says(assembly, rigid_motion(assembly, {}, 0.1, point),
             {fmt::format("rigid rotation about ({:.6g}, {:.6g}) of all", point.x, point.y)});
  std::vector<DiscMotion> rolling = rigid_motion(assembly, {}, 0.1, point);
  for (DiscMotion& m : rolling) m.theta *= 2;
  check_says(assembly, rolling, {"rigid rotation about (", "rolling"});
  check_says(assembly, std::vector<DiscMotion>(assembly.size()), {"no motion"});
}

TEST_CASE("a_cluster_across_the_period_rotates_as_one") {
  Assembly assembly = hexagonal(3, 3);
  assembly.period = Vec2{1, 1};
  std::vector<DiscMotion> motions = rigid_motion(assembly, {}, 1, {0.02, 0.01});
  const auto moved = [](int d) { return d % 3 == 0 ? 1 : 0; };
  for (Contact& c : assembly.contacts) c.shift_y = moved(c.i) - moved(c.j);
  for (std::size_t d = 0; d < assembly.size(); ++d) assembly.centres[d].y += moved(static_cast<int>(d));
  // Laid out from disc 0, which lies one period above.
  check_says(assembly, motions, {"rigid rotation about (0.02, 1.01)"});
}

TEST_CASE("a_piece_that_moves_alone_is_named") {
  Assembly assembly = hexagonal(8, 8);
  std::vector<DiscMotion> motions(assembly.size());
  for (std::size_t d = 0; d < 8; ++d) motions[d] = {{0, 1}, 0};
  check_says(assembly, motions, {"rigid translation along y of 8 of 60 discs, such as disc 0 at (0.005, "});
}

TEST_CASE("counter_rotation_is_named") {
  const Assembly assembly = square_block(6, 5);
  check_says(assembly, gears(assembly), {"counter-rotation in place of all 30 discs", "gears"});
  std::vector<DiscMotion> spin(assembly.size(), {{}, 1.0});
  const std::string words = describe_motion(assembly, spin);
  INFO(words);
  CHECK(words.find("counter") == std::string::npos);
  CHECK(words.find("rotation in place of all 30 discs") != std::string::npos);
}

TEST_CASE("local_motions_name_their_discs") {
  const Assembly assembly = hexagonal(10, 10);
  std::vector<DiscMotion> motions(assembly.size());
  motions[17] = {{1, 0.4}, 3};
  motions[41] = {{-0.2, 0.9}, 0};
  check_says(assembly, motions, {"local motion of about 2 of 95 discs", describe_disc(assembly, 17), "disc 41 at"});
  for (std::size_t d = 50; d < 60; ++d) motions[d] = {{0.9, d % 2 == 0 ? 0.5 : -0.5}, 0};
  Assembly larger = hexagonal(20, 20);
  motions.resize(larger.size());
  check_says(larger, motions, {"local motion of about 12 of 390 discs", "..."});
}

TEST_CASE("motions_of_the_whole_are_told_apart") {
  const Assembly assembly = square_block(12, 12);
  const auto field = [&](auto&& u) {
    std::vector<DiscMotion> motions;
    for (const Vec2 x : assembly.centres) motions.push_back({u(x), 0});
    return motions;
  };
  check_says(assembly, field([](Vec2 x) { return Vec2{x.y, 0}; }), {"uniform shear", "144 discs"});
  check_says(assembly, field([](Vec2 x) { return Vec2{x.x, -x.y}; }), {"uniform shear"});
  check_says(assembly, field([](Vec2 x) { return Vec2{x.x, 0.8 * x.y}; }), {"uniform strain"});
  check_says(assembly, field([](Vec2 x) {
               return Vec2{std::sin(300 * x.y), std::sin(200 * x.x)};
             }),
             {"a motion spread over 144 of 144 discs, largest at disc "});
}

TEST_CASE("mechanisms_of_periodic_cells_are_named") {
  const auto check_mechanism = [](const Assembly& assembly, double kT, const std::vector<DiscMotion>& motions,
                                  const std::vector<std::string>& words) {
    CHECK(softness(assembly, ContactSprings(SpringConstants{1e9, kT}), motions) < 1e-27);
    check_says(assembly, motions, words);
  };
  const auto cell_of_squares = [](int size) {
    return square_lattice({.columns = size, .rows = size, .radius = radius, .periodic = true});
  };
  SECTION("the gears of a bipartite network") {
    const Assembly assembly = cell_of_squares(GENERATE(2, 6));
    check_mechanism(assembly, 0.5e9, gears(assembly),
                    {"a counter-rotation in place of all ", "neighbours turning against one another like gears"});
  }
  SECTION("a disc between two contacts in line") {
    const int size = GENERATE(2, 6);
    Assembly assembly = hexagonal(size, size, true);
    std::erase_if(assembly.contacts, [&](const Contact& c) {
      return (c.i == 1 || c.j == 1) && std::abs(assembly.branch(c).y) > 0.1 * radius;
    });
    std::vector<DiscMotion> motions(assembly.size());
    motions[1].u = {0, 1};
    check_mechanism(assembly, 0, motions, {"a motion of " + describe_disc(assembly, 1) + " alone, along y"});
  }
  SECTION("rows that slide") {
    const int size = GENERATE(2, 6);
    const Assembly assembly = cell_of_squares(size);
    std::vector<DiscMotion> motions(assembly.size());
    for (int d = 0; d < size; ++d) motions[d].u = {1, 0};
    check_mechanism(assembly, 0, motions,
                    {fmt::format("a rigid translation along x of {} of {} discs", size, size * size)});
    if (size == 2) return;
    for (int d = 3 * size; d < 4 * size; ++d) motions[d].u = {-0.3, 0};
    check_mechanism(assembly, 0, motions,
                    {"a sliding of 2 groups of discs along x, each of which moves as one: 12 of 36 discs"});
  }
  SECTION("a ring that turns, across the period too") {
    // The discs around a hole of the honeycomb; its other contacts are radial.
    Assembly assembly = hexagonal(6, 6, true);
    const auto hole = [](std::int32_t d) { return (d % 6 + 2 * (d / 12) + 2 * (d / 6)) % 3 == 0; };
    std::erase_if(assembly.contacts, [&](const Contact& c) { return hole(c.i) || hole(c.j); });
    const std::int32_t middle = GENERATE(15, 0);
    REQUIRE(hole(middle));
    std::vector<DiscMotion> motions(assembly.size());
    const Vec2 period = *assembly.period;
    int ring = 0;
    for (std::size_t d = 0; d < assembly.size(); ++d) {
      Vec2 l = assembly.centres[d] - assembly.centres[middle];
      l -= {std::round(l.x / period.x) * period.x, std::round(l.y / period.y) * period.y};
      if (norm(l) > 2.1 * radius || norm(l) == 0) continue;
      motions[d].u = perpendicular(l);
      ++ring;
    }
    REQUIRE(ring == 6);
    check_mechanism(assembly, 0, motions,
                    {"a rigid rotation about (", fmt::format("of 6 of {} discs", assembly.size())});
  }
  SECTION("the shear of a honeycomb") {
    // The branches b from the one disc of a cell to the other, 2a (1, 0) and a (-1, +-sqrt3), keep their length where
    // b . (H b + w) = 0: for the gradient H = (0 1; 1 0) with the shift w = (0, 2a) of all other discs, and for
    // H = (1 0; 0 -1) with w = (-2a, 0).
    Assembly assembly = hexagonal(12, 12);
    const auto row = [&](std::size_t d) {
      return std::lround(assembly.centres[d].y / (std::sqrt(3.0) * radius) - 0.5);
    };
    const auto kind = [&](std::size_t d) {
      const long half = std::lround(assembly.centres[d].x / radius) - 1;
      return (((half - row(d)) / 2 - row(d)) % 3 + 3) % 3;
    };
    std::erase_if(assembly.contacts, [&](const Contact& c) { return kind(c.i) == 0 || kind(c.j) == 0; });
    const bool diagonal = GENERATE(false, true);
    std::vector<DiscMotion> motions;
    for (std::size_t d = 0; d < assembly.size(); ++d) {
      const Vec2 x = assembly.centres[d];
      Vec2 u = diagonal ? Vec2{x.x, -x.y} : Vec2{x.y, x.x};
      if (kind(d) == 2) u += diagonal ? Vec2{-2 * radius, 0} : Vec2{0, 2 * radius};
      motions.push_back({u, 0});
    }
    check_mechanism(assembly, 0, motions,
                    {"a nearly uniform shear spread over ", "contacts slipping but not stretching"});
  }
}

TEST_CASE("mechanisms_have_no_stiffness_but_rounding") {
  Random random(11);
  SECTION("rigid motions, far from the origin too") {
    Assembly assembly = hexagonal(40, 25);
    const Vec2 shift = GENERATE(Vec2{0, 0}, Vec2{50, -20});
    for (Vec2& x : assembly.centres) x += shift;
    for (Contact& c : assembly.contacts) c.lever_i = c.lever_j = 0.5 * norm(assembly.branch(c));
    const auto motions = rigid_motion(assembly, {0.3, 0.1}, 0.7, {0.1, 0.2});
    const double quotient = softness(assembly, ContactSprings(SpringConstants{1e9, 0.4e9}), motions);
    CAPTURE(quotient, shift.x);
    CHECK(quotient >= 0);
    CHECK(quotient < 1e-27);
  }
  SECTION("gears") {
    const Assembly assembly = square_block(30, 30);
    const double kT = GENERATE(1e9, 1.0, -1e8);
    CHECK(std::abs(softness(assembly, ContactSprings(SpringConstants{1e9, kT}), gears(assembly))) < 1e-28);
  }
  SECTION("the shear of a square lattice without tangential springs, computed from its singular matrix") {
    const Assembly assembly = square_block(10, 30);
    const ContactSprings springs(SpringConstants{1e9, 0});
    const DegreesOfFreedom unknowns = clamp_first_row(assembly, 10, 2);
    BandSolver solver(assembly, springs, unknowns, 1e-13);
    const auto motions = solver.softest_mode(assembly, unknowns);
    const double quotient = softness(assembly, springs, motions);
    INFO(describe_motion(assembly, motions));
    CAPTURE(quotient);
    CHECK(std::abs(quotient) < 1e-24);
  }
}

TEST_CASE("soft_modes_stay_above_mechanisms") {
  // The slender cantilever: its first bending mode is the softest stable mode of all shapes.
  struct Strip {
    int columns, rows;
    double kT;
  };
  const Strip strip = GENERATE(Strip{2, 660, 0.5e9}, Strip{3, 400, 0.5e9}, Strip{3, 400, 1e5}, Strip{11, 95, 0.5e9});
  const Assembly assembly = hexagonal(strip.columns, strip.rows);
  const ContactSprings springs(SpringConstants{1e9, strip.kT});
  const DegreesOfFreedom unknowns = clamp_first_row(assembly, strip.columns, 3);
  BandSolver solver(assembly, springs, unknowns, 0);
  const auto motions = solver.softest_mode(assembly, unknowns);
  const double quotient = softness(assembly, springs, motions);
  const std::string words = describe_motion(assembly, motions);
  CAPTURE(assembly.size(), strip.columns, strip.kT, quotient, words);
  CHECK(quotient > 1e-16);
  CHECK(quotient < 1e-6);
  CHECK(words.find("a motion spread over") != std::string::npos);
}

TEST_CASE("the_energy_of_a_motion_is_the_quadratic_form_of_K") {
  const Assembly assembly = hexagonal(5, 5);
  const ContactSprings springs(SpringConstants{1e9, GENERATE(0.3e9, -0.2e9)});
  DegreesOfFreedom unknowns = clamp_first_row(assembly, 0, 3);
  const ContactGraph graph(assembly);
  const StiffnessMatrix K = assemble_stiffness(assembly, graph, springs, unknowns);
  Random random(5);
  std::vector<DiscMotion> motions(assembly.size());
  std::vector<double> x(3 * assembly.size()), y(3 * assembly.size());
  for (std::size_t d = 0; d < motions.size(); ++d) {
    motions[d] = {{random.uniform(-1, 1), random.uniform(-1, 1)}, random.uniform(-1, 1) / radius};
    x[3 * d] = motions[d].u.x;
    x[3 * d + 1] = motions[d].u.y;
    x[3 * d + 2] = unknowns.rotation_scale * motions[d].theta;
  }
  multiply(K, assembly, graph, x, y);
  double form = 0;
  for (std::size_t k = 0; k < x.size(); ++k) form += 0.5 * x[k] * y[k];
  CHECK(elastic_energy(assembly, springs, motions) == Approx(form).epsilon(1e-12));
}
