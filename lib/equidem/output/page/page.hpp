// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A result as one HTML page that needs nothing else: no network, no library, no file beside it.
#pragma once

#include <string>
#include <vector>

#include "equidem/output/page/drawn_figures.hpp"
#include "equidem/output/results.hpp"

namespace equidem {

/// The name of the page in a folder of results.
inline constexpr const char* page_name = "index.html";
/// Upper bound of the size of a page.
inline constexpr std::size_t most_page_bytes = 2'000'000;

struct ResultPage {
  std::string verb;       ///< one of those of has_page
  std::string status;     ///< "solved", "unstable", ...
  std::string version;    ///< of the program
  std::string command;    ///< by which the result is computed again
  std::string case_text;  ///< the resolved case, TOML; empty: the verb has none
  std::string report;
  Results results;
  std::vector<DrawnFigure> figures = {};  ///< their files are read
};

/// The page: warnings, the answer with its error and residual, checks of a run, the case, what acts and why the rest
/// does not, figures, the way to repeat it, the report. The same input gives the same bytes. Figures are embedded as
/// they are; those for which no room is left are named.
/// \throws Error (bad_input) where a file of a figure cannot be read
std::string result_page_html(const ResultPage& page);

}  // namespace equidem
