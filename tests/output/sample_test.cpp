// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/run/sample_test.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "equidem/core/text.hpp"
#include "equidem/output/results.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

constexpr double sample_height = 0.2, sample_width = 0.1, side_stress = 1e5, shortening = 0.08, time_between = 1e-3;
constexpr int rows_of_test = 200;

double answer(const Results& results, const std::string& path) {
  const Result* found = find_result(results, "sample/" + path);
  CAPTURE(path);
  REQUIRE(found != nullptr);
  REQUIRE(std::holds_alternative<double>(found->value.value));
  return std::get<double>(found->value.value);
}

Wall made_plate(const std::string& name, Vec2 point, Vec2 normal, double speed = 0) {
  Wall wall{.name = name, .point = point, .normal = normal};
  if (speed != 0) wall.move_y = {.kind = Schedule::Kind::table, .times = {0, 1}, .values = {0, speed}};
  return wall;
}

GrainScene between_four_walls() {
  GrainScene scene;
  scene.walls = {made_plate("left", {0, 0}, {1, 0}), made_plate("right", {sample_width, 0}, {-1, 0}),
                 made_plate("bottom", {0, 0}, {0, 1}), made_plate("top", {0, sample_height}, {0, -1}, -1)};
  return scene;
}

/// The history of a sample whose side stress stays: its axial stress is a function of the strain, and its sample_width
/// grows with 1
/// + D.
std::string history_of(const std::function<double(double)>& axial_stress, double dilation, bool sides) {
  std::string text =
      "step,time_s,wall_left_x_m,wall_right_x_m,wall_bottom_y_m,wall_top_y_m,wall_left_impulse_x_N_s_per_m,"
      "wall_right_impulse_x_N_s_per_m,wall_bottom_impulse_y_N_s_per_m,wall_top_impulse_y_N_s_per_m\n";
  double axial = 0, lateral = 0, last_h = sample_height, last_w = sample_width;
  for (int k = 0; k <= rows_of_test; ++k) {
    const double strain = shortening * k / rows_of_test;
    const double h = sample_height * std::exp(-strain),
                 w = sides ? sample_width * std::exp(strain * (1 + dilation)) : sample_width;
    if (k > 0) {
      const double h_mid = (h + last_h) / 2, w_mid = (w + last_w) / 2;
      axial += time_between * w_mid * axial_stress(std::log(sample_height / h_mid));
      lateral += time_between * h_mid * side_stress;
    }
    text += fmt::format("{},{},0,{},0,{},{},{},{},{}\n", k, k * time_between, w, h, -lateral, lateral, -axial, axial);
    last_h = h, last_w = w;
  }
  return text;
}

double stress_at(double angle) {
  return side_stress * (1 + std::sin(angle)) / (1 - std::sin(angle));
}

}  // namespace

TEST_CASE("a_biaxial_test_reads_the_angles_and_the_stiffness_of_its_law") {
  struct Law {
    double peak_degrees, residual_degrees, dilatancy_degrees, peak_strain;
  };
  for (const Law& law : {Law{40, 30, 12, 0.02}, Law{35, 33, 0, 0.03}, Law{28, 20, -5, 0.01}}) {
    CAPTURE(law.peak_degrees);
    const double degree = std::numbers::pi / 180, sine = std::sin(law.dilatancy_degrees * degree);
    const double peak = stress_at(law.peak_degrees * degree), end = stress_at(law.residual_degrees * degree);
    constexpr double soft = 0.02;  // of strain, from the peak to the residual stress
    const auto stress = [&](double strain) {
      if (strain < law.peak_strain) return side_stress + (peak - side_stress) * strain / law.peak_strain;
      return peak + (end - peak) * std::min(1.0, (strain - law.peak_strain) / soft);
    };
    const GrainScene scene = between_four_walls();
    const double solid = 0.8 * sample_width * sample_height;
    const auto test = SampleTest::read(history_of(stress, 2 * sine / (1 - sine), true),
                                       {.stages = {{0, &scene}}, .solid_area = solid});
    REQUIRE(test);
    const Results read = test->results();
    CAPTURE(read.report());
    // means over 3 rows on either side lower a corner by less than the stress changes over them
    const double spacing = shortening / rows_of_test, lowered = 3 * spacing / law.peak_strain * (peak - side_stress);
    const double lowest = std::asin((peak - lowered - side_stress) / (peak - lowered + side_stress));
    CHECK(answer(read, "friction_angle/peak") <= law.peak_degrees * degree * (1 + 1e-9));
    CHECK(answer(read, "friction_angle/peak") >= lowest);
    CHECK(answer(read, "friction_angle/residual") == Approx(law.residual_degrees * degree).epsilon(1e-6));
    CHECK(std::abs(answer(read, "dilatancy_angle") - law.dilatancy_degrees * degree) < 1e-6);
    CHECK(answer(read, "peak_strain") == Approx(law.peak_strain).epsilon(3 * spacing / law.peak_strain));
    // of the lowered peak the first row is half an interval from the start of the line, which the secant leaves out
    CHECK(answer(read, "secant_modulus") ==
          Approx((peak - side_stress) / law.peak_strain).epsilon(3 * spacing / law.peak_strain));
    CHECK(answer(read, "void_ratio/start") == Approx(0.25).epsilon(0.01));
    CHECK(answer(read, "volume_strain") ==
          Approx(shortening * 2 * sine / (1 - sine)).epsilon(0.01).margin(spacing * spacing));
    CHECK(test->plots("").size() == 3);
  }
}

TEST_CASE("a_stress_that_still_grows_is_no_strength") {
  const GrainScene scene = between_four_walls();
  GrainScene plates;
  plates.walls = {scene.walls[2], scene.walls[3]};
  std::vector<Grain> block, disc;
  for (int column = 0; column < 10; ++column)
    for (int row = 0; row < 20; ++row)
      block.push_back({.position = {0.005 + 0.01 * column, 0.005 + 0.01 * row}, .radius = 0.005, .inertia = {}});
  for (const Grain& grain : block)
    if (norm(grain.position - Vec2{0.05, 0.05}) < 0.046) disc.push_back(grain);
  const auto falls = [](double strain) { return 1e6 * (strain < 0.05 ? strain / 0.05 : 0.2); };
  const auto grows = [](double strain) { return 1e6 * strain / 0.05; };
  for (const bool fallen : {true, false}) {
    const std::string history = history_of(fallen ? std::function<double(double)>(falls) : grows, 0, false);
    const auto read = [&](const std::vector<Grain>& discs) {
      const auto test = SampleTest::read(history, {.stages = {{0, &plates}}, .discs = discs, .bonded = true});
      REQUIRE(test);
      return test->results();
    };
    const Results of_block = read(block), of_disc = read(disc);
    CAPTURE(of_block.report());
    CAPTURE(of_disc.report());
    const double spacing = shortening / rows_of_test, most = fallen ? 1e6 : 1e6 * shortening / 0.05;
    CHECK(answer(of_block, "strength") == Approx(most).epsilon(spacing / 0.05));
    // the force of the history is that of the section of the block
    double low = INFINITY, high = -INFINITY;
    for (const Grain& grain : disc)
      low = std::min(low, grain.position.x - grain.radius), high = std::max(high, grain.position.x + grain.radius);
    CHECK(answer(of_disc, "strength") ==
          Approx(2 * sample_width / (std::numbers::pi * (high - low)) * answer(of_block, "strength")));
    CHECK((of_block.report().find("so far at most") == std::string::npos) == fallen);
    CHECK((of_disc.report().find("this is no tensile strength") != std::string::npos) == !fallen);
    CHECK(std::get<bool>(find_result(of_block, "sample/load_has_fallen")->value.value) == fallen);
  }
}

TEST_CASE("simple_shear_of_a_cell_reads_friction_from_its_principal_stresses") {
  GrainScene scene;
  scene.cell = PeriodicCell{.width = 1, .height = 1, .rate_xy = {.value = 1}};
  constexpr double ratio = 0.4, dilation = 0.1;
  std::string text =
      "step,time_s,cell_strain_xx,cell_strain_yy,cell_strain_xy,cell_stress_xx_Pa,cell_stress_xy_Pa,cell_stress_yx_Pa,"
      "cell_stress_yy_Pa,cell_void_ratio,cell_coordination_number\n";
  for (int k = 0; k <= rows_of_test; ++k) {
    const double shear = 0.5 * k / rows_of_test, mobilized = ratio * std::min(1.0, shear / 0.1);
    text += fmt::format("{},{},0,{},{},-1e5,{},{},-1e5,0.25,3.5\n", k, k * time_between, dilation * shear, shear,
                        mobilized * 1e5, mobilized * 1e5);
  }
  const auto test = SampleTest::read(text, {.stages = {{0, &scene}}});
  REQUIRE(test);
  const Results read = test->results();
  CAPTURE(read.report());
  CHECK(answer(read, "friction_angle/residual") == Approx(std::asin(ratio)));
  CHECK(answer(read, "friction_coefficient/residual") == Approx(ratio));
  CHECK(answer(read, "dilatancy_angle") == Approx(std::atan(dilation)));
  CHECK(answer(read, "coordination_number") == 3.5);
  CHECK(test->plots("").size() == 4);
}

TEST_CASE("a_scene_that_loads_no_sample_has_no_test") {
  GrainScene still = between_four_walls(), shaken = between_four_walls(), divided = between_four_walls(), floor;
  divided.walls.push_back({.shape = Wall::Shape::segment, .name = "shelf", .point = {0.05, 0.1}, .end = {0.1, 0.1}});
  still.walls[3].move_y = {};
  const Schedule sway{.kind = Schedule::Kind::sine, .value = 0.01, .frequency = 5};
  for (Wall& wall : shaken.walls) wall.move_x = sway, wall.move_y = {};
  floor.walls = {between_four_walls().walls[2]};
  const GrainScene pressed = between_four_walls();
  for (const GrainScene* scene : {&still, &shaken, &divided, &floor})
    CHECK_FALSE(SampleTest::loads({.stages = {{0, scene}}}));
  CHECK(SampleTest::loads({.stages = {{0, &still}, {1, &pressed}}}));
  const auto stress = [](double) { return side_stress; };
  CHECK_FALSE(SampleTest::read(history_of(stress, 0, true), {.stages = {{INFINITY, &pressed}}}));
}
