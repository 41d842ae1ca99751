// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/plots/plot.hpp"

#include <cmath>
#include <cstdlib>
#include <sstream>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/stopwatch.hpp"

#include "output/png.hpp"
#include "output/states.hpp"
#include "support/catch.hpp"

using namespace equidem;
namespace fs = std::filesystem;

namespace {

/// A plot with every feature.
Plot rich_plot() {
  return {.title = "Poisson's ratio",
          .x = {.label = "kT / kN", .min = -1, .max = 1},
          .y = {.label = "ν", .min = 0, .max = 0.6},
          .series = {{.label = "theory", .x = {-1, 1}, .y = {0.5, 0}},
                     {.label = "stable", .x = {0, 0.5, 1}, .y = {0.25, NAN, 0}, .style = SeriesStyle::points},
                     {.label = "unstable",
                      .x = {-0.9, -0.5, -0.4},
                      .y = {0.1, 7, -3},
                      .style = SeriesStyle::points,
                      .colour = PlotColour::vermilion,
                      .filled = false},
                     {.label = "joined",
                      .x = {0, 0.5, 1},
                      .y = {0.1, 0.2, 0.3},
                      .style = SeriesStyle::line_with_points,
                      .marker = Marker::diamond,
                      .filled = false}},
          .vertical_lines = {{.x = -1.0 / 3, .label = "lattice limit"}}};
}

bool gnuplot_is_missing(const std::string& no_picture) {
  if (no_picture.find("not installed") == std::string::npos) return false;
  WARN("not tested: gnuplot is missing");
  return true;
}

/// Draws a plot without an error; false: gnuplot is missing.
bool drawn(const TemporaryFolder& folder, const std::string& name, const Plot& plot) {
  const std::string no_picture = write_plot(folder.path(), name, plot, false);
  if (gnuplot_is_missing(no_picture)) return false;
  CAPTURE(no_picture);
  REQUIRE(no_picture.empty());
  return true;
}

/// The environment variable PATH, changed for a while.
class SearchPath {
 public:
  explicit SearchPath(const std::string& path) : before_(std::getenv("PATH")) { setenv("PATH", path.c_str(), 1); }
  ~SearchPath() { setenv("PATH", before_.c_str(), 1); }
  SearchPath(const SearchPath&) = delete;
  SearchPath& operator=(const SearchPath&) = delete;

 private:
  std::string before_;
};

}  // namespace

TEST_CASE("a_plot_is_data_a_script_that_runs_again_and_two_pictures") {
  const TemporaryFolder folder;
  if (!drawn(folder, "fig 7", rich_plot())) return;
  CHECK(folder.files() == 4);

  SECTION("the PNG is one, of the promised size") {
    const std::string png = read_file(folder / "fig 7.png");
    REQUIRE(png.size() > 5000);
    CHECK(png.substr(0, 8) == "\x89PNG\r\n\x1a\n");
    CHECK(big_endian(png, 16) == 900);
    CHECK(big_endian(png, 20) == 650);
  }
  SECTION("the SVG is well-formed") {
    CHECK(run_python("well_formed.py", {(folder / "fig 7.svg").string()}) == 0);
  }
  SECTION("the script draws again") {
    const std::string before = read_file(folder / "fig 7.png");
    fs::remove(folder / "fig 7.png");
    fs::remove(folder / "fig 7.svg");
    const GnuplotRun run = run_gnuplot(folder.path(), "fig 7.gp");
    CAPTURE(run.reason);
    CHECK(run.succeeded);
    const bool same = read_file(folder / "fig 7.png") == before;
    CHECK(same);
    CHECK(fs::exists(folder / "fig 7.svg"));
  }
  SECTION("the script speaks of its neighbours only") {
    CHECK(read_file(folder / "fig 7.gp").find(folder.path().string()) == std::string::npos);
  }
}

TEST_CASE("labels_of_an_axis_differ_and_round_off_is_drawn_as_a_straight_line") {
  // Between tics of 1, 2 or 5 times a power of ten: 2e-9 for a spread of 1e-8 beside 0.1, so that nine digits differ.
  const auto axis_of = [](double spread) {
    const Series path{.label = "path", .x = {0.1, 0.1 + spread, 0.1}, .y = {0, 1, 2}};
    const Plot plot{.x = {.label = "x, m"}, .y = {.label = "y, m"}, .series = {path}};
    const std::string script = plot_script("path", plot, plot_data(plot));
    const std::size_t range = script.find("set xrange"), format = script.find("set format x");
    return std::pair(script.substr(range, script.find('\n', range) - range), script.substr(format, 20));
  };
  CHECK(axis_of(0.05).second.starts_with("set format x '%g'"));
  CHECK(axis_of(1e-8).second.starts_with("set format x '%.9g'"));
  CHECK(axis_of(1e-8).first != axis_of(0).first);
  CHECK(axis_of(2e-14) == axis_of(0));
}

TEST_CASE("logarithmic_axes_are_drawn") {
  const double largest = GENERATE(40.0, 1e6);
  const TemporaryFolder folder;
  const Plot plot{.x = {.label = "n", .logarithmic = true},
                  .y = {.label = "error", .logarithmic = true},
                  .series = {{.label = "e", .x = {3, largest}, .y = {0.1, 0.1 / largest}}}};
  CAPTURE(largest);
  if (!drawn(folder, "error", plot)) return;
}

TEST_CASE("series_with_the_same_x_are_columns_of_one_table") {
  const Plot plot{.x = {.label = "kT / kN"},
                  .series = {{.label = "nu, theory", .x = {0, 1}, .y = {0.25, 0}},
                             {.label = "other", .x = {0, 1}, .y = {1, NAN}, .column = "stable"},
                             {.label = "", .x = {0, 1}, .y = {1, 2}},
                             {.label = "nu theory", .x = {0, 1}, .y = {4, 5}}}};
  const PlotData data = plot_data(plot);
  CHECK(data.csv == "kT_kN,nu_theory,stable,y,nu_theory_2\n0,0.25,1,1,4\n1,0,nan,2,5\n");
  CHECK(data.places[3].x == "kT_kN");
  CHECK_FALSE(data.places[3].last);
}

TEST_CASE("series_with_different_x_have_a_row_for_each_point_and_no_cell_is_padded") {
  const Plot plot{.x = {.label = "kT / kN"},
                  .y = {.label = "nu"},
                  .series = {{.label = "theory", .x = {0, 1}, .y = {0.25, NAN}},
                             {.label = "none"},
                             {.label = "", .x = {0, 0.5, 1}, .y = {1, 2, 3}},
                             {.label = "theory", .x = {0}, .y = {4}}}};
  const PlotData data = plot_data(plot);
  CHECK(data.csv == "series,kT_kN,nu\ntheory,0,0.25\ntheory,1,nan\ny,0,1\ny,0.5,2\ny,1,3\ntheory_2,0,4\n");
  CHECK((data.places[2].first == 2 && data.places[2].last == 4));
  CHECK(data.places[1].first == 6);  // behind all rows
}

TEST_CASE("gnuplot_draws_each_series_from_its_own_rows") {
  const TemporaryFolder folder;
  const Plot plot{.series = {{.label = "a", .x = {0, 1, 2}, .y = {1, NAN, 3}},
                             {.label = "b", .x = {5, 6}, .y = {7, 9}, .style = SeriesStyle::points},
                             {.label = "c", .x = {8}, .y = {-4}, .style = SeriesStyle::points}}};
  if (!drawn(folder, "rows", plot)) return;
  std::string script = read_file(folder / "rows.gp");
  const std::size_t first = script.find("\nplot "), end = script.find("\nset terminal pngcairo");
  REQUIRE(end != std::string::npos);
  script = script.substr(0, first) + "\nset table 'used.txt'" + script.substr(first, end - first) + "\nunset table\n";
  write_file(folder / "table.gp", script, false);
  const GnuplotRun run = run_gnuplot(folder.path(), "table.gp");
  CAPTURE(run.reason);
  REQUIRE(run.succeeded);
  const std::string used = read_file(folder / "used.txt");
  for (std::size_t k = 0; k < plot.series.size(); ++k) {
    const std::size_t curve = used.find(fmt::format("# Curve {} of", k));
    REQUIRE(curve != std::string::npos);
    std::istringstream lines(used.substr(curve, used.find(fmt::format("# Curve {} of", k + 1)) - curve));
    std::vector<double> x, y;
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      double px = 0, py = 0;
      if (words >> px >> py) x.push_back(px), y.push_back(py);
    }
    std::vector<double> wanted_x, wanted_y;
    for (std::size_t point = 0; point < plot.series[k].x.size(); ++point) {
      if (!std::isfinite(plot.series[k].y[point])) continue;
      wanted_x.push_back(plot.series[k].x[point]), wanted_y.push_back(plot.series[k].y[point]);
    }
    CAPTURE(k, script);
    CHECK(x == wanted_x);
    CHECK(y == wanted_y);
  }
}

TEST_CASE("an_svg_of_long_histories_stays_small") {
  const TemporaryFolder folder;
  Plot plot;
  for (int s = 0; s < 5; ++s) {
    Series series{.label = std::to_string(s)};
    for (int k = 0; k < 20000; ++k) {
      series.x.push_back(1e-3 * k);
      series.y.push_back(std::sin(0.01 * k + s));
    }
    plot.series.push_back(series);
  }
  if (!drawn(folder, "long", plot)) return;
  CHECK(fs::file_size(folder / "long.svg") < 300000);
  CHECK(fs::file_size(folder / "long.csv") > 300000);
}

TEST_CASE("text_of_the_user_is_literal_where_other_text_has_subscripts") {
  CHECK(literal("a_b^{c} \\ @d ~ & e") == "a\\_b\\^\\{c\\} \\\\ \\@d \\~ \\& e");
  CHECK(with_symbols("kT/kN = 0.5, nu of kT_max, menu") == "k_T/k_N = 0.5, ν of k_T\\_max, menu");
  const TemporaryFolder folder;
  Plot plot{.title = literal("my_{sweep}^2"),
            .x = {.label = "k_T/k_N"},
            .series = {{.x = {1, 2}, .y = {1, 2}}},
            .enhanced = true};
  if (!drawn(folder, "texts", plot)) return;
  const std::string svg = read_file(folder / "texts.svg");
  CHECK(svg.find("my_{sweep}^2") != std::string::npos);
  CHECK(svg.find("k_T") == std::string::npos);
}

TEST_CASE("no_text_reaches_a_shell_or_breaks_the_script_or_the_svg") {
  const TemporaryFolder folder;
  const std::string wild =
      "`touch pwned` $(touch pwned) 'quote' \"double\" {a}_b^c @d \\ % # \n'; system('touch pwned') ]]> ]]]]>> <c> & "
      "\x01\x1b d";
  Plot plot = rich_plot();
  plot.title = plot.x.label = plot.y.label = plot.series[0].label = wild;
  plot.vertical_lines[0].label = wild;
  if (!drawn(folder, "wild", plot)) return;
  CHECK_FALSE(fs::exists(folder / "pwned"));
  CHECK_FALSE(fs::exists("pwned"));
  CHECK(run_python("well_formed.py", {(folder / "wild.svg").string()}) == 0);
}

TEST_CASE("without_gnuplot_data_and_script_stay") {
  const TemporaryFolder folder;
  const TemporaryFolder nothing_here;
  const SearchPath path(nothing_here.path().string());
  const std::string no_picture = write_plot(folder.path(), "fig7", rich_plot(), false);
  CAPTURE(no_picture);
  CHECK_FALSE(no_picture.empty());
  CHECK(no_picture.find("gnuplot is not installed") != std::string::npos);
  for (const char* file : {"fig7.csv", "fig7.gp"}) CHECK(fs::exists(folder / file));
  CHECK(folder.files() == 2);
}

TEST_CASE("a_script_that_gnuplot_refuses_is_told") {
  const TemporaryFolder folder;
  write_file(folder / "bad.gp", "set nonsense\n", false);
  const GnuplotRun run = run_gnuplot(folder.path(), "bad.gp");
  if (run.reason == "gnuplot is not installed") return;
  CAPTURE(run.reason);
  CHECK_FALSE(run.succeeded);
  CHECK(run.reason.find("line 1") != std::string::npos);
  write_file(folder / "slow.gp", "pause 20\n", false);
  const GnuplotRun slow = run_gnuplot(folder.path(), "slow.gp", 0.2);
  CAPTURE(slow.reason);
  CHECK_FALSE(slow.succeeded);
  CHECK(slow.reason.find("took more than 0.2 s") != std::string::npos);
}

TEST_CASE("a_gnuplot_that_ignores_signals_is_killed_with_all_that_it_has_started") {
  const TemporaryFolder folder, programs;
  write_file(programs / "gnuplot",
             "#!/bin/sh\ntrap '' TERM INT HUP\n/bin/sleep 100 &\nwhile :; do /bin/sleep 1; done\n", false);
  fs::permissions(programs / "gnuplot", fs::perms::owner_all);
  const SearchPath path(programs.path().string());
  const Stopwatch watch;
  const GnuplotRun run = run_gnuplot(folder.path(), "any.gp", 0.3);
  CAPTURE(run.reason);
  CHECK_FALSE(run.succeeded);
  CHECK(run.timed_out);
  CHECK(watch.seconds() < 50);  // not the 100 s of what holds its stderr
}

TEST_CASE("no_part_of_a_picture_is_left_behind") {
  const bool interrupted = GENERATE(false, true);
  CAPTURE(interrupted);
  const TemporaryFolder folder, programs;
  write_file(programs / "gnuplot",
             std::string("#!/bin/sh\nprintf '<svg' > fig7.svg\nprintf '\\211PNG\\r\\n' > fig7.png\n") +
                 (interrupted ? "kill -INT $PPID\n/bin/sleep 20\n" : ""),
             false);
  fs::permissions(programs / "gnuplot", fs::perms::owner_all);
  const SearchPath path(programs.path().string());
  const InterruptCatcher catcher;
  if (interrupted) {
    CHECK_THROWS_AS(write_plot(folder.path(), "fig7", rich_plot(), false), Error);
  } else {
    CHECK_THAT(write_plot(folder.path(), "fig7", rich_plot(), false), Catch::Contains("no whole picture"));
  }
  for (const char* file : {"fig7.csv", "fig7.gp"}) CHECK(fs::exists(folder / file));
  CHECK(folder.files() == 2);
}

TEST_CASE("a_plot_that_cannot_be_drawn_is_refused") {
  const TemporaryFolder folder;
  const Plot good{.series = {{.label = "s", .x = {1, 2}, .y = {1, 2}}}};
  const auto refused = [&](const std::string& name, const Plot& plot, const std::string& words) {
    CAPTURE(name, words);
    CHECK_THROWS_WITH(write_plot(folder.path(), name, plot, false), Catch::Contains(words));
  };
  for (const char* name : {"", "| rm", "<cat", "a/b", "../up", "-x", "it's", "a`b`", "new\nline"}) {
    refused(name, good, "cannot name the files");
  }
  Plot plot = good;
  plot.series[0].x.push_back(3);
  refused("p", plot, "3 values of x and 2 values of y");
  plot = good;
  plot.series[0].y = {NAN, INFINITY};
  refused("p", plot, "no finite point");
  plot = good;
  plot.y.logarithmic = true;
  plot.series[0].y[1] = -2;
  refused("p", plot, "(2, -2)");
  plot = good;
  plot.x.min = 2, plot.x.max = 1;
  refused("p", plot, "from 2 to 1");
  CHECK(folder.files() == 0);
}
