// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/plots/plot.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <limits>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/page/page.hpp"
#include "equidem/output/texts.hpp"

namespace equidem {
namespace {

/// gnuplot echoes the line with a caret under the fault and prints "line 7: reason" last.
std::string last_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

/// A child process in a process group of its own, which ends with this object, and all that it has started with it.
class Gnuplot {
 public:
  Gnuplot(const std::string& folder, const std::string& script) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) {
      failure_ = errno;
      return;
    }
    const char* arguments[] = {"gnuplot", script.c_str(), nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t usual;
    sigemptyset(&usual);
    for (const int signal : {SIGPIPE, SIGXFSZ, SIGINT, SIGTERM, SIGHUP}) sigaddset(&usual, signal);
    posix_spawnattr_setsigdefault(&attributes, &usual);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
    failure_ = posix_spawnp(&child_, arguments[0], &actions, &attributes, const_cast<char* const*>(arguments), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    complaints_ = ends[0];
    if (failure_ != 0) child_ = 0;
  }
  ~Gnuplot() {
    if (child_ != 0) {
      kill(-child_, SIGKILL);
      waitpid(child_, nullptr, 0);
    }
    if (complaints_ >= 0) close(complaints_);
  }
  Gnuplot(const Gnuplot&) = delete;
  Gnuplot& operator=(const Gnuplot&) = delete;

  [[nodiscard]] int failure() const { return failure_; }  ///< errno where it was not started

  /// Waits for its end for some ms. \return whether it has ended
  bool ended(int wait) {
    pollfd complaint{complaints_, POLLIN, 0};
    poll(&complaint, 1, wait);
    char buffer[1024];
    for (ssize_t count = 0; (count = read(complaints_, buffer, sizeof buffer)) > 0;)
      text_.append(buffer, static_cast<std::size_t>(count));
    if (waitpid(child_, &status_, WNOHANG) == 0) {
      if ((complaint.revents & (POLLHUP | POLLIN)) == POLLHUP) poll(nullptr, 0, wait);  // it closed its stderr
      return false;
    }
    kill(-child_, SIGKILL);  // what it has left running
    child_ = 0;
    return true;
  }
  [[nodiscard]] bool succeeded() const { return WIFEXITED(status_) && WEXITSTATUS(status_) == 0; }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  pid_t child_ = 0;
  int complaints_ = -1, status_ = 0, failure_ = 0;
  std::string text_;
};

}  // namespace

GnuplotRun run_gnuplot(const std::filesystem::path& folder, const std::string& script, double time_limit) {
  Gnuplot gnuplot(folder.empty() ? "." : folder.string(), script);
  if (gnuplot.failure() == ENOENT) return {false, "gnuplot is not installed"};
  if (gnuplot.failure() != 0)
    return {false, fmt::format("gnuplot could not be started: {}", std::strerror(gnuplot.failure()))};
  constexpr int poll_every = 20;  // ms
  for (const Stopwatch watch; !gnuplot.ended(poll_every);) {
    stop_if_interrupted();
    if (watch.seconds() > time_limit) return {false, fmt::format("gnuplot took more than {} s", time_limit), true};
  }
  if (gnuplot.succeeded()) return {true, {}};
  const std::string line = last_line(gnuplot.text());
  return {false, line.empty() ? "gnuplot failed without a message" : "gnuplot reports: " + line};
}

namespace {

/// gnuplot takes a file name that begins with '<' or '|' as a command, so only plain names pass.
void check_name(const std::string& name) {
  if (!name.empty() && name.find_first_of("-.") != 0 && name.find_first_of("/|<>'\"`\\\n") == std::string::npos) return;
  bad_input(fmt::format("'{}' cannot name the files of a plot", name),
            "it begins with - or ., or holds a character that gnuplot or folders take for more than a name",
            "Choose a plain name");
}

void check_axis(const Axis& axis, const char* letter) {
  for (const auto& bound : {axis.min, axis.max}) {
    if (!bound) continue;
    if (!std::isfinite(*bound) || (axis.logarithmic && *bound <= 0)) {
      bad_input(fmt::format("the {} axis of a plot has the bound {}", letter, *bound),
                axis.logarithmic ? "a logarithmic axis has positive, finite bounds" : "bounds are finite",
                "Give another bound, or none");
    }
  }
  if (axis.min && axis.max && !(*axis.min < *axis.max)) {
    bad_input(fmt::format("the {} axis of a plot goes from {} to {}", letter, *axis.min, *axis.max),
              "the first bound is the smaller one", "Exchange them");
  }
}

/// \return whether it has a finite point
bool check_series(const Series& series, const Plot& plot) {
  if (series.x.size() != series.y.size()) {
    bad_input(fmt::format("series '{}' of a plot has {} of x and {} of y", series.label,
                          counted(series.x.size(), "value"), counted(series.y.size(), "value")),
              "each point has both", "Give as many x as y");
  }
  bool any_point = false;
  for (std::size_t k = 0; k < series.x.size(); ++k) {
    if (!std::isfinite(series.x[k]) || !std::isfinite(series.y[k])) continue;
    any_point = true;
    if ((plot.x.logarithmic && series.x[k] <= 0) || (plot.y.logarithmic && series.y[k] <= 0)) {
      bad_input(fmt::format("point {} of series '{}' of a plot is ({}, {})", k, series.label, series.x[k], series.y[k]),
                "a logarithmic axis shows positive values only", "Leave it out, or use a linear axis");
    }
  }
  return any_point;
}

void check_plot(const Plot& plot) {
  check_axis(plot.x, "x");
  check_axis(plot.y, "y");
  bool any_point = false;
  for (const Series& series : plot.series) any_point = check_series(series, plot) || any_point;
  if (!any_point) bad_input("a plot has no finite point", "there is nothing to draw", "Give it a series");
}

constexpr std::array<const char*, 8> palette = {"#000000", "#E69F00", "#56B4E9", "#009E73",
                                                "#F0E442", "#0072B2", "#D55E00", "#CC79A7"};

bool is_letter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0;
}

/// A single-quoted string of gnuplot: nothing in it is expanded (no backslash, no backtick), a quote is doubled.
std::string gnuplot_string(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') result += '\'';
    if (c == '>' && result.ends_with("]]")) result += ' ';  // gnuplot leaves it in the SVG, and XML forbids it
    result += std::iscntrl(static_cast<unsigned char>(c)) != 0 ? ' ' : c;
  }
  return result + "'";
}

/// "#RRGGBB".
const char* hex(PlotColour colour) {
  return palette[static_cast<std::size_t>(colour)];
}

/// Letters and digits of a label, joined by single underscores.
std::string column_name(const std::string& label) {
  std::string name;
  for (const char c : label) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 && static_cast<unsigned char>(c) < 0x80) {
      name += c;
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  return name;
}

struct AxisRange {
  double min = 0, max = 1;
};

/// Outwards to a multiple of a 1-2-5 step near a fiftieth of the span.
AxisRange rounded(double low, double high) {
  const double raw = (high - low) / 50;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double step = raw / power < 2 ? 2 * power : raw / power < 5 ? 5 * power : 10 * power;
  return {step * std::floor(low / step), step * std::ceil(high / step)};
}

/// The given bounds, else those of the data with a small margin, rounded outwards. Data that differ by round-off alone
/// are drawn as equal ones.
AxisRange range_of(const Axis& axis, const std::vector<Series>& series, std::vector<double> Series::*member) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Series& one : series) {
    for (const double v : one.*member) {
      if (!std::isfinite(v) || (axis.logarithmic && v <= 0)) continue;
      low = std::min(low, v);
      high = std::max(high, v);
    }
  }
  if (axis.logarithmic) {
    const double margin = low < high ? std::pow(high / low, 0.05) : 2;
    low /= margin, high *= margin;
  } else {
    constexpr double round_off = 1e-12;  // relative
    const bool differ = high - low > round_off * std::max(std::abs(low), std::abs(high));
    const double margin = differ ? 0.05 * (high - low) : std::max(0.1 * std::abs(low), 1e-12);
    const AxisRange padded = rounded(low - margin, high + margin);
    low = padded.min, high = padded.max;
  }
  return {axis.min.value_or(low), axis.max.value_or(high)};
}

/// The format of labels of a linear axis: six digits, or as many as tell tics apart, of which there are up to ten.
std::string number_format(const AxisRange& range) {
  const double largest = std::max(std::abs(range.min), std::abs(range.max));
  const double wanted = std::floor(std::log10(largest / (range.max - range.min))) + 3;
  constexpr int usual = 6, most = 15;
  const int digits = std::isfinite(wanted) ? static_cast<int>(std::clamp<double>(wanted, usual, most)) : usual;
  return digits == usual ? "%g" : fmt::format("%.{}g", digits);
}

/// Scale and tic labels. A logarithmic axis shorter than two decades is labelled at 1, 2 and 5, a longer one at
/// powers of ten.
std::string axis_scale(char letter, const Axis& axis, const AxisRange& range) {
  if (!axis.logarithmic) return fmt::format("set format {} '{}'\n", letter, number_format(range));
  std::string text = fmt::format("set logscale {}\n", letter);
  if (std::log10(range.max / range.min) > 2 || range.min < 1e-4 || range.max > 1e5) {
    return text + fmt::format("set format {} '10^{{%T}}'\n", letter);
  }
  std::vector<std::string> tics;
  for (int decade = -5; decade <= 5; ++decade)
    for (const int digit : {1, 2, 5}) tics.push_back(fmt::format("{}e{}", digit, decade));
  return text + fmt::format("set format {0} '%g'\nset {0}tics ({1})\n", letter, joined(tics));
}

std::string vertical_line(const VerticalLine& line, const std::string& plain) {
  std::string text =
      fmt::format("set arrow from first {0}, graph 0 to first {0}, graph 1 nohead back lw 1.1 dt (5,4) lc rgb '{1}'\n",
                  line.x, hex(line.colour));
  if (!line.label.empty()) {
    text +=
        fmt::format("set label {} at first {}, graph 0.985 right rotate by 90 offset char 1,0 tc rgb '{}' front{}\n",
                    gnuplot_string(line.label), line.x, hex(line.colour), plain);
  }
  return text;
}

/// gnuplot's point types: open and filled.
int point_type(Marker marker, bool filled) {
  switch (marker) {
    case Marker::circle:
      return filled ? 7 : 6;
    case Marker::square:
      return filled ? 5 : 4;
    case Marker::triangle:
      return filled ? 9 : 8;
    case Marker::diamond:
      return filled ? 13 : 12;
  }
  return 7;
}

/// The part of the plot command that draws one series.
/// \param plain " noenhanced", or nothing
std::string plot_clause(const Series& series, const PlotData::Place& place, const std::string& plain) {
  const std::string rows = place.last ? fmt::format("::{}::{}", place.first, *place.last) : "";
  const bool line = series.style == SeriesStyle::line || series.style == SeriesStyle::dashed_line;
  const std::string every = line ? " every stride" + rows : rows.empty() ? "" : " every " + rows;
  const std::string title = series.label.empty() ? "notitle" : "title " + gnuplot_string(series.label) + plain;
  const bool joined = series.style == SeriesStyle::line_with_points;
  const std::string look =
      line ? fmt::format("lines lw 1.8{}", series.style == SeriesStyle::dashed_line ? " dt (8,5)" : "")
           : fmt::format("{} lw 1.6 pt {} ps marker", joined ? "linespoints" : "points",
                         point_type(series.marker, series.filled));
  return fmt::format("data{} using \"{}\":\"{}\" with {} lc rgb '{}' {}", every, place.x, place.y, look,
                     hex(series.colour), title);
}

/// Points of lines that the SVG leaves out, so that it has at most 15,000 of them, less than 300 kB.
std::size_t svg_stride(const Plot& plot) {
  std::size_t points = 0;
  for (const Series& series : plot.series)
    points += series.style == SeriesStyle::line || series.style == SeriesStyle::dashed_line ? series.x.size() : 0;
  return points / 15000 + 1;
}

/// Names without repetition: "nu", "nu_2".
class UniqueNames {
 public:
  std::string add(const std::string& name, const char* fallback) {
    const std::string wanted = name.empty() ? fallback : name;
    std::string unique = wanted;
    for (int k = 2; std::ranges::find(names_, unique) != names_.end(); ++k) unique = fmt::format("{}_{}", wanted, k);
    names_.push_back(unique);
    return unique;
  }
  [[nodiscard]] const std::vector<std::string>& all() const { return names_; }

 private:
  std::vector<std::string> names_;
};

std::string series_name(const Series& series) {
  return column_name(series.column.empty() ? series.label : series.column);
}

double finite_or_nan(double value) {
  return std::isfinite(value) ? value : NAN;
}

/// A row for each x.
PlotData wide_table(const Plot& plot) {
  PlotData data;
  UniqueNames names;
  Table table;
  const auto add = [&](const std::vector<double>& values, const std::string& name, const char* fallback) {
    const std::string unique = names.add(name, fallback);
    table.view(unique, values, finite_or_nan);
    return unique;
  };
  for (const Series& series : plot.series) {
    PlotData::Place& place = data.places.emplace_back();
    place.x = table.columns().empty() ? add(series.x, column_name(plot.x.label), "x") : data.places.front().x;
    place.y = add(series.y, series_name(series), "y");
  }
  data.csv = table.csv();
  return data;
}

/// A row for each point.
PlotData tidy_table(const Plot& plot) {
  PlotData data;
  UniqueNames columns, names;
  columns.add("series", "");
  const std::string x = columns.add(column_name(plot.x.label), "x"), y = columns.add(column_name(plot.y.label), "y");
  std::size_t row = 0, total = 0;
  for (const Series& series : plot.series) total += series.x.size();
  CsvText text(columns.all());
  for (const Series& series : plot.series) {
    const std::string name = names.add(series_name(series), "y");
    const std::size_t first = series.x.empty() ? total : row;  // behind all rows: no point
    row += series.x.size();
    data.places.push_back({x, y, first, series.x.empty() ? first : row - 1});
    for (std::size_t k = 0; k < series.x.size(); ++k) {
      text.cell(name);
      text.cell(finite_or_nan(series.x[k]));
      text.cell(finite_or_nan(series.y[k]));
      text.end_row();
    }
  }
  data.csv = text.text();
  return data;
}

/// A label without the signs of gnuplot's enhanced text.
std::string without_markup(const std::string& label) {
  std::string text;
  for (std::size_t k = 0; k < label.size(); ++k) {
    if (label[k] == '\\' && k + 1 < label.size()) {
      text += label[++k];
    } else if (std::string_view("{}_^").find(label[k]) == std::string_view::npos) {
      text += label[k];
    }
  }
  return text;
}

/// Whether a picture has its end: gnuplot exits with 0 where a full disk cuts one.
bool is_whole(const std::filesystem::path& picture) {
  constexpr std::streamoff tail = 16;
  std::ifstream file(picture, std::ios::binary | std::ios::ate);
  const std::streamoff size = file.tellg();
  if (size < tail || !file.seekg(size - tail)) return false;
  std::string text(tail, '\0');
  file.read(text.data(), tail);
  return text.find(picture.extension() == ".svg" ? "</svg>" : "IEND") != std::string::npos;
}

/// Write data and script, and let gnuplot draw. An interruption leaves no part of a picture.
std::string draw(const std::filesystem::path& folder, const std::string& name, const std::string& title,
                 const std::string& csv, const std::string& script, bool overwrite) {
  const auto path = [&](const char* extension) { return folder / (name + extension); };
  for (const char* extension : {".csv", ".gp", ".svg", ".png"}) check_writable(path(extension), overwrite);

  write_file(path(".csv"), csv, overwrite);
  write_file(path(".gp"), script, overwrite);
  // A picture of earlier data must not stay beside new data where gnuplot fails.
  std::error_code ignored;
  const auto remove_pictures = [&] {
    for (const char* extension : {".svg", ".png"}) std::filesystem::remove(path(extension), ignored);
  };
  remove_pictures();
  GnuplotRun run{false, "gnuplot did not end at the plot before"};
  try {
    if (!DrawnFigures::gnuplot_hangs()) run = run_gnuplot(folder, name + ".gp");
  } catch (...) {
    remove_pictures();
    throw;
  }
  std::string missing;
  if (!run.succeeded || !is_whole(path(".svg")) || !is_whole(path(".png"))) {
    remove_pictures();
    missing = fmt::format("No picture was drawn ({}): data and script are in '{}' and '{}'.",
                          run.reason.empty() ? "gnuplot wrote no whole picture" : run.reason, path(".csv").string(),
                          path(".gp").string());
  }
  DrawnFigures::add({.name = name,
                     .title = title,
                     .file = missing.empty() ? path(".svg") : std::filesystem::path(),
                     .missing = missing,
                     .timed_out = run.timed_out});
  return missing;
}

}  // namespace

std::string literal(const std::string& text) {
  constexpr std::string_view special = "{}^_@&~\\";
  std::string result;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) result += '\\';
    result += c;
  }
  return result;
}

std::string with_symbols(const std::string& text) {
  struct Symbol {
    std::string_view word, drawn;
  };
  constexpr Symbol symbols[] = {{"kT", "k_T"}, {"kN", "k_N"}, {"nu", "ν"}};
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = at;
    while (end < text.size() && is_letter(text[end])) ++end;
    const std::string word = text.substr(at, std::max<std::size_t>(end - at, 1));
    std::string drawn = literal(word);
    for (const Symbol& symbol : symbols)
      if (word == symbol.word) drawn = symbol.drawn;
    result += drawn;
    at += word.size();
  }
  return result;
}

PlotData plot_data(const Plot& plot) {
  const bool same_x = std::ranges::all_of(plot.series, [&](const Series& s) { return s.x == plot.series.front().x; });
  return same_x ? wide_table(plot) : tidy_table(plot);
}

std::string plot_script(const std::string& name, const Plot& plot, const PlotData& data) {
  const AxisRange x = range_of(plot.x, plot.series, &Series::x);
  const AxisRange y = range_of(plot.y, plot.series, &Series::y);
  const std::string plain = plot.enhanced ? "" : " noenhanced";
  std::string axes = axis_scale('x', plot.x, x) + axis_scale('y', plot.y, y);
  for (const VerticalLine& line : plot.vertical_lines) axes += vertical_line(line, plain);
  if (plot.places) axes += "set size ratio -1\n";
  std::vector<std::string> clauses;
  for (std::size_t k = 0; k < plot.series.size(); ++k)
    clauses.push_back(plot_clause(plot.series[k], data.places[k], plain));
  return fmt::format(plot_gp_in, fmt::arg("name", name), fmt::arg("data", gnuplot_string(name + ".csv")),
                     fmt::arg("title", gnuplot_string(plot.title)), fmt::arg("x", gnuplot_string(plot.x.label)),
                     fmt::arg("y", gnuplot_string(plot.y.label)), fmt::arg("plain", plain), fmt::arg("x_min", x.min),
                     fmt::arg("x_max", x.max), fmt::arg("y_min", y.min), fmt::arg("y_max", y.max),
                     fmt::arg("axes", axes), fmt::arg("svg", gnuplot_string(name + ".svg")),
                     fmt::arg("png", gnuplot_string(name + ".png")), fmt::arg("stride", svg_stride(plot)),
                     fmt::arg("plot", fmt::format("plot {}\n", joined(clauses, ", \\\n     "))));
}

std::string write_plot(const std::filesystem::path& folder, const std::string& name, const Plot& plot, bool overwrite) {
  check_name(name);
  check_plot(plot);
  const PlotData data = plot_data(plot);
  const std::string title =
      fmt::format("{}{}{} against {}", plot.title, plot.title.empty() ? "" : ": ", plot.y.label, plot.x.label);
  return draw(folder, name, plot.enhanced ? without_markup(title) : title, data.csv, plot_script(name, plot, data),
              overwrite);
}

}  // namespace equidem
