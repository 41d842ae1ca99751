// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/files.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <tuple>

#include <unistd.h>

#include "equidem/assembly/contact_numbers.hpp"
#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/assembly/touching.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/packing/packing.hpp"

#include "support/catch.hpp"
#include "support/free_samples.hpp"
#include "support/temporary_folder.hpp"

using namespace equidem;
using equidem::test::TemporaryFolder;
namespace fs = std::filesystem;

namespace {

Assembly read_text(const std::string& text) {
  const TemporaryFolder folder;
  write_file(folder / "a.json", text, true);
  return read_assembly(folder / "a.json");
}

/// The sentence with which a text is refused, from the name of the file on.
std::string refusal(const std::string& text) {
  try {
    read_text(text);
  } catch (const Error& error) {
    const std::string sentence = error.what();
    return sentence.substr(std::min(sentence.size(), sentence.find("a.json")));
  }
  return "(accepted)";
}

/// A file of two touching discs, its key `key` replaced by `value`.
std::string file_with(const std::string& key = "", const std::string& value = "") {
  std::string text = R"({"schema": "equidem-assembly/1")";
  const auto add = [&](const std::string& name, const std::string& standard) {
    const std::string& taken = name == key ? value : standard;
    if (!taken.empty()) text += ", \"" + name + "\": " + taken;
  };
  add("discs", "[[0, 0, 1], [2, 0, 1]]");
  add("contacts", "[[0, 1, 0, 0]]");
  for (const char* name : {"cell", "levers", "springs", "groups", "title", "dics"}) add(name, "");
  return text + "}";
}

void require_same(const Assembly& a, const Assembly& b) {
  REQUIRE(a.centres == b.centres);
  for (std::size_t d = 0; d < a.size(); ++d) CHECK(std::signbit(a.centres[d].x) == std::signbit(b.centres[d].x));
  REQUIRE(a.radii == b.radii);
  REQUIRE(a.period == b.period);
  REQUIRE(a.contacts.size() == b.contacts.size());
  for (std::size_t k = 0; k < a.contacts.size(); ++k) {
    const Contact& p = a.contacts[k];
    const Contact& q = b.contacts[k];
    CHECK(std::tie(p.i, p.j, p.shift_x, p.shift_y) == std::tie(q.i, q.j, q.shift_x, q.shift_y));
    CHECK(std::tie(p.lever_i, p.lever_j) == std::tie(q.lever_i, q.lever_j));
  }
  CHECK(a.box == b.box);
  CHECK(a.cell_areas == b.cell_areas);
  CHECK(a.facet_lengths == b.facet_lengths);
  REQUIRE(a.contact_arms.size() == b.contact_arms.size());
  for (std::size_t k = 0; k < a.contact_arms.size(); ++k) {
    const ContactArms &p = a.contact_arms[k], &q = b.contact_arms[k];
    CHECK((p.normal == q.normal && p.offset_i == q.offset_i && p.offset_j == q.offset_j));
  }
  REQUIRE(a.sections.size() == b.sections.size());
  for (std::size_t d = 0; d < a.sections.size(); ++d)
    CHECK((a.sections[d].area == b.sections[d].area && a.sections[d].polar_moment == b.sections[d].polar_moment));
  for (const ContactNumbers& numbers : contact_numbers) {
    CHECK(a.*numbers.first == b.*numbers.first);
    CHECK(a.*numbers.second == b.*numbers.second);
  }
  REQUIRE(a.groups.size() == b.groups.size());
  for (const auto& [name, discs] : a.groups) {
    CAPTURE(name);
    CHECK(discs.discs == group(b, name).discs);
    CHECK(discs.tributary_lengths == group(b, name).tributary_lengths);
  }
}

}  // namespace

TEST_CASE("files_read_back_to_the_same_bits") {
  const bool periodic = GENERATE(true, false);
  Assembly a = delaunay_assembly({.discs = 300,
                                  .points = PointProcess::uniform,
                                  .radii = {.smallest = 0.003, .largest = 0.007},
                                  .periodic = periodic});
  if (!periodic) a.centres[0].x = -0.0;
  for (double n = 3; n < 3 + static_cast<double>(a.contacts.size()); ++n)
    for (const ContactNumbers& numbers : contact_numbers) numbers.add(1e9 / n, 1e-300 * n, a);
  a.groups["chosen \"few\""] = {.discs = {3, 17}, .tributary_lengths = {}};
  a.groups["loaded"] = {.discs = {2, 5}, .tributary_lengths = {1e-3 / 3, 0.1}};
  if (GENERATE(true, false)) {  // bodies that are no discs, with contacts off the lines of centres
    for (const double radius : a.radii) {
      const double square = radius * radius;
      a.sections.push_back({std::numbers::pi * square, 1.7 * square * square});
    }
    for (Contact& contact : a.contacts) {
      const Vec2 l = a.branch(contact), n = (l + 0.1 * perpendicular(l)) / norm(l + 0.1 * perpendicular(l));
      contact.lever_i = dot(l, n) / 3, contact.lever_j = dot(l, n) - dot(l, n) / 3;
      const double across = dot(l, perpendicular(n));
      a.contact_arms.push_back({n, across / 7, across - across / 7});
    }
  }
  const TemporaryFolder folder;
  const auto file = folder / "sub" / GENERATE("a.json", "a.h5");

  write_assembly(file, a, false);
  const Assembly b = read_assembly(file);

  require_same(a, b);
  CHECK(b.kind == "file");
  CHECK_THROWS_AS(write_assembly(file, a, false), Error);
  CHECK_NOTHROW(write_assembly(file, a, true));
}

TEST_CASE("cells_of_a_file_are_measured") {
  const Assembly a = delaunay_assembly({.discs = 200, .periodic = true});
  const TemporaryFolder folder;
  write_assembly(folder / "a.json", a, false);

  const Assembly b = read_assembly(folder / "a.json");

  for (std::size_t d = 0; d < a.size(); ++d) CHECK(b.cell_areas[d] == Approx(a.cell_areas[d]).epsilon(1e-12));
  for (std::size_t k = 0; k < a.contacts.size(); ++k) CHECK(b.facet_lengths[k] == Approx(a.facet_lengths[k]));
}

TEST_CASE("missing_contacts_are_the_touching_discs") {
  const bool periodic = GENERATE(true, false);
  Assembly lattice = hexagonal_lattice({.columns = 4, .rows = 6, .periodic = periodic});
  const TemporaryFolder folder;
  write_assembly(folder / "a.json", lattice, false);
  std::string text = read_file(folder / "a.json");
  const std::size_t begin = text.find(",\n\"contacts\"");
  const std::size_t end = text.find(",\n\"groups\"");
  text.erase(begin, end == std::string::npos ? text.size() - 2 - begin : end - begin);

  const Assembly found = read_text(text);

  CHECK(found.contacts.size() == lattice.contacts.size());
  for (const Contact& c : found.contacts) CHECK(c.lever_i == Approx(0.005).epsilon(1e-12));
}

TEST_CASE("discs_touch_up_to_rounding_and_overlap_counts") {
  CHECK(read_text(file_with("contacts", "")).contacts.size() == 1);
  const auto contacts = [](const std::string& discs) {
    return read_text(R"({"schema": "equidem-assembly/1", "discs": )" + discs + "}").contacts.size();
  };
  CHECK(contacts("[[0, 0, 1], [2.0000000005, 0, 1]]") == 1);
  CHECK(contacts("[[0, 0, 1], [2.00000001, 0, 1]]") == 0);
  CHECK(contacts("[[0, 0, 1], [1.5, 0, 1]]") == 1);
  CHECK(contacts("[[0, 0, 3], [3.5, 0, 0.5], [4.5, 0, 0.5]]") == 2);
  // One disc in a narrow cell touches its own images on two sides, and those after them.
  const Assembly narrow = read_text(R"({"schema": "equidem-assembly/1", "cell": [1, 10], "discs": [[0.2, 3, 0.5]]})");
  REQUIRE(narrow.contacts.size() == 1);
  CHECK(narrow.contacts[0].shift_x == 1);
  CHECK(read_text(R"({"schema": "equidem-assembly/1", "cell": [1, 10], "discs": [[9.2, -3, 1.1]]})").contacts.size() ==
        2);
}

TEST_CASE("a_gap_tolerance_bonds_discs_of_a_file_that_gives_no_contacts") {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& rest, double tolerance) {
    write_file(folder / "a.json",
               R"({"schema": "equidem-assembly/1", "discs": [[0, 0, 1], [2.1, 0, 1], [1, 1.9, 1]])" + rest + "}", true);
    return read_assembly(folder / "a.json", {.gap_tolerance = tolerance});
  };
  CHECK(read("", 0.049).contacts.empty());
  CHECK(read("", 0.051).contacts.size() == 1);
  CHECK(read("", 0.1).contacts.size() == 3);
  CHECK_THROWS_AS(read(R"(, "contacts": [[0, 1, 0, 0]])", 0.1), Error);
}

TEST_CASE("levers_springs_and_groups_are_read") {
  const Assembly a = read_text(R"({"schema": "equidem-assembly/1", "title": "three", "cell": null,
    "discs": [[0, 0, 1], [2, 0, 1], [1, 1.8, 1]], "contacts": [[0, 1, 0, 0], [2, 0, 0, 0]],
    "levers": [[0.9, 1.1], [1, 1.5]], "springs": [[1e9, 5e8], [2e9, -1]],
    "groups": {"pulled": [2, 0], "side": {"discs": [1, 0], "tributary_lengths": [5, 6]}, "left": []}})");

  CHECK(a.contacts[0].lever_i == 0.9);
  CHECK(a.contacts[1].lever_j == 1.5);
  CHECK(a.contact_kN == std::vector<double>{1e9, 2e9});
  CHECK(a.contact_kT == std::vector<double>{5e8, -1});
  CHECK(group(a, "pulled").discs == std::vector<std::int32_t>{0, 2});
  CHECK(group(a, "side").tributary_lengths == std::vector<double>{6, 5});
  // The file's own groups stay; the other sides are added.
  CHECK(group(a, "left").discs.empty());
  CHECK(group(a, "bottom").discs == std::vector<std::int32_t>{0, 1});
  CHECK(group(a, "bottom").tributary_lengths == std::vector<double>{2, 2});
}

TEST_CASE("wrong_entries_are_named") {
  struct Case {
    const char* key;
    const char* value;
    const char* sentence;
  };
  const std::vector<Case> cases = {
      {"dics", "[]", "a.json: dics: there is no key 'dics' (an assembly file is read strictly). Did you mean 'discs'?"},
      {"discs", "",
       "a.json: discs: the key 'discs' is missing (an assembly is made of discs). Add \"discs\": [[x, y, "
       "radius], "
       "...]."},
      {"discs", "[]", "a.json: the assembly has no discs (there is nothing to solve for). Give it discs."},
      {"discs", "7", "a.json: discs: a number stands where a list is expected. Correct the entry."},
      {"discs", "[[0, 0, 1], [2, 0]]",
       "a.json: discs[1]: 2 numbers stand where 3 are expected (an entry is [x, y, radius]). Correct the "
       "entry."},
      {"discs", "[[0, 0, 1], [2, \"0\", 1]]",
       "a.json: discs[1]: a text stands where a number is expected. Correct the entry."},
      {"discs", "[[0, 0, 1], [2, 0, -1]]",
       "a.json: disc 1 has the radius -1 (radii must be positive and finite). Correct it."},
      {"discs", "[[0, 0, 1], [2, 0, 1e999]]",
       "a.json: a number is too large for a double (the largest is 1.8e308). Correct it."},
      {"discs", "[[0, 0, 1], [2, 0, 1], [2, 0, 1]]",
       "a.json: discs 1 and 2 have the same centre, (2, 0) m (no direction joins them, and their cells "
       "cannot be separated). Move or remove one of them."},
      {"contacts", "[[0, 2, 0, 0]]",
       "a.json: contact 0 names disc 2 (the discs are numbered from 0 to 1). Correct the contact or add the "
       "disc."},
      {"contacts", "[[0, 0, 0, 0]]",
       "a.json: contact 0 joins disc 0 to itself (a disc can only touch another disc or its own image across "
       "a "
       "period). Remove the contact or give it a shift."},
      {"contacts", "[[0, 1.5, 0, 0]]",
       "a.json: contacts[0]: 1.5 stands where a whole number is expected. Correct the entry."},
      {"contacts", "[[0, 99999999999, 0, 0]]",
       "a.json: contacts[0]: 99999999999 is out of range (discs and shifts are whole numbers of a magnitude up to "
       "2147483647). Correct the entry."},
      {"contacts", "[[0, 1, 0, 0], [1, 0, 0, 0]]",
       "a.json: contacts[1]: contacts 0 and 1 are the same, of discs 0 and 1 (its springs would count "
       "twice). Remove "
       "one of them."},
      {"levers", "[[1, 1], [1, 1]]",
       "a.json: levers: 2 entries for 1 contact (there must be one for each). Correct the list or remove "
       "it."},
      {"levers", "[[1, -1]]",
       "a.json: contact 0, of discs 0 and 1, has the lever arm -1 (lever arms must be finite and not "
       "negative). "
       "Correct it."},
      {"springs", "[[0, 1]]",
       "a.json: contact 0, of discs 0 and 1, has kN = 0 Pa (a normal spring must be positive and finite). "
       "Correct it "
       "or remove the contact."},
      {"springs", "[[1, 0], [1, 0]]",
       "a.json: springs: 2 entries for 1 contact (there must be one for each). Take the springs of this assembly, or "
       "remove them and give kN and kT in the case."},
      {"springs", "[[1, null]]", "a.json: springs[0]: null stands where a number is expected. Correct the entry."},
      {"cell", "[1]", "a.json: cell: 1 number stands where 2 are expected (an entry is [Lx, Ly]). Correct the entry."},
      {"cell", "[1, -1]",
       "a.json: the period is (1, -1) m (both lengths of a periodic cell must be positive and finite). "
       "Correct the "
       "cell."},
      {"groups", "{\"pulled\": [5]}",
       "a.json: group 'pulled' names disc 5 (the discs are numbered from 0 to 1). Correct the group or add "
       "the disc."},
      {"groups", "{\"pulled\": [true]}",
       "a.json: groups.pulled[0]: a truth value stands where a whole number is expected. Correct the entry."},
      {"groups", "{\"pulled\": {\"disc\": [1]}}",
       "a.json: groups.pulled: there is no key 'disc' in a group (its keys are 'discs' and "
       "'tributary_lengths'). "
       "Correct or remove it."},
      {"groups", "[]", "a.json: groups: a list stands where an object of groups is expected. Correct the entry."},
      {"title", "7", "a.json: title: a number stands where a text is expected. Correct the entry."},
  };
  REQUIRE(refusal(file_with()) == "(accepted)");
  for (const Case& wrong : cases) CHECK(refusal(file_with(wrong.key, wrong.value)) == wrong.sentence);

  CHECK(refusal("{}") ==
        "a.json: schema: the key 'schema' is missing (an assembly file has \"schema\": "
        "\"equidem-assembly/1\"). Add or "
        "correct it, if this is an assembly file.");
  CHECK(refusal(R"({"schema": "other/2"})") ==
        "a.json: schema: the schema is \"other/2\" (an assembly file has \"schema\": "
        "\"equidem-assembly/1\"). Add or "
        "correct it, if this is an assembly file.");
  CHECK(refusal("[1]") ==
        "a.json: a list stands where an object with the keys schema, discs, ... is expected. Correct "
        "the entry.");
  CHECK(refusal("{\"schema\": \"equidem-assembly/1\",\n \"discs\": [[NaN, 0, 1]]}") ==
        "a.json: line 2, column 13: this is not JSON (reading stopped at byte 46 of 57). Correct the text "
        "there.");
  CHECK_THROWS_AS(read_assembly("no/such/file.json"), Error);
  CHECK_THROWS_AS(read_assembly("."), Error);
}

TEST_CASE("an_independent_triangulation_has_the_same_contacts_and_the_same_cells") {
  const Assembly given = read_assembly(fs::path(EQUIDEM_SOURCE_DIR) / "data/reference/perturbed_hexagonal_400.json");
  Assembly ours = given;

  triangulate(ours);

  REQUIRE(given.contacts.size() == 1200);
  REQUIRE(ours.contacts.size() == 1200);
  for (std::size_t k = 0; k < 1200; ++k) {
    const Contact& p = given.contacts[k];
    const Contact& q = ours.contacts[k];
    CHECK(std::tie(p.i, p.j, p.shift_x, p.shift_y) == std::tie(q.i, q.j, q.shift_x, q.shift_y));
    CHECK(given.facet_lengths[k] == ours.facet_lengths[k]);
  }
}

TEST_CASE("a_file_cut_off_anywhere_is_refused") {
  Assembly a = square_lattice({.columns = 2, .rows = 2});
  a.contact_kN.assign(4, 1e9);
  a.contact_kT.assign(4, 5e8);
  const TemporaryFolder folder;
  write_assembly(folder / "a.json", a, false);
  const std::string whole = read_file(folder / "a.json");
  REQUIRE(whole.size() > 500);
  REQUIRE(whole.substr(whole.size() - 2) == "}\n");

  for (std::size_t length = 0; length + 2 <= whole.size(); ++length) {
    const std::string sentence = refusal(whole.substr(0, length));
    INFO(length << ": " << sentence);
    const bool told = sentence.find("cut off") != std::string::npos || sentence.find("not JSON") != std::string::npos ||
                      sentence.find("is empty") != std::string::npos;
    CHECK(told);
    CHECK(sentence.find("line ") != std::string::npos);
  }
}

TEST_CASE("the_cells_of_a_free_assembly_fill_the_box_that_its_file_gives") {
  const std::string head = R"({"schema": "equidem-assembly/1", "discs": [[0, 0, 1], [2, 0, 1], [1, 1.7, 1]])";
  const std::string box = R"(, "box": [[-0.5, -0.25], [2.5, 2]])";
  const Assembly assembly = read_text(head + box + "}");
  CHECK(assembly.area() == Approx(3 * 2.25).epsilon(1e-14));
  double bottom = 0;
  for (const double length : group(assembly, "bottom").tributary_lengths) bottom += length;
  CHECK(bottom == Approx(3).epsilon(1e-14));
  const TemporaryFolder folder;
  write_assembly(folder / "boxed.json", assembly, false);
  CHECK(read_assembly(folder / "boxed.json").cell_areas == assembly.cell_areas);

  CHECK_THAT(refusal(head + box + R"(, "cell": [4, 4]})"), Catch::Contains("beside a period"));
  CHECK_THAT(refusal(head + R"(, "box": [[2.5, 2], [-0.5, -0.25]]})"), Catch::Contains("-3 m wide"));
  CHECK_THAT(refusal(head + R"(, "box": [[0, -0.25], [1.5, 2]]})"), Catch::Contains("centre of disc 1"));
  CHECK_THAT(refusal(head + R"(, "box": [0, 0, 3, 3]})"), Catch::Contains("[x, y], [x, y]"));
  CHECK_THAT(refusal(head + R"(, "box": [[0, 0], 3]})"), Catch::Contains("box[1]"));
}

TEST_CASE("contacts_off_the_line_of_centres_are_read_and_what_is_amiss_in_them_is_named") {
  const std::string head = R"({"schema": "equidem-assembly/1", "discs": [[0, 0, 1], [2, 0.5, 1]], )";
  const std::string contacts = R"("contacts": [[0, 1, 0, 0], [1, 0, 0, 0]], )";
  const std::string arms = R"("levers": [[1.25, 0.75], [1.5, 0.5]], "normals": [[1, 0], [-1, 0]], )";
  const std::string offsets = R"("offsets": [[0.7, -0.2], [1.1, -0.6]])";
  const std::string sections = R"(, "sections": [[3.141592653589793, 1.6], [3.1415926, 1.7]])";
  const Assembly assembly = read_text(head + contacts + arms + offsets + sections + "}");
  REQUIRE(assembly.contact_arms.size() == 2);
  CHECK(assembly.contact_arms[1].normal == Vec2{-1, 0});
  CHECK(assembly.contact_arms[0].offset_j == -0.2);
  CHECK(assembly.sections[1].polar_moment == 1.7);
  CHECK(assembly.solid_fraction() == Approx((3.141592653589793 + 3.1415926) / assembly.area()).epsilon(1e-15));

  CHECK_THAT(refusal(head + contacts + arms + R"("title": ""})"), Catch::Contains("'offsets' is missing"));
  CHECK_THAT(refusal(head + contacts + offsets + "}"), Catch::Contains("'levers' is missing"));
  CHECK_THAT(refusal(head + contacts + arms + R"("offsets": [[0.7, -0.2]]})"),
             Catch::Contains("1 entry for 2 contacts"));
  CHECK_THAT(refusal(head + contacts + arms + R"("offsets": [[0.7, -0.2], [1.1, -0.5]]})"),
             Catch::Contains("contact 1") && Catch::Contains("apart at their ends"));
  CHECK_THAT(refusal(head + contacts + arms + offsets + R"(, "sections": [[3, 1.5]]})"),
             Catch::Contains("1 entry for 2 discs"));
  CHECK_THAT(refusal(head + R"("sections": [[3, 1.5], [3, 1.5]]})"), Catch::Contains("sections but no contacts"));
  // One place twice, from either end.
  CHECK_THAT(refusal(head + contacts + R"("levers": [[1.25, 0.75], [0.75, 1.25]], "normals": [[1, 0], [-1, 0]],
                     "offsets": [[0.7, -0.2], [-0.2, 0.7]]})"),
             Catch::Contains("contacts 0 and 1 are the same, of discs 0 and 1"));
}

namespace {

/// Assemblies of every kind, as they are made, and as Python and the verbs change them.
std::vector<Assembly> assemblies_of_every_kind() {
  std::vector<Assembly> all;
  for (const bool periodic : {false, true}) {
    all.push_back(hexagonal_lattice({.columns = 5, .rows = 6, .radius = 0.02, .periodic = periodic}));
    all.push_back(square_lattice({.columns = 3, .rows = 4, .radius = 1.0 / 3, .periodic = periodic}));
    all.push_back(
        delaunay_assembly({.discs = 60, .radii = {.smallest = 0.003, .largest = 0.007}, .periodic = periodic}));
    for (const PackingShape::Kind shape : {PackingShape::Kind::disc, PackingShape::Kind::ellipse}) {
      PackingOptions options;
      options.shape.kind = shape;
      options.box = {{0.07, 0.06}, periodic ? PackingBox::Sides::periodic : PackingBox::Sides::walls};
      options.radii.assign(30, 0.005);
      all.push_back(network_of(pack(options), {.springs = SpringConstants{1e9, 1e8}, .gap_tolerance = 0.3}));
      if (!all.back().contacts.empty()) measure_cells(all.back());
    }
  }
  all.push_back(hexagonal_lattice({.columns = 1, .rows = 1, .radius = 1}));
  for (const std::uint64_t number : {0, 1, 4, 5, 6, 7, 8}) {  // of a file, lying askew
    Assembly a = test::placed(test::free_sample(number), {.degrees = 13, .moved = {100, 0}});
    a.contacts = touching_discs(a, 0.1);
    for (Contact& c : a.contacts) c.lever_i = a.radii[static_cast<std::size_t>(c.i)], c.lever_j = 1.0 / 3;
    measure_cells(a);
    all.push_back(a);
    if (a.contacts.empty()) continue;
    for (std::size_t k = 0; k < a.contacts.size(); ++k)
      for (const ContactNumbers& numbers : contact_numbers) numbers.add(1e9 / 3, 1 / (3.0 + static_cast<double>(k)), a);
    a.groups["own"] = {.discs = {0, 1}, .tributary_lengths = {}};
    all.push_back(a);
  }
  return all;
}

}  // namespace

TEST_CASE("a_written_assembly_of_any_kind_is_read_back_the_same_in_any_format") {
  std::size_t turned = 0;
  for (const Assembly& a : assemblies_of_every_kind()) {
    turned += a.box && !a.box->upright() ? 1 : 0;
    for (const char* name : {"a.json", "a.h5"}) {
      const TemporaryFolder folder;
      write_assembly(folder / name, a, false);
      const Assembly b = read_assembly(folder / name);
      CAPTURE(a.kind, a.size(), a.contacts.size(), a.periodic(), name, a.cell_areas.empty());
      if (!a.cell_areas.empty()) require_same(a, b);
      write_assembly(folder / "again.json", b, false);
      require_same(b, read_assembly(folder / "again.json"));
    }
  }
  CHECK(turned > 5);
}

TEST_CASE("cells_that_do_not_fill_the_region_of_their_file_are_refused") {
  const TemporaryFolder folder;
  Assembly block = hexagonal_lattice({.columns = 4, .rows = 4, .radius = 0.5});
  for (double& area : block.cell_areas) area *= 1e6;  // mm²
  for (const char* name : {"a.json", "a.h5"}) {
    write_assembly(folder / name, block, false);
    CHECK_THROWS_WITH(read_assembly(folder / name), Catch::Contains("their region") && Catch::Contains("cell_areas"));
  }
}
