// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/memory.hpp"

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

#include <sys/resource.h>

namespace equidem {
namespace {

/// A number of bytes in a file of the control group; infinity where there is no limit.
double bytes_in(const std::string& path) {
  std::ifstream file(path);
  double bytes = 0;
  return file >> bytes ? bytes : std::numeric_limits<double>::infinity();
}

/// Memory of this process, bytes: "VmRSS:" resident, "VmSize:" address space, "VmData:" data segment.
double bytes_of_process(const std::string& what) {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    double kilobytes = 0;
    if (word == what && status >> kilobytes) return 1024 * kilobytes;
  }
  return 0;
}

}  // namespace

double available_memory() {
  double available = std::numeric_limits<double>::infinity();
  std::ifstream meminfo("/proc/meminfo");
  std::string word;
  while (meminfo >> word) {
    double kilobytes = 0;
    if (word == "MemAvailable:" && meminfo >> kilobytes) available = 1024 * kilobytes;
  }
  // Caches of the control group are released on demand, so only resident memory counts against its limit.
  available = std::min(available, bytes_in("/sys/fs/cgroup/memory.max") - bytes_of_process("VmRSS:"));
  const auto limited = [&](auto resource, const std::string& used) {
    rlimit limit{};
    if (getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return;
    available = std::min(available, static_cast<double>(limit.rlim_cur) - bytes_of_process(used));
  };
  limited(RLIMIT_AS, "VmSize:");
  limited(RLIMIT_DATA, "VmData:");
  return available == std::numeric_limits<double>::infinity() ? 0 : std::max(available, 1.0);
}

}  // namespace equidem
