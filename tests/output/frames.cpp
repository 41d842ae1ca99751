// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// States and motions in files of VTK.
#include "equidem/output/files/frames.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "equidem/core/file.hpp"
#include "equidem/core/random.hpp"
#include "equidem/output/files/body_tables.hpp"
#include "equidem/output/files/vtk.hpp"

#include "output/poly_data_reader.hpp"
#include "output/runs.hpp"
#include "output/states.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using equidem::test::refusal_of;

namespace {

Assembly block() {
  return hexagonal_lattice({.columns = 6, .rows = 5});
}

/// Forces that are a function of the step.
std::vector<ContactForce> forces_at(std::int64_t step, std::size_t contacts) {
  std::vector<ContactForce> forces;
  for (const DiscMotion& numbers : motions_at(2000 + step, contacts)) forces.push_back({numbers.u.x, numbers.u.y});
  return forces;
}

std::vector<BodyContact> contacts_at(std::int64_t step, const Assembly& assembly) {
  const std::vector<ContactForce> forces = forces_at(step, assembly.contacts.size());
  std::vector<BodyContact> contacts;
  for (std::size_t c = 0; c < forces.size(); ++c) contacts.push_back(bonded_contact(assembly, c, forces[c]));
  return contacts;
}

void append(FrameWriter& writer, const Assembly& assembly, std::int64_t step) {
  writer.append(step, time_at(step), motions_at(step, assembly.size()), velocities_at(step, assembly.size()),
                contacts_at(step, assembly));
}

/// Frames that a list names.
struct FoundFrames {
  std::vector<std::int64_t> steps;
  std::int64_t wrong = 0;  ///< numbers that differ from those of their step
  [[nodiscard]] std::int64_t count() const { return static_cast<std::int64_t>(steps.size()); }
};

FoundFrames read_frames(const std::filesystem::path& list, const Assembly& assembly) {
  FoundFrames found;
  for (const ListedFrame& frame : frames_of(list)) {
    found.steps.push_back(frame.step);
    found.wrong += frame.time != time_at(frame.step);
    auto discs = arrays_of(frame.discs), network = arrays_of(frame.contacts);
    const auto motions = motions_at(frame.step, assembly.size()),
               velocities = velocities_at(frame.step, assembly.size());
    const auto &u = discs["displacement"], &v = discs["velocity"];
    for (std::size_t d = 0; d < assembly.size(); ++d) {
      found.wrong += u[3 * d] != motions[d].u.x || u[3 * d + 1] != motions[d].u.y || u[3 * d + 2] != 0;
      found.wrong += v[3 * d] != velocities[d].u.x || v[3 * d + 1] != velocities[d].u.y || v[3 * d + 2] != 0;
      found.wrong += discs["rotation"][d] != motions[d].theta || discs["spin"][d] != velocities[d].theta;
    }
    const auto forces = forces_at(frame.step, assembly.contacts.size());
    for (std::size_t c = 0; c < forces.size(); ++c) {
      found.wrong += network["normal_force"][c] != forces[c].normal;
      found.wrong += network["tangential_force"][c] != forces[c].tangential;
    }
  }
  return found;
}

/// Files of frames, listed or not.
std::size_t files_in(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

}  // namespace

TEST_CASE("frames_are_read_by_vtk_to_the_same_bits") {
  struct Case {
    const char* name;
    Assembly assembly;
  };
  Assembly alone;
  alone.kind = "file";
  alone.centres = {{0.25, 0.5}};
  alone.radii = {0.125};
  const Case cases[] = {{"free", block()},
                        {"periodic", hexagonal_lattice({.columns = 4, .rows = 4, .periodic = true})},
                        {"a name & <more>", block()},
                        {"one disc, no contact", alone}};
  for (const auto& [name, assembly] : cases) {
    CAPTURE(name);
    const TemporaryFolder folder;
    FrameWriter writer(folder.path(), name, assembly, {});
    for (const std::int64_t step : {0, 10, 20, 35, 40}) {
      append(writer, assembly, step);
      const auto motions = motions_at(step, assembly.size()), velocities = velocities_at(step, assembly.size());
      const auto forces = forces_at(step, assembly.contacts.size());
      write_disc_csv(folder / fmt::format("motion_{}.csv", step), {assembly, motions}, false);
      write_disc_csv(folder / fmt::format("velocity_{}.csv", step), {assembly, velocities}, false);
      write_contact_csv(folder / fmt::format("contacts_{}.csv", step), {assembly, {}, forces}, false);
    }
    const int outcome = run_python("read_frames.py", {folder.path().string(), name});
    if (outcome == 77) {
      WARN("not tested: the Python module of VTK (python3-vtk9) is missing");
      return;
    }
    CHECK(outcome == 0);
  }
}

TEST_CASE("contacts_that_come_and_go_are_lines_from_centre_to_centre_or_wall") {
  Assembly start;
  start.centres = {{0, 1}, {2, 1}, {5, 1}};
  start.radii = {1, 1, 1};
  const TemporaryFolder folder;
  const std::vector<DiscMotion> places{{{0, 0.9}}, {{1.9, 1}}, {{5, 1}}}, still(3);
  const std::vector<BodyContact> contacts{
      {.i = 0, .j = 1, .arm = {0.95, 0.05}, .force = {-10, 2}, .normal_force = -10, .tangential_force = -1},
      {.i = 0, .j = ~2, .arm = {0, -0.9}, .force = {0, 7}, .normal_force = -7}};
  FrameWriter writer(folder.path(), "frames", start, {.travelling = true});
  writer.append(0, 0, places, still, {});
  writer.append(7, 0.5, places, still, contacts);
  writer.finish();
  const auto frames = frames_of(folder / "frames.pvd");
  REQUIRE(frames.size() == 2);
  CHECK(arrays_of(frames[0].contacts)["i"].empty());
  auto network = arrays_of(frames[1].contacts);
  CHECK(network["Points"] == std::vector<double>{0, 0.9, 0, 1.9, 1, 0, 5, 1, 0, 0, 0, 0});
  CHECK(network["connectivity"] == std::vector<double>{0, 1, 0, 3});
  CHECK(network["j"] == std::vector<double>{1, -3});  // wall 2
  CHECK(network["contact_point"] == std::vector<double>{0.95, 0.9 + 0.05, 0, 0, 0, 0});
  CHECK(network["force"] == std::vector<double>{-10, 2, 0, 0, 7, 0});
  CHECK(network["normal_force"] == std::vector<double>{10, 7});
  CHECK(network["tangential_force"] == std::vector<double>{1, 0});
  CHECK(network.count("displacement") == 0);
}

TEST_CASE("the_estimated_size_of_a_frame_is_its_size") {
  const Assembly assembly = hexagonal_lattice({.columns = 60, .rows = 50});
  for (const bool with_contacts : {true, false}) {
    const TemporaryFolder folder;
    const FrameOptions options{.contacts = with_contacts};
    FrameWriter writer(folder.path(), "run", assembly, options);
    append(writer, assembly, 0);
    double bytes = 0;
    for (const auto& file : std::filesystem::directory_iterator(folder / "run"))
      bytes += static_cast<double>(file.file_size());
    const double estimated =
        bytes_of_frame(static_cast<double>(assembly.size()), static_cast<double>(assembly.contacts.size()), options);
    CHECK(bytes == Approx(estimated).epsilon(0.02));
    CHECK(files_in(folder / "run") == (with_contacts ? 2 : 1));
  }
}

TEST_CASE("an_earlier_run_leaves_no_trace_in_one_that_replaces_it") {
  const Assembly assembly = block();
  const TemporaryFolder folder;
  for (const char* place : {"a", "b"}) {
    if (place[0] == 'b') {
      FrameWriter earlier(folder / place, "run", assembly, {});
      for (const std::int64_t step : {2, 3, 100}) append(earlier, assembly, step);
    }
    FrameWriter writer(folder / place, "run", assembly, {.overwrite = true});
    for (std::int64_t step = 0; step < 5; ++step) append(writer, assembly, step);
    writer.finish();
  }
  CHECK(read_file(folder / "a/run.pvd") == read_file(folder / "b/run.pvd"));
  CHECK(files_in(folder / "a/run") == files_in(folder / "b/run"));
  for (const auto& file : std::filesystem::directory_iterator(folder / "a/run"))
    CHECK(read_file(file.path()) == read_file(folder / "b/run" / file.path().filename()));
}

TEST_CASE("a_run_that_goes_on_drops_later_frames") {
  const Assembly assembly = block();
  const std::int64_t kept = GENERATE(0, 1, 4, 5);
  CAPTURE(kept);
  const TemporaryFolder folder;
  FileMark mark;
  {
    FrameWriter writer(folder.path(), "run", assembly, {});
    mark = writer.mark();
    for (const std::int64_t step : {0, 5, 10, 15, 20}) {
      append(writer, assembly, step);
      if (writer.frames() == kept) mark = writer.mark();
    }
  }
  {
    FrameWriter writer(folder.path(), "run", assembly, {.continue_from = mark});
    CHECK(writer.frames() == kept);
    CHECK(writer.last_step() == (kept == 0 ? -1 : 5 * (kept - 1)));
    CHECK(read_frames(folder / "run.pvd", assembly).count() == kept);
    CHECK(files_in(folder / "run") == 2 * static_cast<std::size_t>(kept));
    for (std::int64_t step = 100; step < 110; ++step) append(writer, assembly, step);
    writer.finish();
  }
  const FoundFrames found = read_frames(folder / "run.pvd", assembly);
  CHECK(found.count() == kept + 10);
  CHECK(found.wrong == 0);
  CHECK(found.steps.back() == 109);
  CHECK(files_in(folder / "run") == 2 * static_cast<std::size_t>(kept + 10));
}

TEST_CASE("the_list_keeps_up_with_many_frames_and_is_whole_at_a_checkpoint") {
  Assembly alone;
  alone.centres = {{0, 0}};
  alone.radii = {1};
  const TemporaryFolder folder;
  FrameWriter writer(folder.path(), "run", alone, {.contacts = false});
  const auto listed = [&] { return frames_of(folder / "run.pvd").size(); };
  for (std::int64_t step = 0; step < 500; ++step) {
    append(writer, alone, step);
    if (step % 50 == 7) CHECK(static_cast<double>(listed()) >= 0.995 * static_cast<double>(step + 1) - 1);
    if (step == 450) {
      writer.sync();
      CHECK(listed() == 451);
    }
  }
  writer.finish();
  CHECK(listed() == 500);
}

TEST_CASE("frames_of_another_assembly_are_refused") {
  const Assembly assembly = block();
  Assembly moved = assembly;
  moved.centres[7].x = std::nextafter(moved.centres[7].x, 1.0);
  const Assembly other = hexagonal_lattice({.columns = 7, .rows = 5});
  const TemporaryFolder folder;
  FileMark mark;
  {
    FrameWriter writer(folder.path(), "run", assembly, {});
    append(writer, assembly, 0);
    mark = writer.mark();
  }
  const auto go_on = [&](const std::string& name, const Assembly& with, bool contacts = true) {
    return refusal_of([&] { FrameWriter(folder.path(), name, with, {.contacts = contacts, .continue_from = mark}); });
  };
  write_file(folder / "text.pvd", "no list", false);
  const std::string whole = read_file(folder / "run.pvd");
  write_file(folder / "cut.pvd", std::string_view(whole).substr(0, whole.size() / 2), false);

  CHECK(go_on("run", moved).says("discs or frame_contacts are others"));
  CHECK(go_on("run", other).says("discs or frame_contacts are others"));
  CHECK(go_on("run", assembly, false).says("discs or frame_contacts are others"));
  CHECK(go_on("text", assembly).says("it lists no frames"));
  CHECK(go_on("cut", assembly).says("it lists 0 of 1 frames"));
  CHECK(go_on("absent", assembly).says("there is no such file"));
  CHECK(go_on("run", assembly).message.empty());
  std::filesystem::remove(folder / "run/contacts_000000000.vtp");
  CHECK(go_on("run", assembly).says("contacts_000000000.vtp"));
}

TEST_CASE("frames_are_not_overwritten_unasked") {
  const Assembly assembly = block();
  const TemporaryFolder folder;
  const std::string name = GENERATE("run.pvd", "run/discs_000000020.vtp");
  write_file(folder / name, "mine", false);
  write_file(folder / "run/notes_000000020.vtp", "mine", false);
  const std::size_t before = folder.files();
  const auto refusal = refusal_of([&] { FrameWriter(folder.path(), "run", assembly, {}); });
  CHECK(refusal.says("exists already"));
  CHECK(read_file(folder / name) == "mine");
  CHECK(folder.files() == before);
  FrameWriter(folder.path(), "run", assembly, {.overwrite = true}).finish();
  CHECK(read_file(folder / "run/notes_000000020.vtp") == "mine");
  CHECK(frames_of(folder / "run.pvd").empty());
  CHECK_FALSE(std::filesystem::exists(folder / "run/discs_000000020.vtp"));
}

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
