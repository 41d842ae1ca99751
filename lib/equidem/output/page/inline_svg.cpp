// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/page/inline_svg.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "equidem/core/text.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/output/files/xml.hpp"

namespace equidem {
namespace {

using Attributes = std::vector<std::pair<std::string_view, std::string>>;

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

/// The attributes of a tag, those of its style among them.
/// \param inside of the tag, behind its name; values in double quotes
Attributes attributes_of(std::string_view inside) {
  Attributes all;
  for (std::size_t at = 0;;) {
    const std::size_t equals = inside.find("=\"", at);
    if (equals == std::string_view::npos) return all;
    const std::size_t end = inside.find('"', equals + 2);
    const std::string_view name = trimmed(inside.substr(at, equals - at));
    const std::string_view value = inside.substr(equals + 2, end - equals - 2);
    at = end == std::string_view::npos ? inside.size() : end + 1;
    if (name != "style") {
      all.emplace_back(name, value);
      continue;
    }
    for (const std::string_view one : parts_of(value, ';')) {
      const std::size_t colon = one.find(':');
      if (colon != std::string_view::npos) all.emplace_back(trimmed(one.substr(0, colon)), one.substr(colon + 1));
    }
  }
}

/// "#808080" of "rgb(50%,50%,50%)"; other values as they are.
std::string short_colour(const std::string& value) {
  if (!value.starts_with("rgb(") || !value.ends_with("%)")) return value;
  std::string colour = "#";
  for (const std::string_view share : parts_of(std::string_view(value).substr(4, value.size() - 5), ',')) {
    double percentage = 0;
    const std::string_view digits = trimmed(share);
    std::from_chars(digits.data(), digits.data() + digits.size(), percentage);
    colour += fmt::format("{:02x}", std::lround(255 * percentage / 100));
  }
  return colour;
}

/// Attributes that say what holds without them.
bool is_default(std::string_view name, std::string_view value) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 7> defaults{{{"stroke", "none"},
                                                                                   {"fill-rule", "nonzero"},
                                                                                   {"fill-opacity", "1"},
                                                                                   {"stroke-opacity", "1"},
                                                                                   {"stroke-linecap", "butt"},
                                                                                   {"stroke-linejoin", "miter"},
                                                                                   {"stroke-miterlimit", "10"}}};
  for (const auto& known : defaults)
    if (known == std::pair(name, value)) return true;
  return false;
}

std::string short_number(double value) {
  std::string text = fmt::format("{:.2f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text == "-0" ? "0" : text;
}

/// A command of a path with its numbers.
struct PathCommand {
  char letter;
  std::vector<double> numbers = {};

  [[nodiscard]] Vec2 end() const { return {numbers[numbers.size() - 2], numbers.back()}; }
};

/// None where a word is neither a letter nor a number.
std::optional<std::vector<PathCommand>> commands_of(std::string_view path) {
  std::vector<PathCommand> commands;
  for (const std::string_view word : parts_of(path, ' ')) {
    if (word.empty()) continue;
    double number = 0;
    const auto [end, failed] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (failed == std::errc() && end == word.data() + word.size() && !commands.empty()) {
      commands.back().numbers.push_back(number);
    } else if (word.size() == 1) {
      commands.push_back({word.front()});
    } else {
      return std::nullopt;
    }
  }
  // cairo moves back to the start of a path that it closed.
  if (commands.size() > 2 && commands.back().letter == 'M') commands.pop_back();
  return commands;
}

/// The attributes of a circle that a path of four arcs draws.
std::optional<std::string> circle_of(const std::vector<PathCommand>& path) {
  if (path.size() != 6 || path.front().letter != 'M' || path.back().letter != 'Z') return std::nullopt;
  for (std::size_t k = 1; k < 5; ++k)
    if (path[k].letter != 'C' || path[k].numbers.size() != 6) return std::nullopt;
  if (path.front().numbers.size() != 2) return std::nullopt;
  constexpr double rounding = 0.02;
  const Vec2 centre = 0.5 * (path[0].end() + path[2].end());
  const double radius = 0.5 * norm(path[0].end() - path[2].end());
  for (const std::size_t k : {1U, 3U})
    if (std::abs(norm(path[k].end() - centre) - radius) > rounding) return std::nullopt;
  return fmt::format("cx=\"{}\" cy=\"{}\" r=\"{}\"", short_number(centre.x), short_number(centre.y),
                     short_number(radius));
}

std::string short_path(const std::vector<PathCommand>& path) {
  std::string text;
  for (const PathCommand& command : path) {
    text += command.letter;
    for (std::size_t k = 0; k < command.numbers.size(); ++k) {
      const std::string number = short_number(command.numbers[k]);
      text += (k > 0 && !number.starts_with('-') ? " " : "") + number;
    }
  }
  return text;
}

/// A path of cairo in fewer bytes. \param inside of the tag, between "<path" and "/>"
std::string short_tag(std::string_view inside) {
  std::string styles, shape;
  bool circle = false;
  for (const auto& [name, value] : attributes_of(inside)) {
    if (name != "d") {
      if (!is_default(name, value)) styles += fmt::format(" {}=\"{}\"", name, short_colour(value));
      continue;
    }
    const auto path = commands_of(value);
    const auto round = path ? circle_of(*path) : std::nullopt;
    circle = round.has_value();
    shape = round ? *round : fmt::format("d=\"{}\"", path ? short_path(*path) : value);
  }
  return fmt::format("<{} {}{}/>", circle ? "circle" : "path", shape, styles);
}

/// Replace every `from` by `to`.
void replace_all(std::string& text, std::string_view from, std::string_view to) {
  std::string replaced;
  std::size_t copied = 0;
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, copied)) {
    replaced.append(text, copied, at - copied).append(to);
    copied = at + from.size();
  }
  text = replaced.append(text, copied);
}

/// Replaces names of elements by the prefix and a number: cairo counts its names through all drawings of a process.
void number_names(std::string& svg, const std::string& prefix) {
  constexpr std::array<std::pair<std::string_view, char>, 5> places{
      {{" id=\"", '"'}, {" id='", '\''}, {"href=\"#", '"'}, {"href='#", '\''}, {"url(#", ')'}}};
  std::map<std::string, std::string, std::less<>> names;
  for (const auto& [before, behind] : places) {
    std::string renamed;
    std::size_t copied = 0;
    for (std::size_t at = svg.find(before); at != std::string::npos; at = svg.find(before, copied)) {
      const std::size_t from = at + before.size(), end = svg.find(behind, from);
      if (end == std::string::npos) break;
      const auto [name, added] = names.try_emplace(svg.substr(from, end - from));
      if (added) name->second = fmt::format("{}{}", prefix, names.size());
      renamed.append(svg, copied, from - copied).append(name->second);
      copied = end;
    }
    svg = renamed.append(svg, copied);
  }
}

void remove_elements(std::string& svg, const std::string& name) {
  const std::string end_tag = "</" + name + ">";
  for (std::size_t from = svg.find("<" + name + ">"); from != std::string::npos;
       from = svg.find("<" + name + ">", from)) {
    const std::size_t end = svg.find(end_tag, from);
    if (end == std::string::npos) return;
    svg.erase(from, end + end_tag.size() - from);
  }
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(4 * (bytes.size() / 3 + 1));
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - at);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[at + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? digits[group >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

}  // namespace

std::string inline_svg(std::string_view file, const std::string& prefix, const std::string& title) {
  const std::size_t root = file.find("<svg");
  const std::size_t content = file.find('>', root == std::string_view::npos ? 0 : root);
  if (root == std::string_view::npos || content == std::string_view::npos) return {};
  std::string view;
  for (const auto& [name, value] : attributes_of(file.substr(root + 4, content - root - 4)))
    if (name.ends_with("viewBox")) view = value;
  std::string svg = fmt::format("<svg viewBox=\"{}\" role=\"img\" aria-label=\"{}\">", view, escape_xml(title));
  for (std::size_t at = content + 1; at < file.size();) {
    const std::size_t path = file.find("<path ", at), end = file.find("/>", path);
    if (path == std::string_view::npos || end == std::string_view::npos) {
      svg += file.substr(at);
      break;
    }
    svg += file.substr(at, path - at);
    const std::string_view inside = file.substr(path + 5, end - path - 5);
    const bool of_cairo = inside.find('\'') == std::string_view::npos;
    svg += of_cairo ? short_tag(inside) : std::string(file.substr(path, end + 2 - path));
    at = end + 2;
  }
  remove_elements(svg, "title");  // names that gnuplot gives its drawing and curves
  remove_elements(svg, "desc");
  number_names(svg, prefix);
  replace_all(svg, "xlink:href", "href");
  return svg;
}

std::string inline_png(std::string_view file, const std::string& title) {
  return fmt::format("<img alt=\"{}\" src=\"data:image/png;base64,{}\">", escape_xml(title), base64(file));
}

}  // namespace equidem
