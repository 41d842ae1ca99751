// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/plots/bar_chart.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/plots/gnuplot_text.hpp"

namespace equidem {

std::string bar_data(const BarChart& chart) {
  CsvText text({"label", "value", "low", "high"}, chart.bars.size());
  for (const Bar& bar : chart.bars) {
    const bool ends = bar.low != 0 || bar.high != 0;
    text.cell(bar.label);
    for (const double number : {bar.value, ends ? bar.low : NAN, ends ? bar.high : NAN}) text.cell(number);
    text.end_row();
  }
  return text.text();
}

std::string bar_script(const std::string& name, const BarChart& chart) {
  double longest = 0;
  std::size_t widest = 0;
  for (const Bar& bar : chart.bars) {
    longest = std::max({longest, bar.value, bar.high});
    widest = std::max(widest, columns_of(bar.label));
  }
  const auto count = static_cast<double>(chart.bars.size());
  std::string text = script_head(name, chart.title, " noenhanced");
  text += fmt::format(
      "set xlabel {} noenhanced\nset lmargin {}\nset xrange [0:{}]\nset yrange [{}:0.4]\nset border 1\n"
      "set ytics scale 0 noenhanced\nset grid xtics lw 0.5 lc rgb '#dddddd'\nset style fill solid noborder\nunset "
      "key\n",
      gnuplot_string(chart.axis), widest + 2, longest > 0 ? 1.22 * longest : 1, count + 0.6);
  std::vector<std::string> tics;
  double row = 0;
  for (const Bar& bar : chart.bars) {
    row += 1;
    tics.push_back(fmt::format("{} {}", gnuplot_string(bar.label), row));
    text += fmt::format("set object rectangle from 0,{} to {},{} fc rgb '{}' fs solid noborder\n", row - 0.34,
                        bar.value, row + 0.34, hex(bar.colour));
    text += fmt::format(
        "set label {} at {},{} left offset 0.7,0 noenhanced\n",
        gnuplot_string(fmt::format(
            "{}{}{}", bar.value < 1000 ? fmt::format("{:.3g}", bar.value) : grouped(std::llround(bar.value)),
            bar.note.empty() ? "" : "  ", bar.note)),
        std::max(bar.value, bar.high), row);
  }
  text += fmt::format("set ytics ({})\n", joined(tics, ", \\\n     "));
  return text + draw_twice(name, [&](double font_size) {
           return title_font(chart.title, font_size) + fmt::format("set ytics font ',{:.3g}'\n", 0.9 * font_size) +
                  "plot data using \"value\":($0 + 1):\"low\":\"high\" with xerrorbars pt -1 lw 1.2 lc rgb '#222222'\n";
         });
}

}  // namespace equidem
