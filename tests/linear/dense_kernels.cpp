// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Dense kernels with one right-hand side, whose operands end where the memory of the process ends.
#include "equidem/linear/multifrontal/dense_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <sys/mman.h>
#include <unistd.h>

#include "support/catch.hpp"

using namespace equidem;

namespace {

/// `count` numbers that are followed by a page that must not be read: a read behind them ends the process.
class Guarded {
 public:
  explicit Guarded(std::size_t count)
      : page_(static_cast<std::size_t>(sysconf(_SC_PAGESIZE))),
        used_((count * sizeof(double) + page_ - 1) / page_ * page_),
        start_(static_cast<char*>(
            mmap(nullptr, used_ + page_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0))) {
    if (start_ == MAP_FAILED || mprotect(start_ + used_, page_, PROT_NONE) != 0) throw std::runtime_error("no pages");
    numbers_ = reinterpret_cast<double*>(start_ + used_) - count;
    for (std::size_t i = 0; i < count; ++i) numbers_[i] = 1.0 / static_cast<double>(2 + (7 * i) % 11);
  }
  ~Guarded() { munmap(start_, used_ + page_); }
  Guarded(const Guarded&) = delete;
  Guarded& operator=(const Guarded&) = delete;

  double* get() { return numbers_; }
  double& operator[](std::size_t i) { return numbers_[i]; }

 private:
  std::size_t page_, used_;
  char* start_;
  double* numbers_ = nullptr;
};

}  // namespace

TEST_CASE("products_read_nothing_behind_their_operands") {
  const dense::OneThreadPerCall one_thread;
  double largest = 0;
  for (std::size_t rows = 1; rows <= 20; ++rows) {
    for (std::size_t columns = 1; columns <= 9; ++columns) {
      const std::size_t leading = rows + 1, last = leading * (columns - 1) + rows;
      Guarded a(last), x(columns), y(rows), y_transposed(columns), x_transposed(rows);
      const auto start = [](auto& vector, std::size_t n) {
        for (std::size_t i = 0; i < n; ++i) vector[i] = 0;
      };
      start(y, rows);
      start(y_transposed, columns);
      dense::subtract_product(rows, 1, columns, a.get(), leading, x.get(), columns, y.get(), rows);
      dense::subtract_transposed_product(columns, 1, rows, a.get(), leading, x_transposed.get(), rows,
                                         y_transposed.get(), columns);
      for (std::size_t r = 0; r < rows; ++r) {
        for (std::size_t c = 0; c < columns; ++c) {
          y[r] += a[c * leading + r] * x[c];
          y_transposed[c] += a[c * leading + r] * x_transposed[r];
        }
        largest = std::max(largest, std::abs(y[r]));
      }
      for (std::size_t c = 0; c < columns; ++c) {
        largest = std::max(largest, std::abs(y_transposed[c]));
      }
    }
  }
  INFO("largest difference from the sums: " << largest);
  CHECK(largest < 1e-14);
}
