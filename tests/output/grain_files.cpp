// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Discs, ellipses and clumps in tables, frames and pictures.
#include <cmath>
#include <iterator>
#include <numbers>
#include <regex>
#include <string>
#include <vector>

#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/scene/grain_file.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"
#include "equidem/output/files/body_tables.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/frames.hpp"
#include "equidem/output/files/histories.hpp"
#include "equidem/output/pictures/grain_picture.hpp"

#include "output/png.hpp"
#include "output/poly_data_reader.hpp"
#include "output/runs.hpp"
#include "output/states.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using equidem::test::refusal_of;

namespace {

std::vector<Grain> grains_at(std::int64_t step, std::size_t count) {
  std::vector<Grain> grains;
  const auto motions = motions_at(step, count), velocities = velocities_at(step, count);
  for (std::size_t g = 0; g < count; ++g) {
    grains.push_back({.position = motions[g].u + Vec2{static_cast<double>(g), 0},
                      .radius = 0.1 + 0.01 * static_cast<double>(g),
                      .inertia = {2, 3},
                      .velocity = velocities[g].u,
                      .spin = velocities[g].theta,
                      .angle = motions[g].theta,
                      .kind = static_cast<int>(g % 2)});
  }
  return grains;
}

}  // namespace

TEST_CASE("frames_of_travelling_bodies_hold_their_places") {
  const TemporaryFolder folder;
  Assembly assembly;
  for (const Grain& grain : grains_at(0, 3)) {
    assembly.centres.push_back(grain.position);
    assembly.radii.push_back(grain.radius);
  }
  FileMark mark;
  {
    FrameWriter writer(folder.path(), "frames", assembly, {.travelling = true});
    for (std::int64_t step : {0, 4, 9})
      writer.append(step, time_at(step), motions_at(step, 3), velocities_at(step, 3), {}, step < 9);
    mark = writer.mark();
    writer.finish();
  }
  const auto frames = frames_of(folder / "frames.pvd");
  REQUIRE(frames.size() == 3);
  auto discs = arrays_of(frames[1].discs);
  const auto motions = motions_at(4, 3), velocities = velocities_at(4, 3);
  for (std::size_t g = 0; g < 3; ++g) {
    CHECK(discs["Points"][3 * g] == motions[g].u.x);
    CHECK(discs["Points"][3 * g + 1] == motions[g].u.y);
    CHECK(discs["angle"][g] == motions[g].theta);
    CHECK(discs["velocity"][3 * g] == velocities[g].u.x);
    CHECK(discs["spin"][g] == velocities[g].theta);
  }
  CHECK(discs.count("displacement") + discs.count("rotation") == 0);
  const FrameWriter again(folder.path(), "frames", assembly, {.travelling = true, .continue_from = mark});
  CHECK(again.frames() == 2);
}

TEST_CASE("a_table_of_bonds_is_read_back_to_the_same_bits") {
  const TemporaryFolder folder;
  const std::vector<GrainBond> bonds{{0, 3, 1.0 / 3, 1e-300, 0.1, 7e8 / 11, 2.0 / 7}, {5, 2, 0, 4, 0, 0, 0}};
  const ContactStrengths strengths{{1.0 / 3, 2e-7}, {0.1, 7e5 / 11}, 0.5};
  for (const bool strong : {false, true}) {
    write_bond_csv(folder / "bonds.csv", bonds, strong ? strengths : ContactStrengths(), true);
    const BondRows found = read_bonds(folder / "bonds.csv", {.normal_dashpot = 9, .rolling_dashpot = 9});
    REQUIRE(found.bonds.size() == bonds.size());
    for (std::size_t b = 0; b < bonds.size(); ++b) {
      CHECK((found.bonds[b].i == bonds[b].i && found.bonds[b].j == bonds[b].j));
      for (const BondProperty& property : bond_properties()) {
        CAPTURE(b, property.name);
        CHECK(found.bonds[b].*property.value == bonds[b].*property.value);
      }
      CHECK(found.strengths[b].given() == strong);
      if (!strong) continue;
      CHECK(found.strengths[b].tension == strengths.tension[b]);
      CHECK(found.strengths[b].shear == strengths.shear[b]);
    }
  }
}

TEST_CASE("a_growing_table_goes_on_where_the_run_is") {
  const TemporaryFolder folder;
  const auto path = folder / "history.csv";
  const std::vector<std::string> columns{"step", "time_s", "x_m"};
  FileMark mark;
  {
    GrowingCsv table(path, columns, {});
    for (std::int64_t step : {0, 3, 6}) table.add(step, {time_at(step), 0.5}, step < 6);
    mark = table.mark();
  }
  const std::string whole = read_file(path);
  CHECK(whole == "step,time_s,x_m\n0,0,0.5\n3,3.0000000000000004e-05,0.5\n6,6.000000000000001e-05,0.5\n");
  write_file(path, whole + "9,1", true);  // cut short
  {
    GrowingCsv table(path, columns, {.continue_from = mark});
    CHECK(table.last_step() == 3);
    table.add(6, {time_at(6), 0.5});
  }
  CHECK(read_file(path) == whole);
  CHECK(refusal_of([&] { GrowingCsv(path, columns, {}); }).says("history.csv"));
  CHECK(refusal_of([&] { GrowingCsv(path, {"step", "y_m"}, {.continue_from = mark}); }).says("its columns are"));
}

TEST_CASE("tables_of_grains_and_contacts_have_a_row_for_each") {
  const TemporaryFolder folder;
  const auto grains = grains_at(1, 2);
  const std::vector<double> densities{2500, 7800};
  const std::vector<std::string> groups{"sand", "steel"};
  write_grain_csv(folder / "grains.csv", {grains, {}, groups, densities}, false);
  const std::string table = read_file(folder / "grains.csv");
  CHECK(table.starts_with("grain,group,x_m,y_m,radius_m,vx_m_per_s,vy_m_per_s,spin_rad_per_s,angle_rad,"));
  CHECK(table.find("\n1,steel,") != std::string::npos);
  CHECK(table.ends_with(",7800\n"));
  Wall floor;
  floor.name = "floor";
  const std::vector<Wall> walls{floor};
  std::vector<GrainContact> contacts(2);
  contacts[0].j = 1;
  contacts[0].normal_force = 3.5;
  contacts[1].j = ~0;
  contacts[1].steps = 12;
  for (const Body body : {Body::disc, Body::sphere}) {
    write_grain_contact_csv(folder / "contacts.csv", contacts, walls, body, true);
    const std::string rows = read_file(folder / "contacts.csv");
    CAPTURE(rows);
    CHECK((rows.find("normal_force_N_per_m,") != std::string::npos) == (body == Body::disc));
    CHECK(rows.find("\n0,1,,0,0,0,0,3.5,") != std::string::npos);
    CHECK(rows.find("\n0,,floor,0,") != std::string::npos);
    CHECK(rows.ends_with(",12\n"));
  }
}

TEST_CASE("a_table_of_energies_holds_every_term_and_what_the_balance_lacks") {
  const TemporaryFolder folder;
  EnergyLedger ledger;
  double next = 1;
  for (const EnergyTerm& term : energy_terms(BodyFamily::colliding)) ledger.*term.value = 1 / (next += 1.5);
  const std::vector<EnergySample> samples{{0, 0.0, {}}, {8, 0.5, ledger}};
  write_energy_csv(folder / "energy.csv", samples, BodyFamily::colliding, Body::sphere, false);
  const std::string rows = read_file(folder / "energy.csv");
  CAPTURE(rows);
  CHECK(rows.starts_with("step,time_s,kinetic_J,"));
  CHECK(rows.find(",lost_slip_J,") != std::string::npos);
  CHECK(rows.find("\n8,0.5,") != std::string::npos);
  CHECK(std::stod(rows.substr(rows.rfind(',') + 1)) == ledger.error());
}

TEST_CASE("a_picture_of_grains_shows_walls_paths_and_title") {
  const TemporaryFolder folder;
  const auto grains = grains_at(1, 3);
  std::vector<Wall> walls(3);
  walls[0].point = {0, -0.2};
  walls[1].shape = Wall::Shape::segment;
  walls[1].point = {3, 0};
  walls[1].end = {3, 2};
  walls[2].shape = Wall::Shape::segment;
  walls[2].end = {1.5, 4};
  std::vector<std::vector<Vec2>> paths;
  for (int k = 0; k < 20; ++k) paths.emplace_back(3, Vec2{0.1 * k, 0.01 * k * k});
  const std::vector<int> groups{0, 1, 17};
  GrainPicture picture{.title = "Walls & paths", .time = 0.5, .grains = grains};
  const auto strokes_of = [&](const char* name) {
    write_grain_picture(folder.path(), name, picture, false);
    CHECK(read_file(folder.path() / (std::string(name) + ".png")).starts_with("\x89PNG"));
    const std::string svg = read_file(folder.path() / (std::string(name) + ".svg"));
    std::size_t strokes = 0;
    for (std::size_t at = svg.find("<path"); at != std::string::npos; at = svg.find("<path", at + 1)) ++strokes;
    return strokes;
  };
  picture.groups = groups;
  const std::size_t bare = strokes_of("bare");
  picture.walls = walls;
  const std::size_t with_walls = strokes_of("walls");
  picture.paths = paths;
  CHECK(with_walls > bare);
  CHECK(strokes_of("paths") > with_walls);
  CHECK(refusal_of([&] { write_grain_picture(folder.path(), "none", {}, false); }).says("no grains"));
  auto lost = grains;
  lost[1].position.x = NAN;
  picture = {.grains = lost};
  CHECK(refusal_of([&] { write_grain_picture(folder.path(), "lost", picture, false); }).says("grain 1"));
}

TEST_CASE("a_picture_of_a_periodic_cell_shows_the_images_that_reach_into_it") {
  const TemporaryFolder folder;
  const auto fills = [&](const std::string& name, const GrainPicture& picture) {
    write_grain_picture(folder.path(), name, picture, false);
    const std::string svg = read_file(folder.path() / (name + ".svg"));
    std::ptrdiff_t found = 0;
    for (std::size_t at = 0; (at = svg.find("fill-rule", at)) != std::string::npos; ++at) ++found;
    return found;
  };
  constexpr double shift = 0.3;
  const PeriodicCell upright{.width = 1, .height = 1}, slanted{.width = 1, .height = 1, .shift = shift};
  const PeriodicCell between_walls{.along = PeriodicCell::Along::x, .width = 1};
  struct Place {
    const char* name;
    PeriodicCell cell;
    Vec2 centre;
    std::ptrdiff_t images;
  };
  // the slanted cell is about the same centre, so that its lower left corner is at (-shift/2, 0)
  const Place places[] = {{"inside", upright, {0.5, 0.5}, 0},        {"left", upright, {0.05, 0.5}, 1},
                          {"top", upright, {0.5, 0.97}, 1},          {"corner", upright, {0.02, 0.03}, 3},
                          {"slanted", slanted, {0.5, 0.5}, 0},       {"slanted_left", slanted, {0.02, 0.5}, 1},
                          {"slanted_foot", slanted, {0.5, 0.05}, 1}, {"slanted_corner", slanted, {-0.5 * shift, 0}, 3},
                          {"x_inside", between_walls, {0.5, 5}, 0},  {"x_side", between_walls, {0.97, 5}, 1}};
  for (const Place& place : places) {
    CAPTURE(place.name);
    const std::vector<Grain> disc{{.position = place.centre, .radius = 0.1, .inertia = {}}};
    const std::string name = place.name;
    const std::ptrdiff_t alone = fills(name + "_alone", {.grains = disc});
    CHECK(alone > 0);
    CHECK(fills(name, {.grains = disc, .cell = place.cell}) == (1 + place.images) * alone);
  }
}

TEST_CASE("a_picture_of_an_open_scene_leaves_out_what_has_fallen_far_below_it") {
  const TemporaryFolder folder;
  const auto started = grains_at(0, 4);
  auto fallen = started;
  fallen[3].position.y -= 1000;
  std::vector<Wall> shelf(1);
  shelf[0].shape = Wall::Shape::segment;
  shelf[0].point = {0, -2};
  shelf[0].end = {4, -2};
  const std::vector<GrainBond> bonds{{.i = 1, .j = 2}, {.i = 2, .j = 3}};
  GrainPicture picture{.grains = fallen, .bonds = bonds, .walls = shelf, .started = started};
  struct Drawn {
    std::uint32_t height;     // of the PNG, whose width is that of all
    std::ptrdiff_t elements;  // of the SVG that are filled, but letters
  };
  const auto drawn = [&](const char* name) {
    write_grain_picture(folder.path(), name, picture, false);
    const std::string svg = read_file(folder.path() / (std::string(name) + ".svg"));
    std::ptrdiff_t elements = 0;
    for (std::size_t at = 0; (at = svg.find("fill-rule", at)) != std::string::npos; ++at) ++elements;
    return Drawn{big_endian(read_file(folder.path() / (std::string(name) + ".png")), 20), elements};
  };
  const Drawn near = drawn("near");
  const std::vector<Grain> rest(fallen.begin(), fallen.end() - 1);
  picture.grains = rest;
  picture.bonds = std::span(bonds).first(1);
  const Drawn without = drawn("without");
  CAPTURE(near.height, near.elements, without.height, without.elements);
  CHECK(near.elements > 0);
  CHECK(near.height == without.height);
  CHECK(near.elements == without.elements);
  // Beside lines alone nothing is out of the scene, paths show where a grain went, and something is always shown.
  picture.grains = fallen;
  picture.bonds = bonds;
  const auto check_whole = [&](const char* name) {
    const Drawn whole = drawn(name);
    CAPTURE(name, whole.height, whole.elements);
    CHECK(whole.height > 1.5 * near.height);
    CHECK(whole.elements > near.elements);
  };
  shelf[0].shape = Wall::Shape::line;
  check_whole("lines");
  shelf[0].shape = Wall::Shape::segment;
  const std::vector<std::vector<Vec2>> paths(2, std::vector<Vec2>(4, Vec2{0, 0}));
  picture.paths = paths;
  check_whole("paths");
  picture.paths = {};
  for (Grain& grain : fallen) grain.position.y = -1000;
  check_whole("all");
}

namespace {

/// A disc, an ellipse, two clumps of one shape and one of another, moving.
struct SampleBodies {
  GrainShapes shapes{Body::disc};
  std::vector<Grain> grains;
  std::vector<std::string> groups;
  std::vector<double> densities;

  SampleBodies() {
    const std::vector<Clump::Disc> pair{{{1, 2}, 0.1}, {{1.15, 2.01}, 0.12}};
    for (int k = 0; k < 5; ++k) {
      Grain& grain = grains.emplace_back();
      grain.position = {1.0 / 3 + k, 0.7 + 0.1 * k};
      grain.velocity = {0.1 * k, -1.0 / 7};
      grain.angle = 0.3 + 1.1 * k;
      grain.spin = 2.5 - k;
      densities.push_back(1000 + 100.0 * k);
      groups.emplace_back(k % 2 == 0 ? "a" : "b");
      if (k == 0) shapes.make_disc(grain, 0.2, densities[0]);
      if (k == 1) shapes.make_ellipse(grain, 0.3, 0.1, densities[1]);
      if (k == 2 || k == 3) shapes.make_clump(grain, pair, densities.back());
      if (k == 4) shapes.make_clump(grain, {{{0, 0}, 0.1}, {{0.1, 0}, 0.1}, {{0.05, 0.1}, 0.1}}, densities[4]);
    }
  }
  [[nodiscard]] WrittenGrains rows() const { return {grains, shapes.clumps(), groups, densities}; }
};

}  // namespace

TEST_CASE("a_table_of_grains_is_read_back_to_the_same_bits") {
  const TemporaryFolder folder;
  const SampleBodies bodies;
  write_grain_csv(folder / "grains.csv", bodies.rows(), false);
  CAPTURE(read_file(folder / "grains.csv"));
  const GrainCase found = parse_grain_case(
      "schema = \"equidem/1\"\n[grains]\npath = \"grains.csv\"\n[collisions]\nrestitution = 0.5\nstiffness = 1e6\n"
      "[run]\nduration = 1.0\n",
      "case.toml", folder.path());
  REQUIRE(found.scene.grains.size() == bodies.grains.size());
  CHECK(found.scene.clumps.size() == 2);
  for (std::size_t g = 0; g < bodies.grains.size(); ++g) {
    CAPTURE(g);
    const Grain &a = bodies.grains[g], &b = found.scene.grains[g];
    CHECK(b.shape() == a.shape());
    CHECK(b.position == a.position);
    CHECK(b.velocity == a.velocity);
    CHECK(b.angle == a.angle);
    CHECK(b.spin == a.spin);
    CHECK(b.radius == a.radius);
    CHECK(b.short_half_axis == a.short_half_axis);
    CHECK(b.inertia.mass == a.inertia.mass);
    CHECK(b.inertia.moment == a.inertia.moment);
    CHECK(found.densities[g] == bodies.densities[g]);
    if (a.shape() != GrainShape::clump) continue;
    const auto &wanted = bodies.shapes.clumps()[static_cast<std::size_t>(a.clump)].discs,
               &discs = found.scene.clumps[static_cast<std::size_t>(b.clump)].discs;
    REQUIRE(discs.size() == wanted.size());
    for (std::size_t d = 0; d < discs.size(); ++d) {
      CHECK(discs[d].offset == wanted[d].offset);
      CHECK(discs[d].radius == wanted[d].radius);
    }
  }
}

TEST_CASE("frames_show_clumps_as_their_discs_and_ellipses_with_both_half_axes") {
  const TemporaryFolder folder;
  SampleBodies bodies;
  const auto& clumps = bodies.shapes.clumps();
  FileMark mark;
  {
    FrameOptions options;
    const Assembly discs = discs_of_frames(bodies.grains, clumps, false, options);
    FrameWriter frames(folder.path(), "frames", discs, options);
    std::vector<DiscMotion> motions, velocities;
    for (const Grain& grain : bodies.grains) {
      motions.push_back({grain.position, grain.angle});
      velocities.push_back({grain.velocity, grain.spin});
    }
    frames.append(0, 0.0, motions, velocities, {});
    for (std::size_t g = 0; g < motions.size(); ++g) motions[g].theta = bodies.grains[g].angle += 0.5;
    frames.append(7, 0.5, motions, velocities, {});
    mark = frames.mark();
    frames.finish();
  }
  auto discs = arrays_of(frames_of(folder / "frames.pvd").back().discs);
  CHECK(discs["body"] == std::vector<double>{0, 1, 2, 2, 3, 3, 4, 4, 4});
  const auto &radius = discs["radius"], &axis = discs["short_half_axis"];
  CHECK(radius[1] == 0.3);
  CHECK(axis[1] == 0.1);
  CHECK(axis[0] == radius[0]);
  CHECK(axis[3] == radius[3]);
  const auto &position = discs["Points"], &velocity = discs["velocity"], &angle = discs["angle"];
  // The second disc of the third body in the second frame: place by the rotation matrix, velocity by differences.
  const Grain& grain = bodies.grains[2];
  const Vec2 offset = clumps[0].discs[1].offset;
  const auto place = [&](double turn) {
    const double c = std::cos(grain.angle + turn), s = std::sin(grain.angle + turn);
    return grain.position + Vec2{c * offset.x - s * offset.y, s * offset.x + c * offset.y};
  };
  const std::size_t at = 3;
  CHECK(position[3 * at] == Approx(place(0).x).epsilon(1e-14));
  CHECK(position[3 * at + 1] == Approx(place(0).y).epsilon(1e-14));
  CHECK(angle[at] == grain.angle);
  const double dt = 1e-6;
  const Vec2 difference = (place(grain.spin * dt) - place(-grain.spin * dt)) / (2 * dt) + grain.velocity;
  CHECK(velocity[3 * at] == Approx(difference.x).epsilon(1e-8));
  CHECK(velocity[3 * at + 1] == Approx(difference.y).epsilon(1e-8));
  // Frames of other shapes cannot be continued.
  SampleBodies other;
  other.grains[1].short_half_axis = 0.11;
  CHECK(equidem::test::refusal_of([&] {
          FrameOptions options{.continue_from = mark};
          const Assembly start = discs_of_frames(other.grains, clumps, false, options);
          FrameWriter(folder.path(), "frames", start, options);
        }).says("discs or frame_contacts are others"));
}

TEST_CASE("pictures_of_clumps_and_ellipses_are_written") {
  const TemporaryFolder folder;
  const SampleBodies bodies;
  write_grain_picture(folder.path(), "shapes", {.grains = bodies.grains, .clumps = bodies.shapes.clumps()}, false);
  const std::string picture = read_file(folder / "shapes.svg");
  CHECK(picture.find("matrix") == std::string::npos);  // no transformation that changes the width of lines
  // one tie to each disc of a clump; no other line has its width
  const std::regex tie("stroke-width[:=]\"?2[;\"]");
  CHECK(std::distance(std::sregex_iterator(picture.begin(), picture.end(), tie), {}) == 2 + 2 + 3);
}
