// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Packings of other programs become assemblies. The files of data/packings were written by LAMMPS (in.packing,
/// in.bonds) and YADE (pack_yade.py).
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "equidem/assembly/files.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

#include "support/catch.hpp"
#include "support/refusal.hpp"
#include "support/temporary_folder.hpp"

using namespace equidem;
using equidem::test::TemporaryFolder;
namespace fs = std::filesystem;

namespace {

fs::path packing(const char* name) {
  return fs::path(EQUIDEM_SOURCE_DIR) / "data/packings" / name;
}

using Pair = std::tuple<std::int32_t, std::int32_t, std::int32_t, std::int32_t>;
/// Each contact from its lower disc.
std::set<Pair> pairs_of(const Assembly& assembly) {
  std::set<Pair> pairs;
  for (const Contact& c : assembly.contacts) {
    const bool ascends = std::tuple(c.i, 0, 0) <= std::tuple(c.j, c.shift_x, c.shift_y);
    pairs.insert(ascends ? Pair{c.i, c.j, c.shift_x, c.shift_y} : Pair{c.j, c.i, -c.shift_x, -c.shift_y});
  }
  return pairs;
}

Assembly read_packing(const std::string& text, const AssemblyFileOptions& options = {.unit_of_length = "m"}) {
  const TemporaryFolder folder;
  write_file(folder / "a.txt", text, false);
  return read_assembly(folder / "a.txt", options);
}

std::string refused_packing(const std::string& text, const AssemblyFileOptions& options = {.unit_of_length = "m"}) {
  try {
    read_packing(text, options);
    return "(accepted)";
  } catch (const Error& error) {
    CHECK(error.kind() == ErrorKind::bad_input);
    return error.what();
  }
}

void check_words(const std::string& sentence, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    CAPTURE(sentence, word);
    CHECK(sentence.find(word) != std::string::npos);
  }
}

std::string without_line(const std::string& text, const std::string& beginning) {
  const std::size_t begin = text.find("\n" + beginning) + 1, end = text.find('\n', begin) + 1;
  return text.substr(0, begin) + text.substr(end);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

}  // namespace

TEST_CASE("a_dump_and_a_data_file_of_lammps_are_the_same_periodic_packing") {
  const Assembly dump = read_assembly(packing("packing.dump"));  // it says its units and its boundaries
  const Assembly data = read_assembly(packing("packing.data"), {.unit_of_length = "m", .periodic_box = true});
  REQUIRE(dump.size() == 36);
  REQUIRE(data.size() == 36);
  CHECK(*dump.period == Vec2{0.06, 0.06});
  CHECK(*data.period == *dump.period);
  double off = 0;
  for (std::size_t d = 0; d < 36; ++d) {
    off = std::max(off, norm(dump.centres[d] - data.centres[d]));
    CHECK(data.radii[d] == Approx(dump.radii[d]).epsilon(1e-12));
  }
  CHECK(off < 1e-12);
  CHECK(pairs_of(dump) == pairs_of(data));
  CHECK(dump.solid_fraction() == Approx(36 * 3.14159265 * (0.0056 * 0.0056 + 0.0048 * 0.0048) / 2 / 0.0036));
}

TEST_CASE("a_sample_in_another_plane_is_the_same_as_in_the_plane_x_y") {
  const std::string dump = read_file(packing("packing.dump"));
  const Assembly flat = read_packing(dump, {.frame = 0});
  // bounds of y are as those of x, so that exchanging two lines exchanges two axes
  const std::string x = "0.0000000000000000e+00 5.9999999999999998e-02\n",
                    z = "-5.0000000000000001e-03 5.0000000000000001e-03\n";
  const std::string along_xz = replaced(replaced(dump, x + x + z, x + z + x), "x y z radius", "x z y radius");
  const std::string along_yz = replaced(replaced(dump, x + x + z, z + x + x), "x y z radius", "y z x radius");
  for (const auto& [text, plane] : {std::pair(along_xz, SamplePlane::xz), std::pair(along_yz, SamplePlane::yz)}) {
    CAPTURE(to_string(plane));
    const Assembly turned = read_packing(text, {.frame = 0, .plane = plane});
    CHECK(turned.centres == flat.centres);
    CHECK(turned.radii == flat.radii);
    CHECK(turned.period == flat.period);
    CHECK(pairs_of(turned) == pairs_of(flat));
    const SamplePlane other = plane == SamplePlane::xz ? SamplePlane::yz : SamplePlane::xz;
    check_words(refused_packing(text, {.frame = 0}), {"plane " + to_string(plane), "assembly.plane"});
    check_words(refused_packing(text, {.frame = 0, .plane = other}), {"does not lie in the plane " + to_string(other)});
  }
}

TEST_CASE("contacts_that_lammps_lists_are_those_of_discs_that_touch") {
  const Assembly found = read_assembly(packing("packing.dump"));
  const Assembly listed = read_assembly(packing("packing.dump"), {.contacts = packing("contacts.dump")});
  CHECK(pairs_of(found) == pairs_of(listed));
  CHECK(listed.contacts.size() == 76);
  CHECK_FALSE(listed.gap_tolerance);
  for (const Assembly& assembly : {found, listed}) {
    for (const Contact& c : assembly.contacts) {
      CHECK(c.lever_i / c.lever_j == Approx(assembly.radii[c.i] / assembly.radii[c.j]));
      CHECK(c.lever_i + c.lever_j == Approx(norm(assembly.branch(c))));
    }
  }
}

TEST_CASE("the_last_frame_of_a_dump_is_read_unless_another_is_named") {
  const Assembly last = read_assembly(packing("packing.dump")),
                 named = read_assembly(packing("packing.dump"), {.frame = 20000}),
                 first = read_assembly(packing("packing.dump"), {.frame = 0});
  CHECK(last.centres == named.centres);
  CHECK(norm(first.centres[0] - last.centres[0]) > 1e-4);
  const std::string text = read_file(packing("packing.dump"));
  check_words(refused_packing(text, {.frame = 7}),
              {"no frame of time step 7", "0, 5000, 10000, 15000, 20000", "assembly.frame"});
  // A frame that was cut off is found out; the frames before it can be read.
  const std::string half = text.substr(0, text.size() - 300);
  check_words(refused_packing(half, {}), {"time step 20000", "of 36", "cut off", "assembly.frame"});
  CHECK(read_packing(half, {.frame = 15000}).size() == 36);
}

TEST_CASE("bonds_of_a_data_file_are_contacts_at_the_middle_of_the_line_of_centres") {
  const Assembly patch = read_assembly(packing("bonds.data"), {.periodic_box = false});
  CHECK(patch.size() == 12);
  CHECK(patch.contacts.size() == 23);
  CHECK_FALSE(patch.period);
  for (const Contact& c : patch.contacts) CHECK(c.lever_i == c.lever_j);
  CHECK(patch.groups.contains("left"));
  const std::string text = read_file(packing("bonds.data"));
  check_words(refused_packing(text, {.gap_tolerance = 0.1, .periodic_box = false}),
              {"gives contacts", "gap_tolerance"});
  check_words(refused_packing(text, {}), {"does not say whether its box is periodic", "assembly.periodic_box"});
}

TEST_CASE("a_text_export_of_yade_is_read_with_its_contacts") {
  const AssemblyFileOptions listed{.unit_of_length = "m", .contacts = packing("settled_contacts.txt")};
  const Assembly a = read_assembly(packing("settled.txt"), listed),
                 b = read_assembly(packing("settled_ids.txt"), listed);
  CHECK(a.size() == 25);
  CHECK(a.contacts.size() == 29);
  CHECK(pairs_of(a) == pairs_of(b));
  const GapRange gaps = gaps_at_contacts(a);
  CHECK(gaps.largest < 1e-4);
  CHECK(gaps.smallest > -1e-2);
  // Six digits of the export hide what just touches: a tolerance finds it.
  const Assembly found = read_assembly(packing("settled.txt"), {.gap_tolerance = 1e-4, .unit_of_length = "m"});
  const auto inside = pairs_of(a), all = pairs_of(found);
  CHECK(std::includes(all.begin(), all.end(), inside.begin(), inside.end()));
}

TEST_CASE("tables_with_named_columns_are_read_in_their_unit") {
  const auto radius = [](const std::string& text, const AssemblyFileOptions& options = {}) {
    const Assembly a = read_packing(text, options);
    REQUIRE(a.size() == 2);
    CHECK(a.centres[1].x == Approx(2 * a.radii[0]));
    return a.radii[0];
  };
  CHECK(radius("x_mm,y_mm,radius_mm\n0,0,1\n2,0,1\n") == Approx(1e-3));
  CHECK(radius("id;d [um];y [um];x [um]\n7;2;0;2\n3;2;0;0\n") == Approx(1e-6));
  CHECK(radius("x y r\n0 0 1\n2 0 1\n", {.unit_of_length = "mm"}) == Approx(1e-3));
  CHECK(radius("0 0 1\n2 0 1\n", {.unit_of_length = "2.5 mm"}) == Approx(2.5e-3));
  CHECK(radius("# x y z radius\n0 0 3 1\n+2 0 3 1\n", {.unit_of_length = "m"}) == 1);
  CHECK(radius("X,Y,Diameter,colour\n0,0,2,red\n2,0,2,blue\n", {.unit_of_length = "cm"}) == Approx(0.01));
  const Assembly cell = read_packing("x_m,y_m,radius_m,period_x_m,period_y_m\n0,0,1,4,2\n2,0,1,4,2\n", {});
  CHECK(*cell.period == Vec2{4, 2});
  CHECK(cell.contacts.size() == 4);
  CHECK(*read_packing("0 0 1\n2 0 1\n", {.unit_of_length = "m", .period = Vec2{4, 2}}).period == Vec2{4, 2});
}

TEST_CASE("contacts_of_a_table_may_have_levers_and_normals") {
  const TemporaryFolder folder;
  write_file(folder / "discs.csv", "id,x,y,radius\n10,0,0,1\n20,3,0,2\n30,0,3,2\n", false);
  const auto read = [&](const std::string& contacts) {
    write_file(folder / "contacts.csv", contacts, true);
    return read_assembly(folder / "discs.csv", {.unit_of_length = "mm", .contacts = folder / "contacts.csv"});
  };
  const Assembly plain = read("i,j\n20,10\n10,30\n");
  REQUIRE(plain.contacts.size() == 2);
  CHECK(plain.contacts[0].i == 1);
  CHECK(plain.contacts[0].lever_i == Approx(2e-3));
  const Assembly levers = read("id1 id2 lever_i lever_j\n10 20 1.25 1.75\n");
  CHECK(levers.contacts[0].lever_i == Approx(1.25e-3));
  CHECK(read("i,j,lever_i_um,lever_j_um\n10,20,1250,1750\n").contacts[0].lever_j == Approx(1.75e-3));
  const Assembly arms = read("i,j,lever_i,lever_j,normal_x,normal_y,offset_i,offset_j\n10,20,0.8,1,0.6,0.8,-1.4,-1\n");
  CHECK(arms.contact_arms[0].offset_i == Approx(-1.4e-3));
  const auto refused = [&](const std::string& text, const std::vector<std::string>& words) {
    test::check_refused([&] { read(text); }, words);
  };
  refused("i,j\n10,40\n", {"contacts.csv: line 2", "particle 40", "numbered from 10 to 30"});
  refused("i,j\n10,20\n20,10\n", {"contacts.csv", "the same"});
  refused("i,k\n10,20\n", {"contacts.csv: line 1", "column 'j' is missing"});
  refused("i,j,lever_i\n10,20,1\n", {"line 1", "lever_i and lever_j", "Give both"});
  refused("i,j,lever_i,levr_j\n10,20,1,2\n", {"line 1", "Did you mean 'lever_j'?"});
  refused("i,j,normal_x,normal_y\n10,20,1,0\n", {"line 1", "normals, offsets and levers"});
  refused("i,j,lever_i_m,lever_j_mm\n10,20,1,1\n", {"line 1", "different units"});
  refused("1 2 3\n", {"line 1", "3 columns", "i j"});
  refused("i,j\n10,2x\n", {"contacts.csv: line 2", "'2x' is no particle"});
}

TEST_CASE("bad_files_of_other_programs_are_refused_in_one_sentence") {
  struct Case {
    std::string text;
    std::vector<std::string> words;
    AssemblyFileOptions options = {.unit_of_length = "m"};
  };
  const std::string dump = read_file(packing("packing.dump")), data = read_file(packing("packing.data"));
  const AssemblyFileOptions none{}, as_cell{.unit_of_length = "m", .periodic_box = true};
  const std::vector<Case> cases = {
      // units
      {"x,y,r\n0,0,1\n", {"a.txt", "does not say its unit of length", "assembly.unit_of_length = \"mm\""}, none},
      {"0 0 1\n", {"'inch' is no unit", "mm"}, {.unit_of_length = "inch"}},
      {replaced(dump, "\nsi\n", "\nlj\n"), {"its units are lj", "assembly.unit_of_length"}, none},
      {dump, {"unit_of_length is mm", "units of 1 m"}, {.unit_of_length = "mm"}},
      {"x_mm,y_mm,r_m\n0,0,1\n", {"line 1", "different units"}, none},
      // columns
      {"x,y,radus\n0,0,1\n", {"line 1", "column 'radius' is missing", "'radus' may be meant"}},
      {"x y\n0 0\n", {"line 1", "column 'radius' is missing", "x, y"}},
      {"x_ft,y_ft,radius_ft\n0,0,1\n", {"line 1", "column 'x' is missing", "'x_ft' ends in no unit", "'x_mm'"}},
      {"x [in],y [in],radius [in]\n0,0,1\n", {"line 1", "'x [in]' has the unit 'in'", "mm"}},
      {"x,y,r,d\n0,0,1,3\n", {"line 2", "the radius is 1 and the diameter 3"}},
      {"0 0 1 2 3\n", {"line 1", "5 columns without names"}},
      {"x,y,x,r\n0,0,1,1\n", {"line 1", "'x' is there twice"}},
      {"#format jointedPM\n1 2 3\n", {"line 1", "'jointedPM' is no format", "x_y_z_r"}},
      {replaced(dump, "y z radius", "y z mass"), {"no column 'radius'", "dump 1 all custom"}, {.frame = 0}},
      {replaced(data, "# sphere", "# atomic"), {"style atomic", "no diameter"}, as_cell},
      {"t\n1 atoms\n0 1 xlo xhi\n0 1 ylo yhi\nAtoms\n\n1 1 2 1 0 0 0\n",
       {"line 5", "does not name its atom style"},
       as_cell},
      // versions
      {replaced(dump, "ITEM: ATOMS", "ITEM: PARTICLES"), {"line 11", "'ITEM: PARTICLES id"}, none},
      {replaced(data, "Velocities", "Velocites"), {"Velocites", "Did you mean 'Velocities'?"}, as_cell},
      {replaced(data, "Velocities", "Ellipsoids"), {"Ellipsoids", "no discs"}, as_cell},
      // cut off
      {dump.substr(0, dump.size() - 5), {"after 35 of 36 atoms", "cut off"}, none},
      {data.substr(0, data.find('\n', 900) + 1), {"Atoms ends after", "of 36 lines", "cut off"}, as_cell},
      {data.substr(0, 900), {"ends within a line", "cut off"}, as_cell},
      {data.substr(0, 120), {"cut off"}, as_cell},
      {"x y r\n0 0 1\n2 0\n", {"line 3", "2 cells", "cut off"}},
      {"\x1f\x8b\x08 squeezed", {"a.txt: this is not JSON, nor text", "Unpack it"}},
      // numbers
      {"x y r\n0 0 1\n2 0 nan\n", {"line 3", "'nan' is no radius"}},
      {"x y r\n0 0 1\n2 0 -1\n", {"line 3", "radius is -1"}},
      {"id x y r\n4 0 0 1\n4 2 0 1\n", {"line 3", "particle 4 is there twice", "line 2"}},
      {"x y z r\n0 0 0 1\n2 0.5 1.5 1\n", {"line 3", "three-dimensional", "0 to 1.5"}},
      {"x y z r\n0 0 0 1\n2 0 1.5 1\n", {"line 3", "plane x-z", "0 to 1.5", "assembly.plane = \"x-z\""}},
      {"id x y r\n7 0 0 1\n8 2 0 1\n9 3e-9 0 1\n", {"line 4", "particles 7 and 9 lie in one place", "line 2"}},
      {"id x y r\n7 0 0 1\n8 2 0 1\n9 0 0 1\n", {"line 4", "particles 7 and 9 lie in one place", "line 2"}},
      // boxes
      {replaced(dump, "BOX BOUNDS pp pp pp", "BOX BOUNDS pp ff pp"),
       {"periodic along x only", "periodic_box = false"},
       {.frame = 0}},
      {replaced(dump, "BOX BOUNDS pp pp pp", "BOX BOUNDS abc origin pp pp pp"), {"triclinic"}, {.frame = 0}},
      {replaced(data, "-0.005 0.005 zlo zhi", "-0.005 0.005 zlo zhi\n0.01 0 0 xy xz yz"),
       {"line 9", "triclinic"},
       as_cell},
      {"0 0 1\n2 0 1\n", {"the file has no box"}, {.unit_of_length = "m", .periodic_box = true}},
      {dump, {"the file says its box"}, {.period = Vec2{1, 1}}},
      // what is not for this file
      {data, {"frames are those of a LAMMPS dump"}, {.unit_of_length = "m", .frame = 3}},
      {"{\"schema\": \"equidem-assembly/1\", \"discs\": [[0, 0, 1]]}", {"unit_of_length", "assembly file"}},
  };
  for (const Case& wrong : cases) check_words(refused_packing(wrong.text, wrong.options), wrong.words);
  CHECK(refused_packing(without_line(data, "Velocities"), as_cell) != "(accepted)");
}

TEST_CASE("a_box_with_flags_for_one_axis_can_be_taken_as_free") {
  const std::string dump = replaced(read_file(packing("packing.dump")), "pp pp pp", "pp ff pp");
  CHECK_FALSE(read_packing(dump, {.frame = 0, .periodic_box = false}).period);
  const std::string scaled =
      "ITEM: TIMESTEP\n1\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS ff ff pp\n1 5\n0 2\n-1 1\n"
      "ITEM: ATOMS id xs ys diameter\n2 0.75 0.5 2\n1 0.25 0.5 2\n";
  const Assembly a = read_packing(scaled);
  CHECK(a.centres[0] == Vec2{2, 1});
  CHECK(a.centres[1] == Vec2{4, 1});
  CHECK(a.contacts.size() == 1);
}

TEST_CASE("atoms_without_a_style_and_those_of_liggghts_are_spheres") {
  const std::string data = read_file(packing("packing.data"));
  const AssemblyFileOptions as_cell{.unit_of_length = "m", .periodic_box = true};
  const Assembly named = read_packing(data, as_cell);
  for (const char* style : {"", " # granular"}) {
    CAPTURE(style);
    const Assembly other = read_packing(replaced(data, " # sphere", style), as_cell);
    CHECK(other.centres == named.centres);
    CHECK(other.radii == named.radii);
  }
}

TEST_CASE("discs_that_lie_deep_in_one_another_are_read_and_those_in_one_place_are_not") {
  const AssemblyFileOptions mm{.unit_of_length = "mm", .period = Vec2{0.02, 0.02}};
  const std::string grid = "id,x_mm,y_mm,r_mm\n1,0,0,5\n2,10,0,5\n3,0,10,5\n4,10,10,5\n";
  for (const char* twice : {"5,0,0,5\n", "5,3e-9,0,5\n", "5,20,0,5\n", "5,19.999999997,0,5\n"}) {
    CAPTURE(twice);
    check_words(refused_packing(grid + twice, mm), {"a.txt", "line 6", "particles 1 and 5 lie in one place", "line 2"});
  }
  CHECK(read_packing(grid + "5,0.01,0,5\n", mm).size() == 5);
}
