// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The figures that the writers of plots and pictures drew, for a page that shows them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace equidem {

struct DrawnFigure {
  std::string name;                 ///< of its files, without extension
  std::string title;                ///< read out in place of the figure
  std::filesystem::path file = {};  ///< SVG or PNG; empty: there is none
  std::string player = {};          ///< HTML of a moving picture, in place of files
  std::string missing = {};         ///< the reason why nothing was drawn
  bool timed_out = false;           ///< it is that gnuplot did not end
};

/// While one exists, it lists the figures that are drawn on its thread; the innermost one where there are several.
class DrawnFigures {
 public:
  DrawnFigures();
  ~DrawnFigures();
  DrawnFigures(const DrawnFigures&) = delete;
  DrawnFigures& operator=(const DrawnFigures&) = delete;

  [[nodiscard]] const std::vector<DrawnFigure>& list() const { return list_; }
  /// Add a figure to the list of this thread, if there is one.
  static void add(DrawnFigure figure);
  /// Whether gnuplot did not end at one of them: others need not wait for it as long.
  static bool gnuplot_hangs();

 private:
  std::vector<DrawnFigure> list_;
  DrawnFigures* outer_;
};

}  // namespace equidem
