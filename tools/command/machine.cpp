// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine.hpp"

#include <fstream>
#include <thread>

#include "equidem/core/text.hpp"
#include "equidem/output/results.hpp"

#include "command.hpp"

namespace equidem {
namespace {

/// The first "model name" of Linux.
std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t colon = line.find(": ");
    return colon == std::string::npos ? "" : line.substr(colon + 2);
  }
  return "";
}

}  // namespace

std::string Machine::text() const {
  return fmt::format("{}, {}; equidem {}, {}, compiler {}", processor.empty() ? "unknown processor" : processor,
                     counted(cores, "core"), version, build, compiler);
}

Results Machine::results() const {
  return Results()
      .set("processor", processor)
      .set("cores", cores)
      .set("compiler", compiler)
      .set("build", build)
      .set("version", version);
}

Machine this_machine() {
  return {.processor = processor_name(),
          .cores = static_cast<int>(std::thread::hardware_concurrency()),
          .compiler = __VERSION__,
          .build = build_description(),
          .version = library_version()};
}

}  // namespace equidem
