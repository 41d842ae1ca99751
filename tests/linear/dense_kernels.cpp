// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Dense kernels with one right-hand side, whose operands end where the memory of the process ends, and triangular
/// solutions with one panel.
#include "equidem/linear/multifrontal/dense_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include <sys/mman.h>
#include <unistd.h>

#include "equidem/core/random.hpp"
#include "equidem/linear/kernels/panel_solve.hpp"

#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using namespace equidem::test;

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

/// Largest difference of triangular solutions with a panel from plain loops.
double panel_error(std::size_t pivots, std::size_t rows, std::size_t columns, Random& random) {
  std::vector<double> l(pivots * rows);
  for (double& value : l) value = random.uniform(-1, 1) / static_cast<double>(rows);
  for (std::size_t p = 0; p < pivots; ++p) l[p * (rows + 1)] = random.uniform(1, 2);
  const std::vector<double> given = random_vector(rows * columns, rows);
  std::vector<double> forward(given.begin(), given.end()), backward = forward;
  const Panel panel{l.data(), pivots, rows};
  solve_forward(panel, forward.data(), columns);
  solve_backward(panel, backward.data(), columns);
  double error = 0;
  for (std::size_t c = 0; c < columns; ++c) {
    std::vector<double> x(given.begin() + static_cast<std::ptrdiff_t>(c * rows),
                          given.begin() + static_cast<std::ptrdiff_t>((c + 1) * rows));
    std::vector<double> y = x;
    for (std::size_t p = 0; p < pivots; ++p) {
      x[p] /= l[p * (rows + 1)];
      for (std::size_t r = p + 1; r < rows; ++r) x[r] -= l[p * rows + r] * x[p];
    }
    for (std::size_t p = pivots; p-- > 0;) {
      for (std::size_t r = p + 1; r < rows; ++r) y[p] -= l[p * rows + r] * y[r];
      y[p] /= l[p * (rows + 1)];
    }
    for (std::size_t r = 0; r < rows; ++r) {
      error = std::max({error, std::abs(forward[c * rows + r] - x[r]), std::abs(backward[c * rows + r] - y[r])});
    }
  }
  return error;
}

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

TEST_CASE("triangular_solutions_with_a_panel_are_those_of_plain_loops") {
  Random random(1);
  for (const std::size_t pivots : {1, 2, 3, 4, 5, 8, 11, 30}) {
    for (const std::size_t below : {0, 1, 3, 7, 8, 29}) {
      for (std::size_t columns = 1; columns <= most_columns; ++columns) {
        CAPTURE(pivots, below, columns);
        CHECK(panel_error(pivots, pivots + below, columns, random) < 2e-15);
      }
    }
  }
}
