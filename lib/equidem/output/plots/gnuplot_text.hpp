// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Pieces of gnuplot scripts.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "equidem/output/plots/plot.hpp"

namespace equidem {

/// A single-quoted string of gnuplot: nothing in it is expanded (no backslash, no backtick), a quote is doubled.
std::string gnuplot_string(const std::string& text);

/// "#RRGGBB".
const char* hex(PlotColour colour);

/// The first lines of a script: how to run it, its data file, the frame and the title.
/// \param plain " noenhanced", or nothing
std::string script_head(const std::string& name, const std::string& title, const std::string& plain);

/// A smaller font for a title that is wider than the picture; nothing for others.
std::string title_font(const std::string& title, double font_size);

/// The commands that draw NAME.svg and NAME.png. Each terminal of gnuplot has its own unit for fonts and markers: the
/// commands are for a certain font size, of which others are a share, and use `marker` as the size of a marker and
/// `stride` as the step from one point of a line to the next.
/// \param svg_stride stride of the SVG; that of the PNG is 1
std::string draw_twice(const std::string& name, const std::function<std::string(double font_size)>& commands,
                       std::size_t svg_stride = 1);

}  // namespace equidem
