// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/plots/gnuplot_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr std::array<const char*, 8> palette = {"#000000", "#E69F00", "#56B4E9", "#009E73",
                                                "#F0E442", "#0072B2", "#D55E00", "#CC79A7"};

bool is_letter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0;
}

}  // namespace

std::string gnuplot_string(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') result += '\'';
    if (c == '>' && result.ends_with("]]")) result += ' ';  // gnuplot leaves it in the SVG, and XML forbids it
    result += std::iscntrl(static_cast<unsigned char>(c)) != 0 ? ' ' : c;
  }
  return result + "'";
}

const char* hex(PlotColour colour) {
  return palette[static_cast<std::size_t>(colour)];
}

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

std::string script_head(const std::string& name, const std::string& title, const std::string& plain) {
  return fmt::format(
      "# Draws {0}.svg and {0}.png from {0}.csv. Edit it and run, in this folder:  gnuplot {0}.gp\n"
      "data = {1}\nset datafile separator comma\nset encoding utf8\n\n"
      "set border 3 lw 0.8 lc rgb '#333333'\nset tics out nomirror scale 0.7 tc rgb '#222222'\n"
      "set title {2} offset 0,-0.2{3}\n",
      name, gnuplot_string(name + ".csv"), gnuplot_string(title), plain);
}

std::string title_font(const std::string& title, double font_size) {
  constexpr double fits = 90;  // characters
  const auto width = static_cast<double>(columns_of(title));
  return width > fits ? fmt::format("set title font ',{:.3g}'\n", font_size * fits / width) : "";
}

std::string draw_twice(const std::string& name, const std::function<std::string(double font_size)>& commands,
                       std::size_t svg_stride) {
  const auto draw = [&](const char* terminal, const char* extension, double font_size, double marker,
                        std::size_t stride) {
    return fmt::format(
        "\nset terminal {} size 900,650 enhanced font 'sans-serif,{}' background rgb 'white'\n"
        "set output {}\nmarker = {}\nstride = {}\n{}",
        terminal, font_size, gnuplot_string(name + extension), marker, stride, commands(font_size));
  };
  return draw("svg", ".svg", 16, 0.72, svg_stride) + draw("pngcairo", ".png", 13, 1.25, 1) + "set output\n";
}

}  // namespace equidem
