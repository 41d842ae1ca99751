// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Sweeps over the fronts of a factor: of the updates that children pass to their parents, and of L y = b.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "equidem/linear/kernels/panel_solve.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"

namespace equidem {

/// Visits every front, children before parents or parents before children; subtrees run on separate threads. Updates
/// consist of doubles.
class TreeSweep {
 public:
  /// The update that a child passes to its parent.
  struct Child {
    std::size_t node;
    const double* values;
  };
  using Size = std::function<std::size_t(std::size_t node)>;
  using Visit = std::function<void(std::size_t node, double* values, const std::vector<Child>& children)>;

  /// \param work of a front, in any unit, to share it out
  TreeSweep(const SymbolicFactor& symbolic, const std::function<double(std::size_t node)>& work);

  /// Children first. `visit` fills `values`, of size(node) numbers, from those of the children, in ascending order of
  /// node; the children's are then freed. Within a subtree they live on one stack.
  /// \param report is called by the calling thread, from time to time, with the share of the work done since the last
  ///         call
  void up(const Size& size, const Visit& visit, const std::function<void(double work_done)>& report) const;
  /// Parents first.
  void down(const std::function<void(std::size_t node)>& visit) const;

 private:
  const SymbolicFactor& symbolic_;
  std::vector<double> work_;
  std::vector<std::vector<std::int32_t>> children_;
  TreeSchedule schedule_;
};

/// Small subtrees run on separate threads, then the fronts above them, level by level. A subtree keeps what it passes
/// to the discs above it apart, and its own discs take what they get in place. The division does not depend on the
/// number of threads, and so the bits of the result do not.
class ForwardSweep {
 public:
  explicit ForwardSweep(const SymbolicFactor& symbolic);

  /// \param y columns in the order of elimination, `size` numbers from one to the next: b on input
  /// \param columns <= most_columns
  void run(const std::function<Panel(std::size_t front)>& panel, double* y, std::size_t size,
           std::size_t columns) const;

 private:
  struct Sweep;
  const SymbolicFactor& symbolic_;
  std::vector<std::int32_t> subtrees_;             // their roots
  std::vector<std::vector<std::int32_t>> levels_;  // fronts above them, those that wait for no other one first
  std::vector<std::int32_t> handed_;  // per front, in discs: where what it passes on begins; -1: it is inside a subtree
  std::int32_t all_handed_ = 0;       // discs
};

}  // namespace equidem
