// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/memory.hpp"

#include <algorithm>
#include <fstream>
#include <limits>

#if defined(__GLIBC__)
#include <malloc.h>
#endif
#include <sys/resource.h>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// A number of bytes in a file of the control group; infinity where there is no limit.
double bytes_in(const std::string& path) {
  std::ifstream file(path);
  double bytes = 0;
  return file >> bytes ? bytes : std::numeric_limits<double>::infinity();
}

/// Memory of this process, bytes: "VmRSS:" resident, "VmHWM:" its peak, "VmSize:" address space, "VmData:" data
/// segment.
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

void return_freed_memory() {
#if defined(__GLIBC__)
  mallopt(M_MMAP_THRESHOLD, 1 << 22);
#endif
}

PeakMemory::PeakMemory() {
#if defined(__GLIBC__)
  malloc_trim(0);  // what is free already would serve the work, uncounted
#endif
  std::ofstream peak("/proc/self/clear_refs");
  peak << "5" << std::flush;  // proc(5): the peak is set to what is resident now
  before_ = peak ? bytes_of_process("VmRSS:") : std::numeric_limits<double>::quiet_NaN();
}

double PeakMemory::bytes() const {
  return std::max(bytes_of_process("VmHWM:") - before_, 0.0);
}

double resident_memory() {
  return bytes_of_process("VmRSS:");
}

double peak_resident_memory() {
  return bytes_of_process("VmHWM:");
}

double available_address_space() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
    return std::numeric_limits<double>::infinity();
  return std::max(static_cast<double>(limit.rlim_cur) - bytes_of_process("VmSize:"), 0.0);
}

double available_memory() {
  double available = available_address_space();
  std::ifstream meminfo("/proc/meminfo");
  std::string word;
  while (meminfo >> word) {
    double kilobytes = 0;
    if (word == "MemAvailable:" && meminfo >> kilobytes) available = std::min(available, 1024 * kilobytes);
  }
  // Caches of the control group are released on demand, so only resident memory counts against its limit.
  available = std::min(available, bytes_in("/sys/fs/cgroup/memory.max") - bytes_of_process("VmRSS:"));
  rlimit data{};
  if (getrlimit(RLIMIT_DATA, &data) == 0 && data.rlim_cur != RLIM_INFINITY)
    available = std::min(available, static_cast<double>(data.rlim_cur) - bytes_of_process("VmData:"));
  return std::max(available, 0.0);
}

void require_address_space(double bytes, const std::string& what) {
  const double available = available_address_space();
  if (bytes <= available) return;
  out_of_memory(fmt::format("{} {} of address space", what, readable_bytes(bytes)),
                fmt::format("{} are left within the limit of the process", readable_bytes(available)),
                "Raise the limit (ulimit -v), use fewer threads or fewer discs");
}

void require_memory(double bytes, const std::string& what, const std::string& remedy, double limit) {
  constexpr double negligible = 1e7;  // less than the question costs
  if (limit == 0 && bytes < negligible) return;
  const double available = limit > 0 ? limit : available_memory();
  if (bytes <= available) return;
  out_of_memory(fmt::format("{} {}", what, readable_bytes(bytes)),
                fmt::format("{} {}", readable_bytes(available),
                            limit > 0 ? "are allowed by memory_limit" : "of memory are available"),
                remedy);
}

}  // namespace equidem
