// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Sweeps over the fronts of a factor, with the memory of the updates that children pass to their parents.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "equidem/linear/ordering/symbolic_factor.hpp"
#include "equidem/linear/ordering/tree_schedule.hpp"

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

}  // namespace equidem
