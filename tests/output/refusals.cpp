// SPDX-License-Identifier: GPL-3.0-or-later
// Every writer: no file is overwritten unless asked, no partial file stays.
#include <functional>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/output/files/body_tables.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/vtk.hpp"
#include "equidem/output/pictures/picture.hpp"
#include "equidem/output/plots/plot.hpp"

#include "output/states.hpp"
#include "support/catch.hpp"

using namespace equidem;
namespace fs = std::filesystem;

namespace {

struct Writer {
  const char* name;
  std::function<void(const fs::path& folder, bool overwrite)> write;
};

std::vector<Writer> writers(const MadeUpState& state) {
  const Plot plot{.title = "t", .series = {{.label = "s", .x = {0, 1}, .y = {1, 2}}}};
  return {
      {"table", [](const fs::path& f, bool o) { write_csv(f / "t.csv", Table().add("x", std::vector<double>{1}), o); }},
      {"disc table", [&](const fs::path& f, bool o) { write_disc_csv(f / "d.csv", state.view(), o); }},
      {"contact table", [&](const fs::path& f, bool o) { write_contact_csv(f / "c.csv", state.view(), o); }},
      {"VTK", [&](const fs::path& f, bool o) { write_vtk(f, "v", state.view(), o); }},
      {"plot", [plot](const fs::path& f, bool o) { write_plot(f, "p", plot, o); }},
      {"picture", [&](const fs::path& f, bool o) { write_picture(f, "q", state.view(), {}, o); }},
  };
}

}  // namespace

TEST_CASE("nothing_is_overwritten_unasked") {
  const MadeUpState state = stretched_block(3, 2);
  for (const Writer& writer : writers(state)) {
    CAPTURE(writer.name);
    const TemporaryFolder folder;
    writer.write(folder.path(), false);
    std::vector<fs::path> written;
    for (const auto& entry : fs::directory_iterator(folder.path())) written.push_back(entry.path());
    // One existing file is enough to refuse all.
    for (const fs::path& kept : written) {
      CAPTURE(kept);
      for (const fs::path& path : written) fs::remove(path);
      write_file(kept, "precious", false);
      CHECK_THROWS_WITH(writer.write(folder.path(), false), Catch::Contains("exists already"));
      CHECK(read_file(kept) == "precious");
      CHECK(folder.files() == 1);
    }
    CHECK_NOTHROW(writer.write(folder.path(), true));
    CHECK(folder.files() == written.size());
  }
}

TEST_CASE("a_place_that_cannot_be_written_to_is_named_and_nothing_is_left") {
  const MadeUpState state = stretched_block(3, 2);
  for (const Writer& writer : writers(state)) {
    CAPTURE(writer.name);
    const TemporaryFolder folder;
    write_file(folder / "file", "not a folder", false);
    CHECK_THROWS_WITH(writer.write(folder / "file" / "below", false),
                      Catch::Contains("cannot write") && Catch::Contains("is not a folder"));
    CHECK(folder.files() == 1);
  }
}
