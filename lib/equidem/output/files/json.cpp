// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/json.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "equidem/core/text.hpp"
#include "equidem/output/results.hpp"

namespace equidem {
namespace {

using Json = nlohmann::ordered_json;

bool is_scalar(const Json& value) {
  return !value.is_array() && !value.is_object();
}

bool fits_one_line(const Json& array) {
  return std::all_of(array.begin(), array.end(),
                     [](const Json& v) { return v.is_number() || v.is_null() || v.is_boolean(); });
}

std::string quoted(const std::string& text) {
  const bool plain = std::ranges::all_of(text, [](char c) { return c >= ' ' && c < 127 && c != '"' && c != '\\'; });
  if (plain) return '"' + text + '"';
  return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

void append_json(std::string& text, const Json& value, std::size_t depth) {
  const auto new_line = [&](std::size_t at) { text += '\n' + std::string(2 * at, ' '); };
  if (value.is_number_float()) {
    const double number = value.get<double>();
    text += std::isfinite(number) ? fmt::format("{}", number) : "null";
  } else if (value.is_string()) {
    text += quoted(value.get_ref<const std::string&>());
  } else if (is_scalar(value)) {
    text += value.dump();
  } else if (value.empty()) {
    text += value.is_array() ? "[]" : "{}";
  } else if (value.is_array()) {
    const bool one_line = fits_one_line(value);
    text += '[';
    for (std::size_t index = 0; index < value.size(); ++index) {
      if (index > 0) text += one_line ? ", " : ",";
      if (!one_line) new_line(depth + 1);
      append_json(text, value[index], depth + 1);
    }
    if (!one_line) new_line(depth);
    text += ']';
  } else {
    text += '{';
    bool first = true;
    for (const auto& [key, entry] : value.items()) {
      if (!std::exchange(first, false)) text += ',';
      new_line(depth + 1);
      text += quoted(key) + ": ";
      append_json(text, entry, depth + 1);
    }
    new_line(depth);
    text += '}';
  }
}

Json object_of(const Results& results);

Json json_of(const ResultValue& value) {
  return std::visit(
      [](const auto& given) -> Json {
        using Given = std::remove_cvref_t<decltype(given)>;
        if constexpr (std::is_same_v<Given, ResultValue::Null>) {
          return nullptr;
        } else if constexpr (std::is_same_v<Given, std::shared_ptr<const Results>>) {
          return object_of(*given);
        } else if constexpr (std::is_same_v<Given, std::shared_ptr<const std::vector<Results>>>) {
          Json array = Json::array();
          for (const Results& one : *given) array.push_back(object_of(one));
          return array;
        } else {
          return given;
        }
      },
      value.value);
}

Json object_of(const Results& results) {
  Json object = Json::object();
  for (const Result& part : results.parts()) {
    if (part.key.empty()) continue;
    Json* at = &object;
    std::string_view path = part.key;
    for (std::size_t slash = path.find('/'); slash != std::string_view::npos; slash = path.find('/')) {
      at = &(*at)[std::string(path.substr(0, slash))];
      if (!at->is_object()) *at = Json::object();
      path.remove_prefix(slash + 1);
    }
    (*at)[std::string(path)] = json_of(part.value);
  }
  return object;
}

}  // namespace

std::string Results::json() const {
  std::string text;
  append_json(text, object_of(*this), 0);
  return text + '\n';
}

std::string library_version() {
  return EQUIDEM_VERSION;
}

std::optional<double> number_in_json(std::string_view text, const std::string& path) {
  const Json root = Json::parse(text, nullptr, false);
  std::string pointer = "/" + path;
  std::replace(pointer.begin(), pointer.end(), '.', '/');
  const Json::json_pointer at(pointer);
  if (root.is_discarded() || !root.contains(at) || !root[at].is_number()) return {};
  return root[at].get<double>();
}

}  // namespace equidem
