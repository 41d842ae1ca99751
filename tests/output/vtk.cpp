// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/vtk.hpp"

#include <algorithm>

#include "equidem/core/file.hpp"
#include "equidem/output/files/body_tables.hpp"

#include "output/states.hpp"
#include "support/catch.hpp"

using namespace equidem;

TEST_CASE("vtk_reads_our_files_back_to_the_same_bits") {
  struct Case {
    const char* name;
    MadeUpState state;
  };
  Assembly alone;
  alone.kind = "file";
  alone.centres = {{0.25, 0.5}};
  alone.radii = {0.125};
  alone.cell_areas = {0.0625};
  const Case cases[] = {{"free", stretched_block()},
                        {"periodic", stretched_block(4, 4, true)},
                        {"a name & <more>", stretched_block(3, 2)},
                        {"one disc, no contact", made_up(alone, {1e-3, 0, 0, 0})}};
  for (const auto& [name, state] : cases) {
    CAPTURE(name);
    const TemporaryFolder folder;
    write_disc_csv(folder / "discs.csv", state.view(), false);
    write_contact_csv(folder / "contacts.csv", state.view(), false);
    const auto paths = write_vtk(folder.path(), name, state.view(), false);
    REQUIRE(paths.size() == 3);
    const int outcome = run_python("read_with_vtk.py", {folder.path().string(), name});
    if (outcome == 77) {
      WARN("not tested: the Python module of VTK (python3-vtk9) is missing");
      return;
    }
    CHECK(outcome == 0);
  }
}

TEST_CASE("vtk_files_are_as_long_as_they_say") {
  const MadeUpState state = stretched_block(4, 4, true);
  const std::size_t n = state.assembly.size(), m = state.assembly.contacts.size();
  const TemporaryFolder folder;
  write_vtk(folder.path(), "block", state.view(), false);
  const auto appended = [&](const char* name) {
    const std::string text = read_file(folder / name);
    const std::size_t start = text.find("encoding=\"raw\">") + 15;
    return text.rfind("\n  </AppendedData>") - (text.find('_', start) + 1);
  };
  // One length (8 bytes) per array, then its numbers.
  CHECK(appended("block_discs.vtp") == 12 * 8 + 8 * n * (3 + 3 + 8) + 2 * 4 * n);
  const auto& contacts = state.assembly.contacts;
  const auto images = static_cast<std::size_t>(
      std::ranges::count_if(contacts, [](const Contact& c) { return c.shift_x != 0 || c.shift_y != 0; }));
  CHECK(images > 0);
  CHECK(appended("block_contacts.vtp") == 11 * 8 + 8 * (n + images) * (1 + 3 + 3) + 8 * m * (3 + 3 + 2) + 5 * 4 * m);
}
