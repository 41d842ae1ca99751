// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [bonds] and [[bond]] of a case file.
#include <cmath>
#include <fstream>
#include <string>

#include "equidem/casefile/contact_tables.hpp"
#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/core/file.hpp"

#include "support/catch.hpp"
#include "support/refusal.hpp"
#include "support/temporary_folder.hpp"

using namespace equidem;

namespace {

const std::string discs = R"(schema = "equidem/1"
[grains]
density = 1000.0
[[grain]]
position = [0.0, 0.0]
radius = 0.1
[[grain]]
position = [0.2, 0.0]
radius = 0.1
[[grain]]
position = [0.4, 0.0]
radius = 0.1
[collisions]
restitution = 0.5
stiffness = 1e5
law = "linear_dashpot"
[run]
duration = 1.0
)";

GrainCase parsed_bonds(const std::string& more, const std::vector<std::string>& overrides = {}) {
  return parse_grain_case(discs + more, "case.toml", ".", overrides);
}

}  // namespace

TEST_CASE("bonds_take_what_they_do_not_say_from_the_common_table") {
  const GrainCase made = parsed_bonds(R"([bonds]
normal_dashpot = 20.0
tangential_dashpot = 10.0
[[bond]]
grains = [0, 1]
[[bond]]
grains = [2, 1]
normal_dashpot = 5.0
normal_spring = 3.0
)");
  REQUIRE(made.scene.bonds.size() == 2);
  const GrainBond &first = made.scene.bonds[0], &second = made.scene.bonds[1];
  CHECK((first.i == 0 && first.j == 1 && second.i == 2 && second.j == 1));
  CHECK((first.normal_dashpot == 20 && first.tangential_dashpot == 10 && first.normal_spring == 0));
  CHECK((second.normal_dashpot == 5 && second.tangential_dashpot == 10 && second.normal_spring == 3));
  CHECK(build_grain_scene(made, 1e-4).bonds.size() == 2);
  CHECK(parsed_bonds("").scene.bonds.empty());
}

TEST_CASE("dashpots_leave_the_automatic_step_to_the_contacts_and_springs_halve_their_limit") {
  const std::string bond = "[[bond]]\ngrains = [0, 1]\n";
  const double mass = 1000 * 3.141592653589793 * 0.01, dashpot = 1e7, spring = 1e12;
  const GrainTimeStep free = choose_grain_step(parsed_bonds(bond + "normal_dashpot = 1e7\n"));
  CHECK(free.bond_limit == 0);
  CHECK(free.chain_limit == Approx(2 * (mass / 2) / dashpot));
  const GrainTimeStep step = choose_grain_step(parsed_bonds(bond + "normal_spring = 1e12\n"));
  CAPTURE(step.step, step.bond_limit);
  CHECK(step.bond_limit == Approx(2 * std::sqrt(mass / 2 / spring)));
  CHECK(step.step == 0.5 * step.bond_limit);
  CHECK_THROWS_WITH(
      choose_grain_step(parsed_bonds(bond + "normal_spring = 1e12\n", {"run.time_step=2e-5"})),
      Catch::Contains("run.time_step") && Catch::Contains("the limit of") && Catch::Contains("that the bonds impose"));
}

TEST_CASE("a_file_of_bonds_ties_grains_by_number") {
  const std::string path = "equidem_test_bonds.csv";
  const std::string table = "[bonds]\nnormal_dashpot = 1.0\npath = \"" + path + "\"\n";
  const auto write = [&](const std::string& text) { std::ofstream(path) << text; };
  write("i,j,distance_drift\n0,1,0.5\n# none\n 1 , 2 ,0\n");
  const GrainCase made = parsed_bonds(table);
  REQUIRE(made.scene.bonds.size() == 2);
  CHECK((made.scene.bonds[1].i == 1 && made.scene.bonds[1].j == 2 && made.scene.bonds[1].normal_dashpot == 1));
  write("i,j,distance_drift,normal_spring,normal_dashpot\n0,1,0.5,7,3\n1,2,0,,\n");
  const GrainCase own = parsed_bonds(table);
  REQUIRE(own.scene.bonds.size() == 2);
  CHECK((own.scene.bonds[0].normal_dashpot == 3 && own.scene.bonds[0].normal_spring == 7));
  CHECK((own.scene.bonds[1].normal_dashpot == 1 && own.scene.bonds[1].normal_spring == 0));
  for (const auto& [text, said] :
       {std::pair{"i,j,normal_dashpot\n0,1,-1\n", ":2: '-1' is no normal_dashpot"},
        std::pair{"i,j,normal_dashpot\n0,1,inf\n", ":2: 'inf' is no normal_dashpot"},
        std::pair{"i,j,normal_dashpot\n0,1,0\n", ":2: the bond of grains 0 and 1 has neither dashpot"},
        std::pair{"a,b\n0,1\n", ":1: there are no columns i and j"},
        std::pair{"i,j\n0,one\n", ":2: 'one' is no number of a grain"},
        std::pair{"i,j\n0,7\n", ":2: a bond ties grain 7 (there are 3 grains"},
        std::pair{"i,j\n0,1\n1,0\n", ":3: grains 0 and 1 are bonded twice"},
        std::pair{"i,j\n2,2\n", ":2: a bond ties grain 2 to itself"}}) {
    write(text);
    CAPTURE(text);
    CHECK_THROWS_WITH(parsed_bonds(table), Catch::Contains(said));
  }
  std::remove(path.c_str());
}

TEST_CASE("strengths_by_the_length_of_a_bond_are_of_bodies_that_are_there") {
  const std::string path = "equidem_test_far_bonds.csv";
  const std::string strength = "[strength]\ntension = 4.0e6\nshear = 8.0e6\nbond_length = \"smaller_diameter\"\n";
  for (const char* far : {"3", "7", "65535", "2147483647", "2147483648", "4294967295", "9223372036854775807"}) {
    CAPTURE(far);
    std::ofstream(path) << "i,j\n0,1\n" << far << ",1\n";
    const std::string table = "[bonds]\nnormal_spring = 1.0\npath = \"" + path + "\"\n" + strength;
    CHECK_THROWS_WITH(parsed_bonds(table), Catch::Contains(std::string(":3: a bond ties grain ") + far));
  }
  CHECK_THROWS_WITH(parsed_bonds("[bonds]\nnormal_spring = 1.0\n[[bond]]\ngrains = [0, 100000000]\n" + strength),
                    Catch::Contains("a bond ties grain 100000000 (there are 3 grains"));
  std::remove(path.c_str());
}

TEST_CASE("bonds_that_a_case_cannot_mean_are_refused_with_their_line") {
  for (const auto& [text, said] :
       {std::pair{"[[bond]]\ngrains = [0, 1]\n", "the bond of grains 0 and 1 has neither dashpot"},
        std::pair{"[bonds]\nnormal_dashpot = 1.0\n", "no grains are tied"},
        std::pair{"[[bond]]\ngrains = [0, 1, 2]\nnormal_dashpot = 1.0\n", "a bond ties two"},
        std::pair{"[[bond]]\ngrains = [0, 3]\nnormal_dashpot = 1.0\n", "a bond ties grain 3 (there are 3 grains"},
        std::pair{"[[bond]]\ngrains = [1, 1]\nnormal_dashpot = 1.0\n", "a bond ties grain 1 to itself"},
        std::pair{"[[bond]]\ngrains = [0, 1]\nnormal_dashpot = -1.0\n", "-1.0 is out of range"}}) {
    CAPTURE(text);
    CHECK_THROWS_WITH(parsed_bonds(text), Catch::Contains("case.toml:") && Catch::Contains(said));
  }
  const GrainCase exact =
      parsed_bonds("[[bond]]\ngrains = [0, 1]\nnormal_dashpot = 1.0\n", {"collisions.law=exact_flow"});
  CHECK_THROWS_WITH(choose_grain_step(exact), Catch::Contains("collisions.law") && Catch::Contains("linear_dashpot"));
}

TEST_CASE("the_strength_file_of_a_calibration_gives_bonds_the_strengths_of_its_table") {
  const test::TemporaryFolder folder;
  const StrengthOptions calibrated{
      .tension = 5886.9, .shear = 6252.4, .friction = 0.5, .weibull_modulus = 8, .seed = 3};
  write_file(folder / "cs.toml", strength_file(calibrated, "a rock", "by a calibration"), true);
  const std::string bonds = "[bonds]\nnormal_spring = 1e5\n[[bond]]\ngrains = [0, 1]\n[[bond]]\ngrains = [1, 2]\n";
  const std::string table =
      "[strength]\ntension = 5886.9\nshear = 6252.4\nfriction = 0.5\nweibull_modulus = 8.0\nseed = 3\n";
  const auto read = [&](std::string start, const std::string& more) {
    return parse_grain_case(start.insert(start.find('\n') + 1, more), "case.toml", folder.path());
  };
  const GrainCase by_file = read(discs + bonds, "strength = \"cs.toml\"\n"), by_table = read(discs + bonds + table, "");
  REQUIRE(by_file.scene.strengths);
  CHECK(by_file.scene.strengths->tension == by_table.scene.strengths->tension);
  CHECK(by_file.scene.strengths->shear == by_table.scene.strengths->shear);
  CHECK(by_file.scene.strengths->friction == 0.5);
  CHECK(
      parse_grain_case(to_toml(by_file.document, folder.path()), "echo.toml", folder.path()).scene.strengths->tension ==
      by_table.scene.strengths->tension);
  // Bodies that collide touch once their bond has broken: it is never gone alone.
  write_file(folder / "cs.toml",
             "schema = \"equidem-strength/1\"\n[strength]\ntension = 1.0\nshear = 1.0\n"
             "after_breaking = \"gone\"\n",
             true);
  test::check_refused([&] { read(discs + bonds, "strength = \"cs.toml\"\n"); }, {"cs.toml:5", "after_breaking"});
}

TEST_CASE("the_contact_of_bodies_that_collide_acts_beside_their_bond_where_the_strength_states_it") {
  const std::string bonds = "[[bond]]\ngrains = [0, 1]\nnormal_spring = 1.0\n[strength]\ntension = 1.0\nshear = 1.0\n";
  CHECK(parsed_bonds(bonds + "after_breaking = \"parallel\"\n").scene.strengths->beside_contact);
  CHECK_FALSE(parsed_bonds(bonds + "after_breaking = \"frictional\"\n").scene.strengths->beside_contact);
  CHECK_FALSE(parsed_bonds(bonds).scene.strengths->beside_contact);
  CHECK_THROWS_WITH(parsed_bonds(bonds + "after_breaking = \"gone\"\n"),
                    Catch::Contains("after_breaking") && Catch::Contains("parallel"));
}
