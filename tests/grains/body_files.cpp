// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/grains/scene/grain_file.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

/// A file that is removed at the end.
class WrittenFile {
 public:
  WrittenFile(const std::string& name, const std::string& text)
      : path(std::filesystem::temp_directory_path() / ("equidem_body_files_" + name)) {
    write_file(path, text, true);
  }
  ~WrittenFile() { std::filesystem::remove(path); }
  WrittenFile(const WrittenFile&) = delete;
  WrittenFile& operator=(const WrittenFile&) = delete;

  const std::filesystem::path path;
};

}  // namespace

TEST_CASE("rows_of_a_file_become_bodies_without_a_case_file") {
  GrainShapes shapes(Body::disc);
  const WrittenFile file("grains.csv",
                         "# a comment\ngroup,y_m,x,radius,short_half_axis,discs,density\n"
                         ",2,1,0.5,,,1000\nsteel,0,0,0.5,0.25,,7800\nrods,0,5,,,0 0 0.1; 0.2 0 0.1,1000\n");
  const GrainRows rows = read_grains(file.path, {}, shapes);
  REQUIRE(rows.grains.size() == 3);
  CHECK(rows.groups == std::vector<std::string>{"grains", "steel", "rods"});
  CHECK(rows.lines == std::vector<int>{3, 4, 5});
  CHECK(rows.densities == std::vector<double>{1000, 7800, 1000});
  CHECK(rows.grains[0].position == Vec2{1, 2});
  CHECK(rows.grains[0].inertia.mass == Approx(1000 * std::numbers::pi * 0.25));
  CHECK(rows.grains[1].inertia.mass == Approx(7800 * std::numbers::pi * 0.5 * 0.25));
  CHECK(rows.grains[2].shape() == GrainShape::clump);
  CHECK(rows.grains[2].radius == Approx(0.2));
  REQUIRE(shapes.clumps().size() == 1);
  const WrittenFile plain("plain.csv", "x,y,radius\n0,0,1\n");
  CHECK(read_grains(plain.path, 1000, shapes).densities == std::vector<double>{1000});
  const WrittenFile quoted("quoted.csv",
                           "\"x_mm\";\"y_mm\";\"radius_mm\";\"discs_mm\"\n0;0,5;2;\n9;0;;\"0 0 2; 3 0 2\"\n");
  const GrainRows in_mm = read_grains(quoted.path, 1000, shapes);
  CHECK(in_mm.grains[0].position == Vec2{0, 0.5e-3});
  CHECK(in_mm.grains[0].radius == 2e-3);
  CHECK(in_mm.grains[1].radius == Approx(3.5e-3));
  const WrittenFile mixed("mixed.csv", "x_mm,y_mm,radius\n0,0,1\n");
  CHECK_THROWS_WITH(read_grains(mixed.path, 1000, shapes),
                    Catch::Contains("mixed.csv:1") && Catch::Contains("'radius'"));
  CHECK_THROWS_WITH(read_grains(plain.path, {}, shapes), Catch::Contains("plain.csv:2: the density"));
}

TEST_CASE("rows_of_a_file_become_bonds_without_a_case_file") {
  const GrainBond common{.normal_dashpot = 3, .rolling_dashpot = 4};
  const WrittenFile file("bonds.csv", "i,j,normal_dashpot,force_N\n0,1,7,9\n1,2,,9\n");
  const BondRows rows = read_bonds(file.path, common);
  REQUIRE(rows.bonds.size() == 2);
  CHECK(rows.bonds[0].normal_dashpot == 7);
  CHECK(rows.bonds[1].normal_dashpot == 3);
  CHECK(rows.bonds[1].rolling_dashpot == 4);
  CHECK((rows.bonds[1].i == 1 && rows.bonds[1].j == 2));
  CHECK(rows.places[1] == file.path.string() + ":3");
  for (const char* wrong :
       {"i,j,tensoin\n0,1,5\n", "i,j,tension_MPa\n0,1,5\n", "i,j\n-1,0\n", "i,j\n0,1.5\n", "i,j\n0,nan\n",
        "i,j\n0,99999999999999999999\n", "i,j\n0\n", "i,j,shear\n0,1,-3\n", "i,j,shear\n0,1,inf\n"}) {
    CAPTURE(wrong);
    const WrittenFile bad("bad.csv", wrong);
    CHECK_THROWS_AS(read_bonds(bad.path, common), Error);
  }
}
