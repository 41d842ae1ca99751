// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Every writer: no file is overwritten unless asked, no partial file stays, damaged files are not gone on with.
#include <functional>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/body_tables.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/vtk.hpp"
#include "equidem/output/pictures/picture.hpp"
#include "equidem/output/plots/plot.hpp"

#include "output/poly_data_reader.hpp"
#include "output/runs.hpp"
#include "output/states.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

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
      {"checkpoint",
       [](const fs::path& f, bool o) { CheckpointWriter(f / "k.h5", "case", o).write({state_at(5, 2)}); }},
      {"history",
       [](const fs::path& f, bool o) {
         const Probe probe{"a", {0}, {ProbeQuantity::rotation}};
         ProbeWriter(f / "h.csv", {probe}, 1, {.overwrite = o});
       }},
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

TEST_CASE("a_run_does_not_go_on_with_altered_or_truncated_files_and_leaves_them_as_they_are") {
  struct Kept {
    std::string file;
    std::function<void(const KeptRun&)> go_on;
    std::string refused;
    std::size_t stride;           ///< of the places that are damaged, from the first 600 on
    std::size_t not_counted = 0;  ///< bytes at the end
  };
  const auto checkpoint = [](const KeptRun& run) { read_checkpoint(run.folder / "run.checkpoint.h5", run.case_text); };
  const auto frames = [](const KeptRun& run) {
    FrameWriter(run.folder, "run", run.discs, {.continue_from = run.frames}).finish();
  };
  const auto history = [](const KeptRun& run) {
    ProbeWriter(run.folder / "history.csv", run.probes, 3, {.continue_from = run.history});
  };
  const auto samples = [](const KeptRun& run) {
    StoredTable(run.folder / "samples.csv", Table().add("value", std::vector<double>{}), "sweep", "Start afresh");
  };
  const TemporaryFolder folder;
  KeptRun run{folder.path()};
  run.write();
  write_samples(folder / "samples.csv", Table().add("value", std::vector{0.1, -2e-300, std::nan("")}));
  const std::size_t behind_mark = fs::file_size(folder / "history.csv") - run.history.length;
  const Kept kept =
      GENERATE_COPY(Kept{"run.checkpoint.h5", checkpoint, "cannot go on from '", 7},
                    Kept{"run.pvd", frames, "cannot add frames to '", 29, 60},
                    Kept{"run/discs_000000001.vtp", frames, "cannot add frames to '", 29},
                    Kept{"run/contacts_000000002.vtp", frames, "cannot add frames to '", 29},
                    Kept{"history.csv", history, "cannot go on with '", 13, behind_mark},
                    Kept{"samples.csv", samples, "samples.csv: the samples to continue cannot be read", 1});
  const fs::path path = folder / kept.file;
  const std::string good = read_file(path);
  const std::size_t counted = good.size() - kept.not_counted;
  const auto check_refused = [&](const std::string& bad, const std::string& words) {
    write_file(path, bad, true);
    const auto refusal = test::refusal_of([&] { kept.go_on(run); });
    CAPTURE(kept.file, words, refusal.message);
    REQUIRE(refusal.kind == ErrorKind::bad_input);
    REQUIRE(refusal.says(words));
    REQUIRE(refusal.says(kept.refused));
    REQUIRE(read_file(path) == bad);
  };
  Random random(9);
  const auto next = [&](std::size_t at) { return at + (at < 600 ? 1 : kept.stride); };
  for (std::size_t at = 0; at < counted; at = next(at)) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ static_cast<char>(1U << random.below(8)));
    CAPTURE(at);
    check_refused(bad, "");
  }
  for (std::size_t size = 0; size < counted && kept.file != "samples.csv"; size = next(size)) {
    const bool named = kept.file == "history.csv" || (kept.file == "run.checkpoint.h5" && size >= 512);
    check_refused(good.substr(0, size),
                  named ? fmt::format("it is truncated: {} bytes are left of {}", size, counted) : "");
  }
  if (kept.file == "run.checkpoint.h5") check_refused(good + "x", "altered");
  for (const std::string& end : {std::string(), std::string("5,1\nzero,1\n")}) {  // what nothing counts
    if (kept.file == "history.csv") write_file(path, good.substr(0, counted) + end, true);
    if (kept.file == "history.csv") CHECK_NOTHROW(kept.go_on(run));
  }
  write_file(path, good, true);
  CHECK_NOTHROW(kept.go_on(run));
  fs::remove(path);
  CHECK_FALSE(test::refusal_of([&] { kept.go_on(run); }).message.empty());
}

TEST_CASE("a_full_disk_is_named_and_costs_nothing_that_was_finished") {
  const TemporaryFolder folder;
  KeptRun run{folder.path()};
  run.write();
  const CheckpointWriter checkpoint(folder / "run.checkpoint.h5", run.case_text, true);
  checkpoint.write({state_at(5, 1000)});
  const std::size_t files = folder.files();
  for (const std::uint64_t limit : {100, 3000, 20000, 70000}) {
    const std::string message = error_on_full_disk([&] { checkpoint.write({state_at(6, 1000)}); }, limit);
    CAPTURE(limit, message);
    CHECK(message.starts_with("cannot write '"));
    CHECK(read_checkpoint(folder / "run.checkpoint.h5", run.case_text).state.step == 5);
    CHECK(folder.files() == files);
  }
  const auto check_named = [](const std::string& message) {
    INFO(message);
    CHECK(message.starts_with("cannot write '"));
    CHECK(message.find("Make room on its disk") != std::string::npos);
  };
  check_named(error_on_full_disk(
      [&] {
        ProbeWriter writer(run.folder / "history.csv", run.probes, 3, {.interval = 0, .overwrite = true});
        for (std::int64_t step = 0;; ++step) run.record(writer, step);
      },
      5000));
  check_named(error_on_full_disk(
      [&] {
        FrameWriter writer(run.folder, "run", run.discs, {.overwrite = true});
        for (std::int64_t step = 0;; ++step) run.append(writer, step);
      },
      10000));
  for (const auto& file : fs::recursive_directory_iterator(folder.path())) CHECK(file.path().extension() != ".part");
  const std::vector<ListedFrame> found = frames_of(folder / "run.pvd");
  CHECK(!found.empty());
  for (const ListedFrame& frame : found) {
    CHECK(frame.time == time_at(frame.step));
    CHECK(arrays_of(frame.discs)["rotation"][1] == motions_at(frame.step, 3)[1].theta);
    CHECK(arrays_of(frame.contacts)["normal_force"].front() == 1.0 + static_cast<double>(frame.step));
  }
}
