// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A result as one HTML page that needs nothing else: no network, no library, no file beside it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/output/results.hpp"

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

struct Answer {
  std::string label;
  double value = 0;
  std::string text;        ///< HTML
  std::string unit = {};   ///< with its prefix
  std::string error = {};  ///< HTML: a bound or a standard error, with its unit
};

struct Answers {
  std::vector<Answer> main;     ///< the first four that are known
  std::vector<Answer> quality;  ///< errors, residuals and whatever shows how far the answer may be trusted
};

/// A row of answers.csv: a number that is shown of the result of a verb.
struct ShownNumber {
  std::string verb;
  std::string place;  ///< "main" or "quality" of its page, "sweep" in the report and the curves of a sweep
  std::string path;   ///< as in find_result; '*': every position of a list, every key of an object, of a sweep a wave
  std::string label;
  std::string error;   ///< path of its error
  std::string axis;    ///< label of its curve; empty: not drawn
  std::string theory;  ///< path of the number that theory gives
  Shown shown;         ///< in the report of a sweep
};
std::vector<ShownNumber> numbers_shown_of(std::string_view verb, std::string_view place);
/// Whether a verb has a page: its numbers are listed in answers.csv.
bool has_page(std::string_view verb);

Answers answers_of(std::string_view verb, const Results& results);

/// A number in HTML: "0.120432", "1.8 × 10⁻¹⁹" with an element for the exponent.
std::string number_html(double value, int digits = 6);

struct TrustCheck {
  enum class Verdict { good, doubtful, bad };
  Verdict verdict = Verdict::good;
  std::string name;         ///< "time step"
  std::string found;        ///< "0.8 of the critical one"
  std::string advice = {};  ///< what to change; empty where nothing is
};

/// Step over critical step, largest overlap over radius, balance of the energies or of the forces, and whether springs
/// without negative stiffness can have the Poisson's ratio; those that the results tell.
/// \param results of the verb run
std::vector<TrustCheck> trust_checks(const Results& results);

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
