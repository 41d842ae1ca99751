// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The numbers of a result that its page shows first.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "equidem/output/results.hpp"

namespace equidem {

struct Answer {
  std::string label;
  double value = 0;
  std::string text;        ///< HTML
  std::string unit = {};   ///< with its prefix
  std::string error = {};  ///< HTML: a bound or a standard error, with its unit
};

struct Answers {
  std::vector<Answer> main;     ///< at most four
  std::vector<Answer> quality;  ///< errors, residuals and what else tells how far the answer may be trusted
};

/// Whether a verb has a page: its numbers are listed in answers.cpp.
bool has_page(std::string_view verb);

Answers answers_of(std::string_view verb, const Results& results);

/// A number in HTML: "0.120432", "1.8 × 10⁻¹⁹" with an element for the exponent.
std::string number_html(double value, int digits = 6);

}  // namespace equidem
