// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/checkpoint.hpp"

#include <algorithm>
#include <bit>
#include <span>
#include <string>

#include "equidem/core/checksum.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/files/open_file.hpp"
#include "equidem/core/random.hpp"

#include "output/runs.hpp"
#include "output/states.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using equidem::test::refusal_of;

namespace {

const std::string case_text = "title = \"tension\"\n[springs]\nkN = 1e9\nkT = 5e8\n[run]\nduration = 0.1\n";

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool same_bits(const SavedArray& a, const SavedArray& b) {
  return a.name == b.name && a.columns == b.columns &&
         std::ranges::equal(a.values, b.values, [](double p, double q) { return same_bits(p, q); });
}

bool same_bits(const SavedState& a, const SavedState& b) {
  return a.step == b.step && std::ranges::equal(a.arrays, b.arrays, [](const SavedArray& p, const SavedArray& q) {
           return same_bits(p, q);
         });
}

}  // namespace

TEST_CASE("a_checkpoint_reads_back_to_the_same_bits") {
  const TemporaryFolder folder;
  const std::size_t discs = GENERATE(0, 1, 1000);
  SavedState state = state_at(123456789012345, discs);
  if (discs > 1) {
    state["motions"][3] = -0.0;
    state["motions"][4] = 5e-324;
    state["motions"][5] = std::bit_cast<double>(0x7ff8000000000123ULL);
    state["previous"].clear();  // an integrator may not need it
  }
  const CheckpointWriter writer(folder / "deep/run.checkpoint.h5", case_text, false);
  writer.write({state});
  CHECK(same_bits(read_checkpoint(folder / "deep/run.checkpoint.h5", case_text).state, state));
  writer.write({state_at(7, discs)});
  CHECK(same_bits(read_checkpoint(folder / "deep/run.checkpoint.h5", case_text).state, state_at(7, discs)));
  CHECK(folder.files() == 2);  // the folder, and nothing besides the checkpoint
}

TEST_CASE("the_same_state_makes_the_same_checkpoint") {
  const TemporaryFolder folder;
  CheckpointWriter(folder / "a.h5", case_text, false).write({state_at(5, 20)});
  CheckpointWriter(folder / "b.h5", case_text, false).write({state_at(5, 20)});
  CHECK(read_file(folder / "a.h5") == read_file(folder / "b.h5"));
}

TEST_CASE("an_empty_case_has_a_checkpoint_too") {
  const TemporaryFolder folder;
  CheckpointWriter(folder / "a.h5", "", false).write({state_at(5, 20)});
  CHECK(same_bits(read_checkpoint(folder / "a.h5", "").state, state_at(5, 20)));
  CHECK(refusal_of([&] { read_checkpoint(folder / "a.h5", case_text); }).says("line 1: nothing there"));
}

TEST_CASE("a_checkpoint_of_another_case_is_refused_with_what_differs") {
  const TemporaryFolder folder;
  const auto path = folder / "run.checkpoint.h5";
  CheckpointWriter(path, case_text, false).write({state_at(5, 12)});
  const auto message_for = [&](const std::string& other) {
    return refusal_of([&] { read_checkpoint(path, other); }).message;
  };
  std::string other = case_text;
  other.replace(other.find("kT = 5e8"), 8, "kT = 3e8");
  CHECK_THAT(message_for(other),
             Catch::Contains("it belongs to another case: line 4: 'kT = 5e8' there, 'kT = 3e8' here"));
  CHECK_THAT(message_for(case_text + "step = 1\n"), Catch::Contains("line 7: nothing there, 'step = 1' here"));
  CHECK_THAT(message_for("a\nb\nc\nd\ne\nf\n"), Catch::Contains("line 3: 'kN = 1e9' there, 'c' here"));
  CHECK_THAT(message_for("a\nb\nc\nd\ne\nf\n"), !Catch::Contains("line 4"));
}

TEST_CASE("a_checkpoint_of_another_version_is_refused") {
  const TemporaryFolder folder;
  const auto path = folder / "run.checkpoint.h5";
  CheckpointWriter(path, case_text, false).write({state_at(5, 12)});
  std::string text = read_file(path);
  const std::string mark = "equidem-checkpoint/";
  const std::size_t begin = text.find(mark) + mark.size(), end = text.find('\n', begin);
  const std::string current = text.substr(begin, end - begin), other(current.size(), '0');
  REQUIRE(current != other);
  text.replace(begin, other.size(), other);
  write_file(path, text, true);
  const auto refusal = refusal_of([&] { read_checkpoint(path, case_text); });
  CAPTURE(current, refusal.message);
  CHECK(refusal.says(path.string()));
  CHECK(refusal.says("its format has version '" + other + "', and this library reads version " + current));
}

TEST_CASE("a_checkpoint_without_the_names_of_its_arrays_is_refused_by_what_it_lacks") {
  const TemporaryFolder folder;
  const auto path = folder / "run.checkpoint.h5";
  CheckpointWriter(path, case_text, false).write({state_at(5, 12)});
  std::string text = read_file(path);
  text.replace(text.find("energies"), 8, "energiez");  // its checksum is wrong: HDF5 leaves it out
  const std::size_t sum = text.find("fnv1a ");
  Checksum fits;
  for (const std::string& part : {text.substr(0, sum), text.substr(512)}) fits.add(std::as_bytes(std::span(part)));
  text.replace(sum + 6, 16, fits.text());
  write_file(path, text, true);
  const auto refusal = refusal_of([&] { read_checkpoint(path, case_text); });
  CAPTURE(refusal.message);
  CHECK(refusal.says(path.string()));
  CHECK(refusal.says("it has no attribute 'arrays'"));
}

TEST_CASE("what_is_no_checkpoint_is_refused") {
  const TemporaryFolder folder;
  const auto message_of = [&](const char* name) {
    return refusal_of([&] { read_checkpoint(folder / name, case_text); }).message;
  };
  write_file(folder / "empty", "", false);
  write_file(folder / "text", std::string(1000, 'x'), false);
  std::filesystem::create_directory(folder / "folder");
  CHECK_THAT(message_of("empty"), Catch::Contains("it is no checkpoint of equidem"));
  CHECK_THAT(message_of("text"), Catch::Contains("it is no checkpoint of equidem"));
  CHECK_THAT(message_of("folder"), Catch::Contains("it is no file"));
  CHECK_THAT(message_of("absent"), Catch::Contains("there is no such file"));
}

TEST_CASE("a_checkpoint_holds_its_case_the_record_of_the_run_so_far_and_the_marks_of_its_files") {
  const TemporaryFolder folder;
  const auto path = folder / "run.checkpoint.h5";
  const CheckpointWriter writer(path, case_text, false);
  const std::size_t bodies = GENERATE(0, 3);
  for (const std::int64_t count : {0, 1, 5}) {
    CAPTURE(count, bodies);
    RunRecord record;
    std::vector<FileMark> files;
    if (count > 1) {
      record.recorded = {{"throws", 3, {4, 7, 0.1}}, {"none", 2, {}}};
      files = {{"history.csv", 123456789012, UINT64_MAX}, {"frames.pvd", 0, 17}};
    }
    for (std::int64_t k = 0; k < count; ++k) {
      record.energies.push_back({8 * k, 0.1 * static_cast<double>(k), ledger_at(k)});
      if (bodies == 0) continue;
      record.paths.emplace_back(bodies, Vec2{static_cast<double>(k), 1.0 / 7});
      const DiscMotion motion{.u = {static_cast<double>(k), 1.0 / 7}, .theta = 1.0 / 3};
      if (k % 2 == 0) record.film.push_back({8 * k, 0.1 * static_cast<double>(k), std::vector(bodies, motion)});
    }
    writer.write({state_at(5, 12), record, files});
    CHECK(case_of_checkpoint(path) == case_text);
    const Checkpoint read = read_checkpoint(path, case_text);
    CHECK(same_bits(read.state, state_at(5, 12)));
    CHECK(read.record.paths == record.paths);
    REQUIRE(read.record.film.size() == record.film.size());
    for (std::size_t k = 0; k < record.film.size(); ++k) {
      CHECK(read.record.film[k].step == record.film[k].step);
      CHECK(same_bits(read.record.film[k].time, record.film[k].time));
      CHECK(numbers_of(read.record.film[k].motions) == numbers_of(record.film[k].motions));
    }
    CHECK(read.record.recorded == record.recorded);
    REQUIRE(read.files.size() == files.size());
    for (const FileMark& mark : files) {
      CHECK(read.mark_of(mark.name).length == mark.length);
      CHECK(read.mark_of(mark.name).checksum == mark.checksum);
    }
    CHECK(
        refusal_of([&] { static_cast<void>(read.mark_of("measures.csv")); }).says("cannot go on with 'measures.csv'"));
    REQUIRE(read.record.energies.size() == record.energies.size());
    for (std::size_t k = 0; k < record.energies.size(); ++k) {
      CHECK(read.record.energies[k].step == record.energies[k].step);
      CHECK(same_bits(read.record.energies[k].time, record.energies[k].time));
      for (const EnergyTerm& term : energy_terms()) {
        CHECK(same_bits(read.record.energies[k].ledger.*term.value, record.energies[k].ledger.*term.value));
      }
    }
  }
}
