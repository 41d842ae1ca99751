// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine.hpp"

#include <fstream>
#include <thread>

#include "equidem/core/text.hpp"

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

JsonObject Machine::json() const {
  JsonObject object;
  object.set("processor", processor).set("cores", cores);
  object.set("compiler", compiler).set("build", build).set("version", version);
  return object;
}

Machine this_machine() {
#ifdef __OPTIMIZE__
  const std::string optimized = "optimized";
#else
  const std::string optimized = "not optimized";
#endif
#ifdef NDEBUG
  const std::string assertions = ", assertions off";
#else
  const std::string assertions = ", assertions on";
#endif
  return {.processor = processor_name(),
          .cores = static_cast<int>(std::thread::hardware_concurrency()),
          .compiler = __VERSION__,
          .build = optimized + assertions,
          .version = library_version()};
}

}  // namespace equidem
