// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/memory.hpp"

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

double resident_bytes() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    double kilobytes = 0;
    if (word == "VmRSS:" && status >> kilobytes) return 1024 * kilobytes;
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
  const std::string group = "/sys/fs/cgroup/";
  available = std::min(available, bytes_in(group + "memory.max") - std::min(bytes_in(group + "memory.current"), 1e18));
  rlimit limit{};
  for (const auto resource : {RLIMIT_AS, RLIMIT_DATA}) {
    if (getrlimit(resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
      available = std::min(available, static_cast<double>(limit.rlim_cur) - resident_bytes());
    }
  }
  return available == std::numeric_limits<double>::infinity() ? 0 : std::max(available, 1.0);
}

}  // namespace equidem
