// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/frames.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "equidem/core/file.hpp"
#include "equidem/core/random.hpp"
#include "equidem/output/files/body_tables.hpp"

#include "output/runs.hpp"
#include "output/states.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using equidem::test::refusal_of;

namespace {

const std::vector<std::string> names = {"frames", "time", "step", "displacement", "rotation", "velocity", "spin"};

Assembly block() {
  return hexagonal_lattice({.columns = 6, .rows = 5});
}

void append(FrameWriter& writer, const Assembly& assembly, std::int64_t step) {
  writer.append(step, time_at(step), motions_at(step, assembly.size()), velocities_at(step, assembly.size()));
}

/// Frames read from a file.
struct FoundFrames {
  std::int64_t finished = 0;
  std::uint64_t room = 0;
  std::vector<double> times;        ///< of all allocated frames
  std::vector<std::int64_t> steps;  ///< likewise
  std::int64_t wrong = 0;           ///< numbers of finished frames that differ from those of their step
};

template <typename Number>
std::vector<Number> numbers_of(const OpenFile& file, const Hdf5Array& array) {
  std::vector<Number> numbers(array.size());
  file.read_at(array.offset, std::as_writable_bytes(std::span(numbers)));
  return numbers;
}

FoundFrames read_frames(const std::filesystem::path& path, std::size_t discs) {
  const Hdf5Layout layout = read_hdf5_layout(path, names);
  const OpenFile file(path, OpenFile::Mode::read);
  FoundFrames found;
  found.finished = numbers_of<std::int64_t>(file, layout["frames"])[0];
  found.times = numbers_of<double>(file, layout["time"]);
  found.steps = numbers_of<std::int64_t>(file, layout["step"]);
  found.room = found.times.size();
  const auto u = numbers_of<double>(file, layout["displacement"]), v = numbers_of<double>(file, layout["velocity"]);
  const auto rotation = numbers_of<double>(file, layout["rotation"]), spin = numbers_of<double>(file, layout["spin"]);
  for (std::int64_t k = 0; k < found.finished; ++k) {
    const auto frame = static_cast<std::size_t>(k);
    const std::int64_t step = found.steps[frame];
    const auto motions = motions_at(step, discs), velocities = velocities_at(step, discs);
    found.wrong += found.times[frame] != time_at(step);
    for (std::size_t d = 0; d < discs; ++d) {
      const std::size_t at = frame * discs + d;
      found.wrong += u[3 * at] != motions[d].u.x || u[3 * at + 1] != motions[d].u.y || u[3 * at + 2] != 0;
      found.wrong += v[3 * at] != velocities[d].u.x || v[3 * at + 1] != velocities[d].u.y || v[3 * at + 2] != 0;
      found.wrong += rotation[at] != motions[d].theta || spin[at] != velocities[d].theta;
    }
  }
  return found;
}

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

}  // namespace

TEST_CASE("frames_read_back_by_other_readers_to_the_same_bits") {
  struct Case {
    const char* name;
    Assembly assembly;
    std::int64_t expected;
    bool finished = true;
  };
  Assembly alone;
  alone.kind = "file";
  alone.centres = {{0.25, 0.5}};
  alone.radii = {0.125};
  const Case cases[] = {{"free", block(), 5},
                        {"periodic", hexagonal_lattice({.columns = 4, .rows = 4, .periodic = true}), 5},
                        {"more frames than expected", block(), 1},
                        {"fewer frames than expected", block(), 100, false},
                        {"a name & <more>", block(), 100},
                        {"one disc, no contact", alone, 5}};
  for (const auto& [name, assembly, expected, finished] : cases) {
    CAPTURE(name, finished);
    const TemporaryFolder folder;
    FrameWriter writer(folder.path(), name, assembly, {.expected = expected});
    for (const std::int64_t step : {0, 10, 20, 35, 40}) {
      append(writer, assembly, step);
      const auto motions = motions_at(step, assembly.size()), velocities = velocities_at(step, assembly.size());
      write_disc_csv(folder / fmt::format("motion_{}.csv", step), {assembly, motions}, false);
      write_disc_csv(folder / fmt::format("velocity_{}.csv", step), {assembly, velocities}, false);
    }
    if (finished) writer.finish();
    write_contact_csv(folder / "contacts.csv", {assembly}, false);
    const int outcome = run_python("read_frames.py", {folder.path().string(), name});
    if (outcome == 77) {
      WARN("not tested: the Python module h5py (python3-h5py) is missing");
      return;
    }
    CHECK(outcome == 0);
  }
}

TEST_CASE("only_places_of_numbers_change_as_frames_are_added") {
  const Assembly assembly = block();
  const TemporaryFolder folder;
  FrameWriter writer(folder.path(), "run", assembly, {.expected = 4});
  const std::string before = read_file(folder / "run.h5");
  for (std::int64_t step = 0; step < 4; ++step) append(writer, assembly, step);
  const std::string after = read_file(folder / "run.h5");
  REQUIRE(before.size() == after.size());
  std::vector<char> is_number(after.size(), 0);
  for (const Hdf5Array& array : read_hdf5_layout(folder / "run.h5", names).arrays) {
    REQUIRE(array.offset + array.bytes() <= after.size());
    std::fill_n(is_number.begin() + static_cast<std::ptrdiff_t>(array.offset), array.bytes(), 1);
  }
  std::size_t numbers = 0, structure = 0;
  for (std::size_t k = 0; k < after.size(); ++k) {
    if (before[k] != after[k]) ++(is_number[k] != 0 ? numbers : structure);
  }
  CAPTURE(numbers, structure);
  CHECK(numbers > 4 * assembly.size() * 6 * 6);
  CHECK(structure == 0);
}

TEST_CASE("the_same_frames_make_the_same_bytes") {
  const Assembly assembly = block();
  const TemporaryFolder folder;
  for (const char* place : {"a", "b"}) {
    FrameWriter writer(folder / place, "run", assembly, {.expected = place[0] == 'a' ? 7 : 2});
    for (std::int64_t step = 0; step < 5; ++step) append(writer, assembly, step);
    writer.finish();
  }
  CHECK(read_file(folder / "a/run.h5") == read_file(folder / "b/run.h5"));
  CHECK(read_file(folder / "a/run.xdmf2") == read_file(folder / "b/run.xdmf2"));
}

TEST_CASE("a_killed_run_leaves_all_finished_frames_readable") {
  // Room for two frames: the process is also killed while the file grows.
  const Assembly assembly = block();
  Random random(11);
  std::int64_t most = 0, least = 1 << 30;
  std::uint64_t longest = 40000;  // microseconds; longer where no work is finished in that time
  for (int round = 0; round < 50; ++round) {
    const TemporaryFolder folder;
    FrameWriter writer(folder.path(), "run", assembly, {.expected = 2});
    append(writer, assembly, 0);
    const FileMark mark = writer.mark();
    kill_during(
        [&] {
          for (std::int64_t step = 1;; ++step) append(writer, assembly, step);
        },
        static_cast<unsigned>(random.below(longest)));
    const FoundFrames found = read_frames(folder / "run.h5", assembly.size());
    CAPTURE(round, found.finished, found.room);
    REQUIRE(found.finished >= 1);
    CHECK(found.wrong == 0);
    for (std::int64_t k = 0; k < found.finished; ++k) REQUIRE(found.steps[static_cast<std::size_t>(k)] == k);
    const std::string index = read_file(folder / "run.xdmf2");
    const auto listed = static_cast<std::int64_t>(occurrences(index, "<Time "));
    CAPTURE(listed);
    CHECK(index.ends_with("</Xdmf>\n"));
    CHECK(listed <= found.finished);
    // With many frames the index is written after every few frames: the last percent may be missing.
    CHECK(listed >= found.finished - 1 - found.finished / 100);
    most = std::max(most, found.finished);
    least = std::min(least, found.finished);
    if (found.finished == 1) longest = std::min<std::uint64_t>(longest + longest / 4, 300000);

    FrameWriter resumed(folder.path(), "run", assembly, {.continue_from = mark});
    CHECK(resumed.frames() == 1);
    append(resumed, assembly, 1);
    resumed.finish();
    const FoundFrames whole = read_frames(folder / "run.h5", assembly.size());
    CHECK(whole.finished == 2);
    CHECK(whole.room == static_cast<std::uint64_t>(whole.finished));
    CHECK(whole.wrong == 0);
  }
  INFO("between " << least << " and " << most << " frames were finished");
  CHECK(most > least + 3);  // the kills came at different moments
}

TEST_CASE("a_run_that_goes_on_drops_later_frames") {
  const Assembly assembly = block();
  const std::int64_t kept = GENERATE(0, 1, 4, 5);
  CAPTURE(kept);
  const TemporaryFolder folder;
  FileMark mark;
  {
    FrameWriter writer(folder.path(), "run", assembly, {.expected = 8});
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
    const FoundFrames found = read_frames(folder / "run.h5", assembly.size());
    CHECK(found.finished == kept);
    CHECK(std::all_of(found.times.begin() + kept, found.times.end(), [](double t) { return std::isnan(t); }));
    CHECK(occurrences(read_file(folder / "run.xdmf2"), "<Time ") == static_cast<std::size_t>(kept));
    for (std::int64_t step = 100; step < 110; ++step) append(writer, assembly, step);
    writer.finish();
  }
  const FoundFrames found = read_frames(folder / "run.h5", assembly.size());
  CHECK(found.finished == kept + 10);
  CHECK(found.room == static_cast<std::uint64_t>(kept) + 10);
  CHECK(found.wrong == 0);
  CHECK(found.steps.back() == 109);
  CHECK(occurrences(read_file(folder / "run.xdmf2"), "<Time ") == static_cast<std::size_t>(kept) + 10);
}

TEST_CASE("the_index_keeps_up_with_many_frames") {
  Assembly alone;
  alone.centres = {{0, 0}};
  alone.radii = {1};
  const TemporaryFolder folder;
  FrameWriter writer(folder.path(), "run", alone, {.expected = 500});
  for (std::int64_t step = 0; step < 500; ++step) {
    append(writer, alone, step);
    if (step % 7 != 0) continue;
    const std::size_t listed = occurrences(read_file(folder / "run.xdmf2"), "<Time ");
    CAPTURE(step, listed);
    CHECK(static_cast<double>(listed) >= 0.995 * static_cast<double>(step + 1) - 1);
  }
  writer.finish();
  CHECK(occurrences(read_file(folder / "run.xdmf2"), "<Time ") == 500);
}

TEST_CASE("frames_of_another_assembly_are_refused") {
  const Assembly assembly = block();
  Assembly moved = assembly;
  moved.centres[7].x = std::nextafter(moved.centres[7].x, 1.0);
  Assembly other = hexagonal_lattice({.columns = 7, .rows = 5});
  const TemporaryFolder folder;
  FileMark mark;
  {
    FrameWriter writer(folder.path(), "run", assembly, {});
    append(writer, assembly, 0);
    mark = writer.mark();
  }
  const auto go_on = [&](const std::string& name, const Assembly& with) {
    return refusal_of([&] { FrameWriter(folder.path(), name, with, {.continue_from = mark}); });
  };
  write_file(folder / "text.h5", "no HDF5", false);
  const std::string whole = read_file(folder / "run.h5");
  write_file(folder / "cut.h5", std::string_view(whole).substr(0, whole.size() / 2), false);
  write_hdf5_layout(folder / "foreign.h5", {.attributes = {}, .arrays = {{"x", Hdf5Number::float64, {3}}}});

  CHECK(go_on("run", moved).says("its discs are others"));
  CHECK(go_on("run", other).says(fmt::format("it has {} discs, not {}", assembly.size(), other.size())));
  CHECK(go_on("text", assembly).says("it holds no frames"));
  CHECK(go_on("cut", assembly).says("it ends after"));
  CHECK(go_on("foreign", assembly).says("it holds no frames"));
  CHECK(go_on("absent", assembly).says("there is no such file"));
  CHECK(go_on("run", assembly).message.empty());
}

TEST_CASE("damaged_frames_are_refused_or_damaged_in_nothing_that_counts") {
  Assembly assembly;
  assembly.centres = {{0, 0}, {2, 0}};
  assembly.radii = {1, 1};
  assembly.contacts = {{.i = 0, .j = 1}};
  const TemporaryFolder folder;
  const auto path = folder / "run.h5";
  FileMark mark;
  {
    FrameWriter writer(folder.path(), "run", assembly, {.expected = 5});
    for (std::int64_t step = 0; step < 5; ++step) append(writer, assembly, step);
    mark = writer.mark();
  }
  const std::string good = read_file(path);
  Random random(12);
  std::int64_t refused = 0;
  for (std::size_t at = 0; at < good.size(); at += 29) {  // 29: all bytes of a double in turn
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ static_cast<char>(1U << random.below(8)));
    write_file(path, bad, true);
    const auto refusal =
        refusal_of([&] { FrameWriter(folder.path(), "run", assembly, {.continue_from = mark}).finish(); });
    CAPTURE(at, refusal.message);
    const bool same = read_file(path) == good;
    REQUIRE(same == refusal.message.empty());
    refused += same ? 0 : 1;
  }
  CHECK(refused > 5 * 2 * 8 * 8 / 29);  // the numbers of all frames, and more
  for (std::size_t size = 0; size < good.size(); size += 371) {
    write_file(path, good.substr(0, size), true);
    CAPTURE(size);
    REQUIRE(refusal_of([&] { FrameWriter(folder.path(), "run", assembly, {.continue_from = mark}); }).kind ==
            ErrorKind::bad_input);
  }
}

TEST_CASE("frames_are_not_overwritten_unasked") {
  const Assembly assembly = block();
  const TemporaryFolder folder;
  const std::string name = GENERATE("run.h5", "run.xdmf2");
  write_file(folder / name, "mine", false);
  const auto refusal = refusal_of([&] { FrameWriter(folder.path(), "run", assembly, {}); });
  CHECK(refusal.says("exists already"));
  CHECK(read_file(folder / name) == "mine");
  CHECK(folder.files() == 1);
  FrameWriter(folder.path(), "run", assembly, {.overwrite = true}).finish();
  CHECK(read_file(folder / name) != "mine");
}

TEST_CASE("a_full_disk_costs_no_finished_frame") {
  const Assembly assembly = block();
  const TemporaryFolder folder;
  const std::string message = error_on_full_disk(
      [&] {
        FrameWriter writer(folder.path(), "run", assembly, {.expected = 3});
        for (std::int64_t step = 0;; ++step) append(writer, assembly, step);
      },
      20000);
  INFO(message);
  CHECK(message.find("cannot write '") == 0);
  CHECK(message.find("run.h5") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(folder / "run.h5.part"));
  CHECK(message.find("Make room on its disk") != std::string::npos);
  const FoundFrames found = read_frames(folder / "run.h5", assembly.size());
  CHECK(found.finished > 0);
  CHECK(found.wrong == 0);
}
