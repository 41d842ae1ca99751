// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Nearly valid inputs to every reader:
///
///     fuzz_readers [--inputs N] [--seed S] [--report FILE]    N inputs in turn to all readers
///     fuzz_readers --seed S --only K                          input K alone, which is printed too
///
/// An input is accepted, and then reads back where its kind is written too, or refused by one short line. Everything
/// else is a finding: a crash (also by a sanitizer), more than a second of processor time, another exception. Input K
/// of a seed is the same whichever others are tried. Exit code 1 where there is a finding.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>

#include <sys/mman.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"

#include "mutation.hpp"
#include "output/states.hpp"
#include "readers.hpp"

#if defined(__SANITIZE_ADDRESS__)
constexpr bool sanitized = true;
/// Memory that cannot be had is std::bad_alloc, as without the sanitizer; memory without bounds ends the process.
extern "C" const char* __asan_default_options() {  // NOLINT: the name that the sanitizer calls
  return "allocator_may_return_null=1:max_allocation_size_mb=2048:hard_rss_limit_mb=6144";
}
#else
constexpr bool sanitized = false;
#endif

namespace equidem::fuzz {
namespace {

constexpr double longest = 1;  // s of processor time for one input
constexpr int hang = 20;       // s of processor time after which a process is ended
constexpr std::size_t most_readers = 32, most_findings = 100, longest_text = 400;

/// Memory that the reading processes share with the one that starts them.
struct Shared {
  std::int64_t at = 0;  ///< input that is being read
  std::array<std::int64_t, most_readers> accepted = {}, refused = {};
  double slowest = 0;  ///< s
  int findings = 0;
  std::array<std::array<char, longest_text>, most_findings> texts = {};

  void find(const std::string& text) {
    if (findings < static_cast<int>(most_findings)) {
      auto& place = texts[static_cast<std::size_t>(findings)];
      std::strncpy(place.data(), text.c_str(), longest_text - 1);
    }
    ++findings;
  }
};

struct Options {
  std::int64_t inputs = 28000;
  std::uint64_t seed = 1;
  std::optional<std::int64_t> only;
  std::string report;
};

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::string input_of(const Reader& reader, std::uint64_t seed, std::int64_t k) {
  Random random(seed * 0x9e3779b97f4a7c15U + static_cast<std::uint64_t>(k));
  return mutated(reader.seeds, random);
}

/// A refusal is one printable line that is not endless.
std::string fault_of(const Error& error) {
  const std::string text = error.what();
  if (error.kind() == ErrorKind::interrupted) return "an interruption";
  if (text.empty() || text.size() > 3000) return fmt::format("a message of {} bytes", text.size());
  if (std::ranges::any_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x20; }))
    return "a message with control characters: " + text;
  return {};
}

/// \return a finding; empty: none
std::string read(const Reader& reader, const std::string& input, bool& accepted) {
  accepted = false;
  try {
    reader.read(input);
    accepted = true;
  } catch (const Error& error) {
    return fault_of(error);
  } catch (const std::bad_alloc&) {
    return "memory was taken before it was refused";
  } catch (const std::exception& error) {
    return fmt::format("an exception that is no refusal: {}", error.what());
  }
  return {};
}

void read_from(std::int64_t first, const std::vector<Reader>& readers, const Options& options, Shared& shared) {
  for (std::int64_t k = first; k < options.inputs; ++k) {
    shared.at = k;
    const auto r = static_cast<std::size_t>(k) % readers.size();
    const std::string input = input_of(readers[r], options.seed, k);
    const itimerval limit{{0, 0}, {hang, 0}};
    setitimer(ITIMER_PROF, &limit, nullptr);
    const double began = processor_seconds();
    bool accepted = false;
    std::string finding = read(readers[r], input, accepted);
    const double seconds = processor_seconds() - began;
    if (finding.empty() && seconds > longest) finding = fmt::format("{:.2f} s", seconds);
    ++(accepted ? shared.accepted : shared.refused)[r];
    shared.slowest = std::max(shared.slowest, seconds);
    if (!finding.empty()) shared.find(fmt::format("input {}, {}: {}", k, readers[r].name, finding));
  }
}

/// Processes read one after the other: where one dies, the next goes on behind the input that killed it.
void read_all(const std::vector<Reader>& readers, const Options& options, Shared& shared) {
  for (std::int64_t first = 0; first < options.inputs; first = shared.at + 1) {
    std::fflush(nullptr);
    const pid_t process = fork();
    if (process < 0) throw std::runtime_error("no process can be started");
    if (process == 0) {
      read_from(first, readers, options, shared);
      _exit(0);
    }
    int status = 0;
    waitpid(process, &status, 0);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
    const std::string end = WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF ? "it does not end"
                            : WIFSIGNALED(status) ? fmt::format("signal {}", WTERMSIG(status))
                                                  : fmt::format("exit code {}", WEXITSTATUS(status));
    const auto r = static_cast<std::size_t>(shared.at) % readers.size();
    shared.find(fmt::format("input {}, {}: {}", shared.at, readers[r].name, end));
  }
}

std::string report_of(const std::vector<Reader>& readers, const Options& options, const Shared& shared) {
  std::string text = fmt::format(
      "{{\n  \"command\": \"fuzz_readers --inputs {} --seed {}\",\n  \"sanitizers\": \"{}\",\n  \"inputs\": {},\n"
      "  \"findings\": {},\n  \"slowest_ms\": {:.0f},\n  \"readers\": {{\n",
      options.inputs, options.seed, sanitized ? "address, undefined" : "none", options.inputs, shared.findings,
      1000 * shared.slowest);
  for (std::size_t r = 0; r < readers.size(); ++r) {
    text += fmt::format("    \"{}\": {{\"accepted\": {}, \"refused\": {}}}{}\n", readers[r].name, shared.accepted[r],
                        shared.refused[r], r + 1 < readers.size() ? "," : "");
  }
  return text + "  }\n}\n";
}

Options options_of(int count, char** arguments) {
  Options options;
  for (int k = 1; k < count; k += 2) {
    const std::string name = arguments[k];
    if (k + 1 == count) throw std::runtime_error(name + " needs a value");
    const std::string value = arguments[k + 1];
    if (name == "--inputs") {
      options.inputs = std::stoll(value);
    } else if (name == "--seed") {
      options.seed = std::stoull(value);
    } else if (name == "--only") {
      options.only = std::stoll(value);
    } else if (name == "--report") {
      options.report = value;
    } else {
      throw std::runtime_error("there is no option " + name);
    }
  }
  return options;
}

int fuzz(const Options& options) {
  const TemporaryFolder scratch;
  const std::vector<Reader> readers = make_readers(EQUIDEM_SOURCE_DIR, scratch.path());
  int bad_seeds = 0;
  for (const Reader& reader : readers) {
    for (const std::string& seed : reader.seeds) {
      bool accepted = false;
      const std::string finding = read(reader, seed, accepted);
      if (accepted) continue;
      ++bad_seeds;
      try {
        reader.read(seed);
      } catch (const std::exception& error) {
        fmt::print("{}: a seed that is not valid: {}\n", reader.name, error.what());
      }
    }
  }
  if (bad_seeds > 0) return 1;
  if (options.only) {
    const Reader& reader = readers[static_cast<std::size_t>(*options.only) % readers.size()];
    const std::string input = input_of(reader, options.seed, *options.only);
    fmt::print("{}\n{}\n", reader.name, input);
    std::fflush(nullptr);
    bool accepted = false;
    const std::string finding = read(reader, input, accepted);
    fmt::print("\n{}\n", !finding.empty() ? finding : accepted ? "accepted" : "refused");
    return finding.empty() ? 0 : 1;
  }
  void* place = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (place == MAP_FAILED) throw std::runtime_error("no memory to share");
  Shared& shared = *new (place) Shared;
  read_all(readers, options, shared);
  const std::string report = report_of(readers, options, shared);
  fmt::print("{}", report);
  for (int k = 0; k < std::min(shared.findings, static_cast<int>(most_findings)); ++k)
    fmt::print("{}\n", shared.texts[static_cast<std::size_t>(k)].data());
  if (!options.report.empty()) write_file(options.report, report, true);
  return shared.findings == 0 ? 0 : 1;
}

}  // namespace
}  // namespace equidem::fuzz

int main(int count, char** arguments) {
  // Files in memory, where there is room for them: several are synced for every input.
  if (access("/dev/shm", W_OK) == 0) setenv("TMPDIR", "/dev/shm", 0);
  try {
    return equidem::fuzz::fuzz(equidem::fuzz::options_of(count, arguments));
  } catch (const std::exception& error) {
    fmt::print(stderr, "fuzz_readers: {}\n", error.what());
    return 2;
  }
}
