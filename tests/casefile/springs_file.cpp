// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Springs and their density in a file of their own, for every kind of case.
#include "equidem/casefile/assembly/build.hpp"
#include "equidem/casefile/assembly/case.hpp"
#include "equidem/casefile/contact_tables.hpp"
#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/casefile/packing/pack_case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

#include "example.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"
#include "support/temporary_folder.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// A folder with the springs file springs.toml.
struct SpringsFolder {
  TemporaryFolder folder;

  explicit SpringsFolder(const std::string& springs) {
    write_file(folder / "springs.toml", "schema = \"equidem-springs/1\"\n[springs]\n" + springs, true);
  }
  /// Reads a case and returns the sentence of its error.
  template <class Read>
  std::string refusal(const Read& read) const {
    const test::Refusal refused = test::refusal_of([&] { static_cast<void>(read()); });
    return refused.message.empty() ? "accepted" : refused.message;
  }
};

const std::string named = "schema = \"equidem/1\"\nsprings = \"springs.toml\"\n";

const std::string tension_by_file = changed(changed(tension_case, "[springs]\nkN = 1.0e9\nkT = 0.5e9\n", ""), "title ",
                                            "springs = \"springs.toml\"\ntitle ");

const std::string packed_box =
    "[packing]\ngrains = 30\nsolid_fraction = 0.7\ngap_tolerance = 0.05\nsides = \"periodic\"\n"
    "[packing.radii]\nsmallest = 0.005\nlargest = 0.01\n";

const std::string meeting_discs =
    "[[grain]]\nposition = [0.0, 0.1]\nradius = 0.01\n[[grain]]\nposition = [0.1, 0.1]\nradius = 0.02\n"
    "[collisions]\nlaw = \"linear_dashpot\"\nrestitution = 0.5\nfriction = 0.3\n"
    "[[wall]]\nname = \"floor\"\npoint = [0.0, 0.0]\nnormal = [0.0, 1.0]\n[run]\nduration = 0.1\n";

}  // namespace

TEST_CASE("a_springs_file_stands_in_for_the_springs") {
  const TemporaryFolder folder;
  const auto sentence = [&]() -> std::string {
    return test::refusal_of([&] { static_cast<void>(parse_case(tension_by_file, "a.toml", folder.path())); }).message;
  };

  write_file(folder / "springs.toml",
             "schema = \"equidem-springs/1\"\n[springs]\nkN = 2.0e9\nkT = 1.0e9\nweighting = \"voronoi\"\n", true);
  const Case c = parse_case(tension_by_file, "a.toml", folder.path());
  REQUIRE(c.springs);
  CHECK(c.springs->kN == 2e9);
  CHECK(c.weighting == SpringWeighting::voronoi);
  const Case repeated = parsed(to_toml(c, "."));
  REQUIRE(repeated.springs);
  CHECK(repeated.springs->kN == c.springs->kN);
  CHECK(repeated.springs->kT == c.springs->kT);
  CHECK(repeated.weighting == c.weighting);

  write_file(folder / "springs.toml", "schema = \"equidem-springs/1\"\n[springs]\nkN = 2.0e9\nkTT = 1.0e9\n", true);
  CHECK(sentence().find("springs.toml:4: springs.kTT: unknown key") != std::string::npos);
  std::filesystem::remove(folder / "springs.toml");
  CHECK(sentence().find("a.toml:2: springs: cannot read") != std::string::npos);
}

TEST_CASE("a_springs_file_reads_back_bit_by_bit") {
  const TemporaryFolder folder;
  const double kT = GENERATE(1.0 / 3.0 * 1e9, 0.0, -0.1, 5e-324, 1.7976931348623157e308);
  const SpringWeighting weighting = GENERATE(SpringWeighting::uniform, SpringWeighting::contact_density,
                                             SpringWeighting::local_contact_density, SpringWeighting::voronoi);
  const SpringConstants springs{.kN = 1e9 + 1e-7, .kT = kT};
  const std::string text =
      springs_file(springs, weighting, {}, {}, "a \"title\" \\ äöü", "calibrated\n\nline\ttwo\x01");
  CAPTURE(text);
  write_file(folder / "springs.toml", text, true);
  const Case c = parse_case(tension_by_file, "a.toml", folder.path());
  REQUIRE(c.springs);
  CHECK(c.springs->kN == springs.kN);
  CHECK(c.springs->kT == springs.kT);
  CHECK(c.weighting == weighting);
}

TEST_CASE("a_springs_file_carries_the_density_of_its_discs") {
  const TemporaryFolder folder;
  write_file(folder / "springs.toml", springs_file({1e9, 5e8}, SpringWeighting::uniform, 2738.0, 0.75, "", ""), true);
  const auto density = [&](const std::vector<std::string>& overrides) {
    return parse_case(tension_by_file, "a.toml", folder.path(), overrides).assembly.density;
  };
  CHECK(density({}) == 2738.0);
  CHECK(density({"assembly.density=2738.0"}) == 2738.0);
  CHECK_THROWS_AS(density({"assembly.density=2700"}), Error);
}

TEST_CASE("one_springs_file_serves_assemblies_packings_and_bodies_that_collide") {
  const SpringsFolder files("kN = 2.0e9\nkT = 0.5e9\ndensity = 2738.0\n");
  const auto& folder = files.folder.path();

  const Case assembly = parse_case(named + "[assembly]\nkind = \"packing\"\n" + packed_box, "a.toml", folder);
  CHECK(assembly.springs->kN == 2e9);
  CHECK(assembly.assembly.density == 2738);

  const PackCase packing = parse_pack_case(named + packed_box, "a.toml", folder);
  CHECK(packing.network.springs->kN == 2e9);
  CHECK(packing.network.springs->kT == 0.5e9);
  CHECK(packing.packing.settling.springs.kT == 0.5e9);
  CHECK(packing.packing.settling.density == 2738);
  CHECK(parse_pack_case(to_toml(packing.document, folder), "b.toml", folder).density == 2738);

  const GrainCase grains = parse_grain_case(named + meeting_discs, "a.toml", folder);
  CHECK(grains.densities == std::vector<double>(2, 2738.0));
  REQUIRE(grains.contacts.pairs.size() >= 2);  // of grains, and of a grain and the wall
  for (const PairContact& pair : grains.contacts.pairs) {
    CHECK(pair.properties.stiffness == 2e9);
    CHECK(pair.properties.tangential_ratio == 0.25);
  }
  CHECK(parse_grain_case(to_toml(grains.document, folder), "b.toml", folder).densities == grains.densities);
}

TEST_CASE("springs_that_differ_from_contact_to_contact_are_left_out_of_what_pack_writes") {
  const SpringsFolder files("kN = 2.0e9\nkT = 0.5e9\nweighting = \"local_contact_density\"\n");
  const auto& folder = files.folder.path();
  CHECK_FALSE(parse_pack_case(named + packed_box, "a.toml", folder).network.springs);
  CHECK_FALSE(
      parse_pack_case(named + "[assembly]\nkind = \"packing\"\n" + packed_box, "a.toml", folder).network.springs);
}

TEST_CASE("springs_that_bodies_that_collide_cannot_have_are_refused_with_their_line") {
  const std::string plain = "kN = 2.0e9\nkT = 0.5e9\n", dense = plain + "density = 2000.0\n";
  const auto refused = [](const std::string& springs, const std::string& what, const std::string& by,
                          const std::vector<std::string>& words) {
    const SpringsFolder files(springs);
    std::string text = changed(meeting_discs, what, by);
    if (springs.find("density") == std::string::npos)
      text = changed(text, "[[grain]]", "[grains]\ndensity = 2500.0\n[[grain]]");
    CAPTURE(springs, by);
    check_refused([&] { parse_grain_case(named + text, "a.toml", files.folder.path()); }, words);
  };
  refused(plain + "weighting = \"voronoi\"\n", "", "",
          {"springs.toml:5: springs.weighting", "come and go", "weighting = \"uniform\""});
  refused("kN = 2.0e9\nkT = -0.5e9\n", "", "", {"springs.toml:4: springs.kT", "negative"});
  refused(plain, "restitution = 0.5\n", "restitution = 0.5\nstiffness = 1e5\n",
          {"collisions.stiffness", "[springs] and stiffness are both given"});
  refused(plain, "restitution = 0.5\n", "restitution = 0.5\ntangential_ratio = 0.3\n",
          {"[springs] and tangential_ratio are both given"});
  refused(dense, "[[grain]]", "[grains]\nbody = \"sphere\"\n[[grain]]",
          {"the grains are spheres", "per metre of depth"});
  refused(dense, "linear_dashpot", "hertz_dashpot", {"hertz_dashpot has no linear spring", "exact_flow"});
  refused(dense, "[[grain]]", "[grains]\ndensity = 2100.0\n[[grain]]",
          {"springs.toml:5: springs.density", "2000 kg/m³ here and 2100 kg/m³ in [grains]"});
}

TEST_CASE("grains_of_other_densities_may_stand_among_those_of_the_springs_but_not_instead_of_them") {
  const SpringsFolder files("kN = 2.0e9\nkT = 0.5e9\ndensity = 2738.0\n");
  const auto read = [&](const std::string& text) {
    return parse_grain_case(named + text, "a.toml", files.folder.path());
  };
  const std::string one = changed(meeting_discs, "radius = 0.01\n", "radius = 0.01\ndensity = 7800.0\n");
  CHECK(read(one).densities == std::vector<double>{7800, 2738});
  const std::string all = changed(one, "radius = 0.02\n", "radius = 0.02\ndensity = 7800.0\n");
  const std::string sentence = files.refusal([&] { return read(all); });
  CAPTURE(sentence);
  CHECK(sentence.find("springs.toml:5: springs.density: the springs are for discs of 2738 kg/m³") != std::string::npos);
  CHECK(sentence.find("7800") != std::string::npos);
}

TEST_CASE("densities_of_a_packing_and_of_its_springs_file_agree_or_are_refused") {
  const SpringsFolder files("kN = 2.0e9\nkT = 0.5e9\ndensity = 2738.0\n");
  const auto& folder = files.folder.path();
  const std::string other = changed(packed_box, "[packing]\n", "[packing]\ndensity = 2600.0\n");
  for (const char* assembly : {"", "[assembly]\nkind = \"packing\"\n"}) {
    const std::string sentence =
        files.refusal([&] { return parse_pack_case(named + assembly + other, "a.toml", folder); });
    CAPTURE(sentence);
    CHECK(sentence.find("packing.density: it is 2600 kg/m³ here and 2738 kg/m³ in [springs]") != std::string::npos);
  }
}
