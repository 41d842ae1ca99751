// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The memory that a computation may take, and how arrays of megabytes take it.
#pragma once

#include <cstddef>
#include <string>

namespace equidem {

/// Bytes that this process can still take without swapping: the smaller of the available memory that the system states
/// and of what the limits of the process and of its control group leave; infinity where none is known.
double available_memory();
/// Bytes left within the limit of the process (ulimit -v); infinity where there is none.
double available_address_space();

/// Memory of this process that is resident now, and at its peak so far, bytes; 0 where the system does not state it.
double resident_memory();
double peak_resident_memory();

/// Have the allocator give freed vectors of some megabytes back to the system. The C library of GNU keeps those of up
/// to 32 MB, between which others then lie: a quarter of the peak of a static solve of 1e6 discs. For programs to call
/// at their start.
void return_freed_memory();

/// Uninitialized memory that std::free gives back; null where there is none. What is larger than a huge page begins at
/// one and asks the system for huge pages: where they are given on request only ("madvise", see
/// /sys/kernel/mm/transparent_hugepage/enabled), the first touch of small pages is two fifths of the time of a static
/// solve of 1e6 discs. Operator new takes its memory here, unless the program or a sanitizer brings its own.
void* allocate_on_huge_pages(std::size_t bytes) noexcept;
/// \throws Error (out_of_memory) where there is not enough
void* allocate_large(std::size_t bytes);

/// Memory that a piece of work takes. One at a time: the system keeps one peak of a process.
class PeakMemory {
 public:
  /// The peak begins anew.
  PeakMemory();
  /// The largest resident memory since construction, beyond what was resident then; not a number where the system does
  /// not tell it.
  [[nodiscard]] double bytes() const;

 private:
  double before_ = 0;
};

/// \param what beginning of the sentence, up to the amount: "a run of 1 000 000 discs needs about"
/// \param remedy what the user can do
/// \param limit bytes; 0: what is available
/// \throws Error (out_of_memory) where `bytes` exceed the limit
void require_memory(double bytes, const std::string& what,
                    const std::string& remedy = "Use fewer discs, or a machine with more memory", double limit = 0);
/// \throws Error (out_of_memory) where `bytes` exceed available_address_space()
void require_address_space(double bytes, const std::string& what);

}  // namespace equidem
