// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/pictures/picture.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <regex>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"

#include "output/png.hpp"
#include "output/states.hpp"
#include "support/catch.hpp"

using namespace equidem;

namespace {

std::string as_byte(double component) {
  return std::to_string(std::lround(255 * component));
}

/// Identifiers of an SVG replaced by their order: cairo 1.18 counts surfaces over the whole process.
std::string renumbered(const std::string& svg) {
  static const std::regex identifier("(id=\"|#)([A-Za-z0-9_-]+)");
  std::map<std::string, std::size_t> order;
  std::string result;
  auto unread = svg.begin();
  for (std::sregex_iterator found(svg.begin(), svg.end(), identifier), end; found != end; ++found) {
    result.append(unread, (*found)[2].first);
    result += std::to_string(order.try_emplace(found->str(2), order.size()).first->second);
    unread = (*found)[2].second;
  }
  return result.append(unread, svg.end());
}

}  // namespace

TEST_CASE("every_disc_has_the_colour_of_its_stress_at_its_displaced_place") {
  struct Case {
    const char* name;
    int columns, rows;
    bool periodic;
  };
  const auto [name, columns, rows, periodic] =
      GENERATE(Case{"few discs", 5, 5, false}, Case{"periodic", 6, 4, true}, Case{"as an image", 103, 102, false});
  CAPTURE(name);
  const MadeUpState state =
      made_up(hexagonal_lattice({.columns = columns, .rows = rows, .periodic = periodic}), {1e-3, 2e-4, -1e-4, -3e-4});
  const bool fine = state.assembly.size() > most_drawn_discs;
  const AssemblyState view{state.assembly, state.motions, {}, state.stresses};  // no force chains
  const PictureOptions options{.title = "σ of discs", .colour = DiscColour::stress_xy};
  const PictureScene scene = plan_scene(view, options);
  REQUIRE(scene.as_image == fine);
  const TemporaryFolder folder;
  write_picture(folder.path(), "discs", view, options, false);

  const std::string png = read_file(folder / "discs.png");
  REQUIRE(png.substr(0, 8) == "\x89PNG\r\n\x1a\n");
  CHECK(big_endian(png, 16) == 1000);
  CHECK(big_endian(png, 20) == static_cast<std::uint32_t>(std::ceil(scene.frame.height)));
  CHECK(run_python("well_formed.py", {(folder / "discs.svg").string()}) == 0);
  std::vector<std::string> arguments{(folder / "discs.png").string()};
  double largest = 0;
  for (const Tensor2& stress : state.stresses) largest = std::max(largest, std::abs(stress.xy));
  for (std::size_t disc = 0; disc < state.assembly.size(); disc += fine ? 53 : 1) {
    const Vec2 at = scene.frame.to_page(scene.centres[disc]);
    const Colour colour = colour_at(ColourMap::diverging, 0.5 + 0.5 * state.stresses[disc].xy / largest);
    for (const double v : {at.x, at.y}) arguments.push_back(std::to_string(static_cast<int>(v)));
    for (const double c : {colour.red, colour.green, colour.blue}) arguments.push_back(as_byte(c));
  }
  CHECK(run_python("pixels.py", arguments) == 0);
}

TEST_CASE("a_gauge_is_a_line_between_its_discs") {
  const Assembly block = hexagonal_lattice({.columns = 9, .rows = 9});
  const TemporaryFolder folder;
  const PictureOptions options{.colour = DiscColour::none, .gauges = {{38, 42, "A", "B"}}};
  write_picture(folder.path(), "block", {block}, options, false);
  const PictureScene scene = plan_scene({block}, options);
  const Vec2 a = scene.frame.to_page(block.centres[38]), b = scene.frame.to_page(block.centres[42]);
  std::vector<std::string> arguments{(folder / "block.png").string()};
  for (const Vec2 at : {a, b, 0.5 * (a + b)}) {
    for (const double v : {at.x, at.y}) arguments.push_back(std::to_string(static_cast<int>(v)));
    for (const double c : {ink.red, ink.green, ink.blue}) arguments.push_back(as_byte(c));
  }
  CHECK(run_python("pixels.py", arguments) == 0);
}

TEST_CASE("the_same_state_gives_the_same_picture") {
  const MadeUpState state = stretched_block();
  const TemporaryFolder folder;
  const PictureOptions options{.title = "twice",
                               .undeformed = true,
                               .loads = {{0, {-1, 0}}, {3, {0, -2}}},
                               .supports = {{1, true, true}, {2, false, true}, {4, true, false}},
                               .gauges = {{0, 3, "A", "B"}}};
  write_picture(folder.path(), "a", state.view(), options, false);
  write_picture(folder.path(), "b", state.view(), options, false);
  const bool same_png = read_file(folder / "a.png") == read_file(folder / "b.png");
  const bool same_svg = renumbered(read_file(folder / "a.svg")) == renumbered(read_file(folder / "b.svg"));
  CHECK(same_png);
  CHECK(same_svg);
}

TEST_CASE("the_largest_displacement_is_two_to_five_per_cent_of_the_size") {
  const double size_of_strain = GENERATE(1e-9, 3e-7, 4e-5, 1e-3);
  const MadeUpState state =
      made_up(hexagonal_lattice({.columns = 9, .rows = 9}), {size_of_strain, 0, 0, -0.3 * size_of_strain});
  const PictureScene scene = plan_scene(state.view(), {});
  double largest = 0, side = 0;
  for (std::size_t disc = 0; disc < state.assembly.size(); ++disc) {
    largest = std::max(largest, norm(scene.centres[disc] - state.assembly.centres[disc]));
    side = std::max({side, state.assembly.centres[disc].x, state.assembly.centres[disc].y});
  }
  CAPTURE(size_of_strain, scene.displacement_scale, largest / side, scene.caption);
  CHECK(largest / side > 0.019);
  CHECK(largest / side < 0.06);
  const double lead =
      scene.displacement_scale / std::pow(10, std::floor(std::log10(1.0001 * scene.displacement_scale)));
  CHECK((std::abs(lead - 1) < 1e-9 || std::abs(lead - 2) < 1e-9 || std::abs(lead - 5) < 1e-9));
}

TEST_CASE("what_is_not_known_is_not_drawn") {
  const Assembly assembly = hexagonal_lattice({.columns = 3, .rows = 3});
  const PictureScene scene = plan_scene({assembly}, {});
  CHECK(scene.values.empty());
  CHECK_FALSE(scene.force_chains);
  CHECK(scene.displacement_scale == 1);
  CHECK(scene.centres == assembly.centres);
  const TemporaryFolder folder;
  CHECK_NOTHROW(write_picture(folder.path(), "bare", {assembly}, {.title = "bare discs"}, false));
  CHECK(run_python("well_formed.py", {(folder / "bare.svg").string()}) == 0);
}

TEST_CASE("a_picture_that_cannot_be_drawn_is_refused") {
  const TemporaryFolder folder;
  const auto refused = [&](const AssemblyState& view, const PictureOptions& options, const char* words) {
    CHECK_THROWS_WITH(write_picture(folder.path(), "p", view, options, false), Catch::Contains(words));
  };
  const Assembly nothing;
  refused({nothing}, {}, "no disc");
  MadeUpState lost = stretched_block(3, 2);
  lost.motions[1].u.y = NAN;
  refused(lost.view(), {}, "disc 1");
  CHECK(folder.files() == 0);
}
