// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/memory.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <new>

#if defined(__GLIBC__)
#include <malloc.h>
#endif
#include <sys/mman.h>
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

void* allocate_on_huge_pages(std::size_t bytes) noexcept {
  constexpr std::size_t huge_page = std::size_t{1} << 21;
  if (bytes <= huge_page) return std::malloc(std::max<std::size_t>(bytes, 1));
  void* memory = nullptr;
  if (posix_memalign(&memory, huge_page, bytes) != 0) return nullptr;
  madvise(memory, bytes, MADV_HUGEPAGE);  // advice: nothing is lost where it is not taken
  return memory;
}

void* allocate_large(std::size_t bytes) {
  if (void* const memory = allocate_on_huge_pages(bytes)) return memory;
  out_of_memory(fmt::format("no memory for {}", readable_bytes(static_cast<double>(bytes))), "the system refused it",
                "Use a smaller assembly or a machine with more memory");
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

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
// Weak: a program that links this library may replace them.
[[gnu::weak]] void* operator new(std::size_t bytes) {
  for (;;) {
    if (void* const memory = equidem::allocate_on_huge_pages(bytes)) return memory;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}
[[gnu::weak]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::weak]] void operator delete(void* memory, std::size_t /*bytes*/) noexcept {
  std::free(memory);
}
#endif
