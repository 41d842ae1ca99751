// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The tension test before and after the solver: gauges, loads, what is read from a known motion.
#include <cmath>
#include <numbers>
#include <regex>
#include <string>

#include "equidem/homogenize/tension_test.hpp"
#include "equidem/material/spring_relations.hpp"

#include "homogenize/samples.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace samples;

namespace {

constexpr double a = 0.005;
constexpr GaugePlacement gauge_placements[] = {GaugePlacement::centre, GaugePlacement::quarter, GaugePlacement::ends};

Assembly lattice(const std::string& kind, int columns, int rows) {
  const LatticeOptions options{.columns = columns, .rows = rows, .radius = a, .periodic = false};
  return kind == "square" ? square_lattice(options) : hexagonal_lattice(options);
}

/// The message of the refusal, or empty where the gauges fit.
std::string refusal(const std::string& kind, int columns, int rows, GaugePlacement placement) {
  const Assembly assembly = lattice(kind, columns, rows);
  return message_of([&] { static_cast<void>(tension_setup(assembly, {.stress = 1, .gauge = placement})); });
}

}  // namespace

TEST_CASE("gauges_of_a_lattice_lie_along_the_axes_about_its_middle") {
  const std::string kind = GENERATE("hexagonal", "square");
  int placed = 0;
  for (const GaugePlacement placement : gauge_placements) {
    for (int columns = 2; columns <= 13; ++columns) {
      for (int rows = 1; rows <= 13; ++rows) {
        if (!refusal(kind, columns, rows, placement).empty()) continue;
        ++placed;
        const Assembly assembly = lattice(kind, columns, rows);
        const TensionSetup setup = tension_setup(assembly, {.stress = 1, .gauge = placement});
        const Vec2 A = assembly.centres[setup.horizontal.first], B = assembly.centres[setup.horizontal.second];
        const Vec2 C = assembly.centres[setup.vertical.first], D = assembly.centres[setup.vertical.second];
        const double row_distance = kind == "square" ? 2 * a : std::numbers::sqrt3 * a;
        const Vec2 middle{columns * a, rows * row_distance / 2};
        CAPTURE(kind, to_string(placement), columns, rows, A.x, A.y, B.x, B.y, C.x, C.y, D.x, D.y);
        REQUIRE(A.y == B.y);
        REQUIRE(std::abs(C.x - D.x) < 1e-12 * a);
        REQUIRE(A.x < B.x);
        REQUIRE(C.y < D.y);
        REQUIRE(std::abs(0.5 * (A.x + B.x) - middle.x) < 1e-9 * a);
        REQUIRE(std::abs(A.y - middle.y) < 0.501 * row_distance);
        REQUIRE(std::abs(C.x - middle.x) < 1.001 * a);
        REQUIRE(std::abs(0.5 * (C.y + D.y) - middle.y) < 0.501 * row_distance);
        // Odd rows of a hexagonal block, and any square block, allow symmetry about the middle row as well.
        if (rows % 2 != 0 || kind == "square") {
          REQUIRE(std::abs(0.5 * (C.y + D.y) - middle.y) < 1e-9 * a);
        }
        // With an even number of rows, the middle one with a disc in its middle is taken.
        if (rows % 2 == 0 && kind == "hexagonal") REQUIRE(std::lround((B.x - A.x) / (2 * a)) % 2 == 0);
        const double row_length = 2 * a * (columns - 1);
        const double width = B.x - A.x, height = D.y - C.y;
        switch (placement) {
          case GaugePlacement::centre:
            REQUIRE(width > 8 * a - 1e-9 * a);
            REQUIRE(width < 10 * a + 1e-9 * a);
            REQUIRE(height > 4 * row_distance - 1e-9 * a);
            REQUIRE(height < 5 * row_distance + 1e-9 * a);
            break;
          case GaugePlacement::quarter:
            REQUIRE(width > row_length / 2 - 1.001 * a);
            REQUIRE(width < row_length / 2 + 4.001 * a);
            REQUIRE(height > (rows - 1) * row_distance / 2 - 0.001 * a);
            REQUIRE(height < (rows - 1) * row_distance / 2 + 2.001 * row_distance);
            break;
          case GaugePlacement::ends:
            REQUIRE(width > row_length - 2.001 * a);
            REQUIRE(height > (rows - 2) * row_distance - 0.001 * a);
            break;
        }
      }
    }
  }
  CHECK(placed > 200);
}

TEST_CASE("a_block_too_small_for_its_gauges_is_told_the_least_size") {
  const std::string kind = GENERATE("hexagonal", "square");
  int refused = 0;
  for (const GaugePlacement placement : gauge_placements) {
    for (int columns = 2; columns <= 7; ++columns) {
      for (int rows = 1; rows <= 7; ++rows) {
        const std::string message = refusal(kind, columns, rows, placement);
        if (message.empty()) continue;
        ++refused;
        CAPTURE(kind, columns, rows, message);
        std::smatch least;
        REQUIRE(std::regex_search(message, least, std::regex("they need at least (\\d+) columns and (\\d+) rows")));
        REQUIRE(contains(message, "'" + to_string(placement) + "'"));
        const int least_columns = std::max(columns, std::stoi(least[1]));
        const int least_rows = std::max(rows, std::stoi(least[2]));
        CHECK(std::max(least_columns - columns, least_rows - rows) > 0);
        // One of the two numbers of rows has the parity that the message spoke of.
        const int same_parity = least_rows + (least_rows - rows) % 2;
        CHECK(refusal(kind, least_columns, same_parity, placement).empty());
      }
    }
  }
  CHECK(refused > 10);
}

TEST_CASE("the_pulls_balance_and_the_height_is_that_of_the_rows") {
  const int rows = GENERATE(5, 8);
  const Assembly assembly = lattice("hexagonal", 7, rows);
  const TensionSetup setup = tension_setup(assembly, {.stress = 3e5});
  CHECK(setup.height == Approx(rows * std::numbers::sqrt3 * a).epsilon(1e-14));
  REQUIRE(setup.loads.size() == 2);
  double total = 0;
  for (const Load& load : setup.loads) {
    CHECK(load.kind == LoadKind::traction);
    CHECK(load.force.y == 0);
    for (const double length : group(assembly, load.group).tributary_lengths) total += load.force.x * length;
    CHECK(std::abs(load.force.x) == 3e5);
  }
  CHECK(std::abs(total) < 1e-9);
  REQUIRE(setup.supports.size() == 2);
  for (const Support& support : setup.supports) {
    CHECK(support.uy == 0.0);
    CHECK(support.ux.has_value() == (support.group == "bottom_left"));
    CHECK(!support.rotation);
  }
}

TEST_CASE("a_known_uniform_field_is_read_exactly_whatever_the_assembly_and_the_gauges") {
  const double e11 = 2e-4, e22 = -0.7e-4;
  for (const GaugePlacement placement : gauge_placements) {
    for (const auto& [name, assembly] : assemblies(false)) {
      const TensionTest test{.stress = 5e4, .gauge = placement};
      const TensionSetup setup = tension_setup(assembly, test);
      Equilibrium equilibrium;
      equilibrium.motions.resize(assembly.size());
      for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
        const Vec2 x = assembly.centres[disc];
        equilibrium.motions[disc].u = {e11 * x.x, e22 * x.y};
      }
      std::vector<SpringConstants> constants(assembly.contacts.size());
      double sum = 0;
      Random random(31);
      for (SpringConstants& k : constants) sum += k.kN = random.uniform(1e8, 2e8);
      const double mean_kN = sum / static_cast<double>(constants.size());
      const TensionResult result = evaluate_tension(assembly, ContactSprings(constants), test, setup, equilibrium);

      const Vec2 ab = assembly.centres[setup.horizontal.second] - assembly.centres[setup.horizontal.first];
      const Vec2 cd = assembly.centres[setup.vertical.second] - assembly.centres[setup.vertical.first];
      CAPTURE(name, to_string(placement), ab.x, ab.y, cd.x, cd.y);
      const double tilt_ab = ab.y * ab.y / dot(ab, ab), tilt_cd = cd.x * cd.x / dot(cd, cd);
      const double read_11 = e11 + (e22 - e11) * tilt_ab, read_22 = e22 + (e11 - e22) * tilt_cd;
      if (assembly.kind != "delaunay") CHECK(tilt_ab + tilt_cd < 1e-20);
      CHECK(tilt_ab < 0.2);
      CHECK(tilt_cd < 0.2);
      CHECK(result.poisson_ratio == Approx(poisson_ratio_of_strains(read_11, read_22)).epsilon(1e-12));
      CHECK(result.fitted_poisson_ratio == Approx(poisson_ratio_of_strains(e11, e22)).epsilon(1e-12));
      CHECK(result.stiffness_ratio == Approx(5e4 / (mean_kN * read_11)).epsilon(1e-12));
      CHECK(result.strain.xx == Approx(read_11).epsilon(1e-12));
      CHECK(result.strain.yy == Approx(read_22).epsilon(1e-12));
      CHECK(std::abs(result.strain.xy) < 1e-12 * e11);
      CHECK(result.stress.xx == 5e4);
    }
  }
}

// The nearest disc lies within three quarters of a spacing of a point.
TEST_CASE("gauges_of_a_random_block_are_four_discs_near_their_points") {
  const Assembly assembly = delaunay_assembly({.discs = 400, .seed = 5});
  const Rectangle extents = upright_rectangle(assembly.centres);
  double spacing = 0;
  for (const Contact& c : assembly.contacts)
    spacing += norm(assembly.branch(c)) / static_cast<double>(assembly.contacts.size());
  for (const GaugePlacement placement : gauge_placements) {
    const TensionSetup setup = tension_setup(assembly, {.stress = 1, .gauge = placement});
    const Vec2 A = assembly.centres[setup.horizontal.first], B = assembly.centres[setup.horizontal.second];
    const Vec2 C = assembly.centres[setup.vertical.first], D = assembly.centres[setup.vertical.second];
    CAPTURE(to_string(placement), spacing, A.x, A.y, B.x, B.y, C.x, C.y, D.x, D.y);
    const auto length = [&](double extent) {
      if (placement == GaugePlacement::centre) return 4 * spacing;
      return placement == GaugePlacement::quarter ? extent / 2 : extent;
    };
    const Vec2 along{length(extents.high.x - extents.low.x), 0}, up{0, length(extents.high.y - extents.low.y)};
    CHECK(norm(B - A - along) < 1.5 * spacing);
    CHECK(norm(D - C - up) < 1.5 * spacing);
  }
}

TEST_CASE("a_tension_test_that_cannot_be_made_is_refused_with_its_reason") {
  const Assembly block = lattice("hexagonal", 7, 7);
  const auto message = [](const Assembly& assembly, double stress) {
    return message_of([&] { static_cast<void>(tension_setup(assembly, {.stress = stress})); });
  };
  CHECK(message(block, 1).empty());

  CHECK(contains(message(block, 0), "the tension test pulls with a stress of 0 Pa"));
  CHECK(contains(message(block, std::nan("")), "the tension test pulls with a stress of nan Pa"));

  const Assembly periodic = hexagonal_lattice({.columns = 8, .rows = 8, .radius = a, .periodic = true});
  CHECK(contains(message(periodic, 1), "a periodic cell has no sides to pull at"));

  Assembly bare = block;
  bare.contacts.clear();
  CHECK(contains(message(bare, 1), "discs without contacts"));

  Assembly sideless = block;
  sideless.groups.erase("left");
  CHECK(contains(message(sideless, 1), "no group 'left'"));

  Assembly own_group = block;
  own_group.groups["right"].tributary_lengths.clear();
  CHECK(contains(message(own_group, 1), "the group 'right' is not a side of the block"));

  Assembly lopsided = block;
  lopsided.groups["right"].tributary_lengths.back() *= 2;
  CHECK(contains(message(lopsided, 1), "the two pulls of the test must balance"));

  const Assembly few = delaunay_assembly({.discs = 9, .seed = 1});
  const std::string too_few = message(few, 1);
  CAPTURE(too_few);
  CHECK(contains(too_few, "4 mean spacings each way"));

  CHECK_THROWS_AS(enum_from<GaugePlacement>("center"), Error);
  for (const GaugePlacement placement : gauge_placements)
    CHECK(enum_from<GaugePlacement>(to_string(placement)) == placement);
}
