// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Making assemblies, and their files beside plain reading and writing of as many bytes: bench_assemblies --help.
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <sys/resource.h>
#include <unistd.h>

#include "equidem/assembly/files.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"

#include "bench.hpp"
#include "text_table.hpp"

namespace equidem::bench {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<double> discs = {1e5, 1e6};
  double most_json = 1e6;  ///< discs
  int rounds = 3;
  std::string folder = ".";
};

/// Largest memory that the process ever held, bytes; with sizes in ascending order that of the last one.
double peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

double seconds_of(const std::function<void()>& work) {
  const Stopwatch watch;
  work();
  return watch.seconds();
}

void add_generation(TextTable& table, const std::string& kind, std::int64_t discs, int rounds) {
  std::vector<Seconds> seconds(2);
  Assembly assembly;
  for (int round = 0; round < rounds; ++round) {
    for (const int threads : {1, 2}) {
      set_thread_count(threads);
      assembly = {};
      seconds[static_cast<std::size_t>(threads - 1)].push_back(
          seconds_of([&] { assembly = build_assembly(kind, discs, 0.005); }));
    }
  }
  table.add("{} & {} & {} & {} & {} & {:.0f}", kind, grouped(std::ssize(assembly.centres)),
            grouped(std::ssize(assembly.contacts)), range_of(seconds[0]).text("{:.3f}"),
            range_of(seconds[1]).text("{:.3f}"), peak_memory() / static_cast<double>(assembly.size()));
}

/// Bytes in one piece, as fast as the standard library moves them.
void write_plain(const fs::path& path, const std::vector<char>& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.flush();
  if (!file)
    bad_input(fmt::format("cannot write '{}'", path.string()), "the disk may be full", "Choose another folder");
}

void read_plain(const fs::path& path, std::vector<char>& bytes) {
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

void add_files(TextTable& table, std::int64_t discs, const char* format, const Options& options) {
  const fs::path folder = fs::path(options.folder) / fmt::format("bench_assemblies.{}", getpid());
  fs::create_directories(folder);
  const fs::path file = folder / fmt::format("assembly.{}", format), plain = folder / "plain";
  set_thread_count(2);
  const Assembly assembly = build_assembly("delaunay", discs, 0.005);
  Seconds writing, plain_writing, reading, plain_reading;
  std::vector<char> bytes;
  for (int round = -1; round < options.rounds; ++round) {  // the first use of memory is slow
    const double write = seconds_of([&] { write_assembly(file, assembly, true); });
    bytes.resize(fs::file_size(file));
    const double write_as_plain = seconds_of([&] { write_plain(plain, bytes); });
    const double read = seconds_of([&] { static_cast<void>(read_assembly(file)); });
    const double read_as_plain = seconds_of([&] { read_plain(plain, bytes); });
    if (round < 0) continue;
    writing.push_back(write);
    plain_writing.push_back(write_as_plain);
    reading.push_back(read);
    plain_reading.push_back(read_as_plain);
  }
  fs::remove_all(folder);
  const double megabytes = static_cast<double>(bytes.size()) / 1e6;
  table.add("{} & {} & {:.0f} & {} & {} & {:.0f} & {} & {} & {:.0f}", format, grouped(std::ssize(assembly.centres)),
            megabytes, range_of(writing).text("{:.3f}"), range_of(plain_writing).text("{:.3f}"),
            megabytes / range_of(writing).median, range_of(reading).text("{:.3f}"),
            range_of(plain_reading).text("{:.3f}"), megabytes / range_of(reading).median);
}

void run(Report& report, const Options& options) {
  report.begin("Assemblies");
  TextTable made("kind & discs & contacts & one thread, s & two threads, s & peak memory, bytes a disc");
  for (const double discs : options.discs)
    for (const std::string& kind : assembly_kinds())
      add_generation(made, kind, static_cast<std::int64_t>(discs), options.rounds);
  report.add("\nPoints, triangulation, contacts, cells and sides of an assembly in memory.\n\n" + made.markdown());
  TextTable files("format & discs & MB & written, s & plain, s & MB/s & read, s & plain, s & MB/s");
  for (const double discs : options.discs) {
    add_files(files, static_cast<std::int64_t>(discs), "h5", options);
    if (discs <= options.most_json) add_files(files, static_cast<std::int64_t>(discs), "json", options);
  }
  report.add(
      "\nFiles of Delaunay assemblies, two threads, checks included; plain: the same number of bytes in one "
      "piece. Files stay in the memory of the system.\n\n" +
      files.markdown());
}

}  // namespace
}  // namespace equidem::bench

int main(int argc, char** argv) {
  using namespace equidem::bench;
  Options options;
  return run_benchmark(
      "bench_assemblies", "making, writing and reading assemblies", argc, argv,
      [&](CLI::App& app) {
        app.add_option("--discs", options.discs, "sizes, ascending")->delimiter(',')->capture_default_str();
        app.add_option("--most-json", options.most_json, "largest size that is written as JSON")->capture_default_str();
        app.add_option("--rounds", options.rounds, "repetitions")->capture_default_str();
        app.add_option("--folder", options.folder, "where files are written")->capture_default_str();
      },
      [&](Report& report) { run(report, options); });
}
