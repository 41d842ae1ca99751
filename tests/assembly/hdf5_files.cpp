// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/files/hdf5_files.hpp"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <unistd.h>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/files.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/files/hdf5.hpp"
#include "equidem/core/files/open_file.hpp"

#include "support/catch.hpp"
#include "support/temporary_folder.hpp"

using namespace equidem;
using equidem::test::TemporaryFolder;
namespace fs = std::filesystem;

namespace {

struct Dataset {
  std::vector<std::uint64_t> shape;
  std::vector<double> real;         ///< or
  std::vector<std::int32_t> whole;  ///< one of the two
};

/// The datasets of three discs that touch.
std::map<std::string, Dataset> three_discs() {
  return {{"discs", {{3, 3}, {0, 0, 0.5, 1, 0, 0.5, 0.5, 0.8660254037844386, 0.5}, {}}},
          {"contacts", {{3, 4}, {}, {0, 1, 0, 0, 0, 2, 0, 0, 1, 2, 0, 0}}}};
}

void write_datasets(const fs::path& path, const std::map<std::string, Dataset>& datasets,
                    const std::string& schema = "equidem-assembly/1") {
  Hdf5Layout layout{.attributes = {{"schema", schema}}, .arrays = {}};
  for (const auto& [name, data] : datasets) {
    layout.arrays.push_back(
        {.name = name, .number = data.whole.empty() ? Hdf5Number::float64 : Hdf5Number::int32, .shape = data.shape});
  }
  layout = write_hdf5_layout(path, layout);
  OpenFile file(path, OpenFile::Mode::update);
  for (const auto& [name, data] : datasets) {
    file.write_at(layout[name].offset,
                  data.whole.empty() ? std::as_bytes(std::span(data.real)) : std::as_bytes(std::span(data.whole)));
  }
}

std::string refusal(const fs::path& path) {
  try {
    read_assembly(path);
  } catch (const Error& error) {
    const std::string sentence = error.what();
    return sentence.substr(std::min(sentence.size(), sentence.find("a.h5")));
  }
  return "(accepted)";
}

/// The sentence with which the three discs are refused after a change, from the name of the file on.
std::string refusal_after(const std::function<void(std::map<std::string, Dataset>&)>& change) {
  const TemporaryFolder folder;
  std::map<std::string, Dataset> datasets = three_discs();
  change(datasets);
  write_datasets(folder / "a.h5", datasets);
  return refusal(folder / "a.h5");
}

}  // namespace

TEST_CASE("an_hdf5_file_gives_back_cells_and_facets_too_and_the_json_file_measures_the_same") {
  const bool periodic = GENERATE(true, false);
  const Assembly written = delaunay_assembly({.discs = 500, .radii = {0.004, 0.006}, .periodic = periodic});
  const TemporaryFolder folder;
  write_assembly(folder / "a.h5", written, false);
  write_assembly(folder / "a.json", written, false);

  const Assembly read = read_assembly(folder / "a.h5"), measured = read_assembly(folder / "a.json");

  CHECK(read.cell_areas == written.cell_areas);
  CHECK(read.facet_lengths == written.facet_lengths);
  REQUIRE(measured.cell_areas.size() == read.cell_areas.size());
  // Radii beyond the sides widen the rectangle of a file: only inner cells are the same there.
  if (periodic) CHECK(measured.area() == Approx(read.area()));
}

TEST_CASE("levers_are_written_where_they_are_not_half_the_distance") {
  const TemporaryFolder folder;
  const auto has_levers = [&](const Assembly& assembly) {
    write_assembly(folder / "a.h5", assembly, true);
    return Hdf5File(folder / "a.h5").find("levers").has_value();
  };
  CHECK_FALSE(has_levers(delaunay_assembly({.discs = 100})));
  CHECK(has_levers(delaunay_assembly({.discs = 100, .radii = {0.004, 0.006}})));
}

TEST_CASE("an_assembly_without_contacts_stays_without") {
  const TemporaryFolder folder;
  Assembly apart;
  apart.centres = {{0, 0}, {2, 0}, {0, 2}};
  apart.radii = {1, 1, 0.5};
  write_assembly(folder / "a.h5", apart, false);
  CHECK(read_assembly(folder / "a.h5").contacts.empty());
}

TEST_CASE("an_hdf5_file_of_discs_alone_takes_those_that_touch") {
  const TemporaryFolder folder;
  std::map<std::string, Dataset> datasets = three_discs();
  datasets.erase("contacts");
  write_datasets(folder / "a.h5", datasets);
  CHECK(read_assembly(folder / "a.h5").contacts.size() == 3);
  CHECK(read_assembly(folder / "a.h5", {.gap_tolerance = 0.1}).gap_tolerance == 0.1);
}

TEST_CASE("what_is_amiss_in_an_hdf5_file_is_named_in_one_sentence") {
  using Datasets = std::map<std::string, Dataset>;
  struct Case {
    const char* fault;
    std::function<void(Datasets&)> change;
    const char* sentence;
  };
  const std::vector<Case> cases = {
      {"no discs", [](Datasets& d) { d.erase("discs"); }, "a.h5: discs: the dataset 'discs' is missing"},
      {"a name unknown", [](Datasets& d) { d["disc"] = d["discs"]; },
       "a.h5: disc: there is no key 'disc' (an assembly file is read strictly). Did you mean 'discs'?"},
      {"two columns",
       [](Datasets& d) {
         d["discs"].shape = {4, 2}, d["discs"].real.resize(8);
       },
       "a.h5: discs: the dataset has the shape (4, 2) (it has 3 columns). Write it in that shape."},
      {"reals for numbers of discs",
       [](Datasets& d) {
         d["contacts"] = {{3, 4}, std::vector<double>(12, 1.0), {}};
       },
       "a.h5: contacts: the dataset holds no whole numbers. Write it as int32 or int64."},
      {"NaN", [](Datasets& d) { d["discs"].real[4] = std::nan(""); }, "a.h5: discs[1]: the number is not finite"},
      {"disc out of range", [](Datasets& d) { d["contacts"].whole[5] = 3; },
       "a.h5: contact 1 names disc 3 (the discs are numbered from 0 to 2)"},
      {"negative disc", [](Datasets& d) { d["contacts"].whole[0] = -1; }, "a.h5: contact 0 names disc -1"},
      {"twice", [](Datasets& d) { d["contacts"].whole[5] = 1; },
       "a.h5: contacts[1]: contacts 0 and 1 are the same, of discs 0 and 1 (its springs would count twice)"},
      {"twice, the other way round", [](Datasets& d) { d["contacts"].whole[8] = 2, d["contacts"].whole[9] = 0; },
       "a.h5: contacts[2]: contacts 1 and 2 are the same, of discs 0 and 2"},
      {"negative radius", [](Datasets& d) { d["discs"].real[8] = -0.5; },
       "a.h5: disc 2 has the radius -0.5 (radii must be positive and finite)"},
      {"levers of another number",
       [](Datasets& d) {
         d["levers"] = {{1, 2}, {0.5, 0.5}, {}};
       },
       "a.h5: levers: 1 row for 3 contacts (there must be one for each)"},
      {"springs without contacts",
       [](Datasets& d) {
         d.erase("contacts"), d["springs"] = {{1, 2}, {1, 1}, {}};
       },
       "a.h5: springs: there are springs but no contacts"},
      {"normals alone",
       [](Datasets& d) {
         d["normals"] = {{3, 2}, std::vector<double>(6, 1.0), {}};
       },
       "a.h5: levers: the key 'levers' is missing"},
      {"cell areas below zero",
       [](Datasets& d) {
         d["cell_areas"] = {{3}, {1, 1, -1}, {}};
       },
       "a.h5: disc 2 has the cell area -1"},
      {"a group of no discs",
       [](Datasets& d) {
         d["groups/held/members"] = {{1}, {}, {1}};
       },
       "a.h5: groups/held: it is no group with a dataset 'discs'"},
      {"a group that descends",
       [](Datasets& d) {
         d["groups/held/discs"] = {{2}, {}, {1, 0}};
       },
       "a.h5: group 'held' names disc 0 after disc 1"},
      {"a group of too many",
       [](Datasets& d) {
         d["groups/held/discs"] = {{4}, {}, {0, 1, 2, 3}};
       },
       "a.h5: groups/held/discs: 4 rows for 3 discs"},
      {"a dataset for groups",
       [](Datasets& d) {
         d["groups"] = {{1}, {1}, {}};
       },
       "a.h5: groups: it is no group"},
  };
  REQUIRE(refusal_after([](Datasets&) {}) == "(accepted)");
  for (const Case& wrong : cases) {
    CAPTURE(wrong.fault);
    CHECK_THAT(refusal_after(wrong.change), Catch::Matchers::StartsWith(wrong.sentence));
  }
}

TEST_CASE("a_file_that_is_no_hdf5_file_of_this_version_is_refused") {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.h5";
  write_file(path, R"({"schema": "equidem-assembly/1", "discs": [[0, 0, 1]]})", true);
  CHECK_THAT(refusal(path), Catch::Matchers::StartsWith("a.h5: this is no HDF5 file"));
  write_file(path, "", true);
  CHECK_THAT(refusal(path), Catch::Matchers::StartsWith("a.h5: this is no HDF5 file"));
  write_datasets(path, three_discs(), "equidem-assembly/2");
  CHECK(refusal(path) ==
        "a.h5: schema: the schema is \"equidem-assembly/2\" (an assembly file has the text attribute schema = "
        "\"equidem-assembly/1\"). Read it with the version of equidem that wrote it.");
  write_datasets(path, three_discs(), "");
  CHECK_THAT(refusal(path), Catch::Matchers::StartsWith("a.h5: schema: the key 'schema' is missing"));
  CHECK_THAT(refusal(folder / "other/a.h5"), Catch::Contains("there is no such file"));
  fs::remove(path);
  fs::create_directory(path);
  CHECK_THAT(refusal(path), Catch::Contains("it is a folder"));
}

TEST_CASE("an_hdf5_file_that_ends_early_is_refused_wherever_it_ends") {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.h5";
  write_assembly(path, delaunay_assembly({.discs = 50}), false);
  const std::string whole = read_file(path);
  for (std::size_t length = 0; length < whole.size(); length += 97) {
    CAPTURE(length, whole.size());
    write_file(path, whole.substr(0, length), true);
    CHECK_THAT(refusal(path), Catch::Contains("a.h5: ") && Catch::Contains("HDF5"));
  }
}

TEST_CASE("an_hdf5_file_that_cannot_be_written_leaves_nothing_behind") {
  const TemporaryFolder folder;
  const Assembly assembly = hexagonal_lattice({.columns = 4, .rows = 4, .periodic = true});
  const auto sentence = [&](const fs::path& path, const Assembly& written) {
    try {
      write_assembly(path, written, false);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("(written)");
  };
  write_file(folder / "file", "", false);
  CHECK_THAT(sentence(folder / "file/a.h5", assembly), Catch::Contains("cannot write"));
  CHECK_THAT(sentence("/dev/full/a.h5", assembly), Catch::Contains("cannot write"));
  Assembly grouped = assembly;
  grouped.groups["left/right"].discs = {0};
  CHECK_THAT(sentence(folder / "a.h5", grouped), Catch::Contains("the group 'left/right' cannot be written"));
  CHECK(std::distance(fs::directory_iterator(folder / ""), fs::directory_iterator()) == 1);
  fs::create_symlink(folder / "real.h5", folder / "link.h5");
  write_file(folder / "real.h5", "", false);
  write_assembly(folder / "link.h5", assembly, true);
  CHECK(fs::is_symlink(folder / "link.h5"));
  CHECK(read_assembly(folder / "real.h5").size() == assembly.size());
}
