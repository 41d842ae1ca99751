// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/page/drawn_figures.hpp"

#include <algorithm>
#include <utility>

namespace equidem {
namespace {

thread_local DrawnFigures* innermost = nullptr;

}  // namespace

DrawnFigures::DrawnFigures() : outer_(std::exchange(innermost, this)) {}

DrawnFigures::~DrawnFigures() {
  innermost = outer_;
}

void DrawnFigures::add(DrawnFigure figure) {
  if (innermost != nullptr) innermost->list_.push_back(std::move(figure));
}

bool DrawnFigures::gnuplot_hangs() {
  return innermost != nullptr && std::ranges::any_of(innermost->list_, &DrawnFigure::timed_out);
}

}  // namespace equidem
