// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Drawings as parts of an HTML page.
#pragma once

#include <string>
#include <string_view>

namespace equidem {

/// The drawing of an SVG file, which cairo or gnuplot wrote, as an element of an HTML page: without prolog and
/// namespaces, with names of its own. Coordinates of cairo's paths are rounded to 0.01 of their unit and their circles
/// are written as such, which takes a fifth of the bytes.
/// \param prefix of the names in it, different for each drawing of a page
/// \param title read out in place of the drawing
std::string inline_svg(std::string_view file, const std::string& prefix, const std::string& title);

/// An image element that holds the bytes of a PNG file.
std::string inline_png(std::string_view file, const std::string& title);

}  // namespace equidem
