// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/json.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "equidem/core/text.hpp"

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
  return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

void append(std::string& text, const Json& value, std::size_t depth) {
  const auto new_line = [&](std::size_t at) { text += '\n' + std::string(2 * at, ' '); };
  if (value.is_number_float()) {
    const double number = value.get<double>();
    text += std::isfinite(number) ? fmt::format("{}", number) : "null";
  } else if (is_scalar(value)) {
    text += value.dump(-1, ' ', false, Json::error_handler_t::replace);
  } else if (value.empty()) {
    text += value.is_array() ? "[]" : "{}";
  } else if (value.is_array()) {
    const bool one_line = fits_one_line(value);
    text += '[';
    for (std::size_t index = 0; index < value.size(); ++index) {
      if (index > 0) text += one_line ? ", " : ",";
      if (!one_line) new_line(depth + 1);
      append(text, value[index], depth + 1);
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
      append(text, entry, depth + 1);
    }
    new_line(depth);
    text += '}';
  }
}

std::vector<std::int64_t> discs_of(const StrainGauge& gauge) {
  return {gauge.first, gauge.second};
}

}  // namespace

struct JsonObject::Implementation {
  Json json = Json::object();
};

JsonObject::JsonObject() : implementation_(std::make_unique<Implementation>()) {}
JsonObject::~JsonObject() = default;
JsonObject::JsonObject(const JsonObject& other)
    : implementation_(std::make_unique<Implementation>(*other.implementation_)) {}
JsonObject& JsonObject::operator=(const JsonObject& other) {
  if (this != &other) implementation_ = std::make_unique<Implementation>(*other.implementation_);
  return *this;
}
JsonObject::JsonObject(JsonObject&&) noexcept = default;
JsonObject& JsonObject::operator=(JsonObject&&) noexcept = default;

JsonObject& JsonObject::set(const std::string& key, double value) {
  implementation_->json[key] = value;
  return *this;
}
JsonObject& JsonObject::set(const std::string& key, std::int64_t value) {
  implementation_->json[key] = value;
  return *this;
}
JsonObject& JsonObject::set(const std::string& key, bool value) {
  implementation_->json[key] = value;
  return *this;
}
JsonObject& JsonObject::set(const std::string& key, std::string_view value) {
  implementation_->json[key] = std::string(value);
  return *this;
}
JsonObject& JsonObject::set(const std::string& key, const Voigt& value) {
  return set(key, std::vector<double>{value.xx, value.yy, value.xy});
}
JsonObject& JsonObject::set(const std::string& key, const Tensor2& value) {
  return set(key, std::vector<std::vector<double>>{{value.xx, value.xy}, {value.yx, value.yy}});
}
JsonObject& JsonObject::set(const std::string& key, const std::vector<double>& values) {
  implementation_->json[key] = values;
  return *this;
}
JsonObject& JsonObject::set(const std::string& key, const std::vector<std::int64_t>& values) {
  implementation_->json[key] = values;
  return *this;
}
JsonObject& JsonObject::set(const std::string& key, const std::vector<std::string>& values) {
  implementation_->json[key] = values;
  return *this;
}
JsonObject& JsonObject::set(const std::string& key, const std::vector<std::vector<double>>& rows) {
  implementation_->json[key] = rows;
  return *this;
}
JsonObject& JsonObject::set(const std::string& key, const JsonObject& value) {
  const Json copy = value.implementation_->json;
  implementation_->json[key] = copy;
  return *this;
}
JsonObject& JsonObject::set(const std::string& key, const std::vector<JsonObject>& values) {
  Json array = Json::array();
  for (const JsonObject& value : values) array.push_back(value.implementation_->json);
  implementation_->json[key] = std::move(array);
  return *this;
}
JsonObject& JsonObject::set_null(const std::string& key) {
  implementation_->json[key] = nullptr;
  return *this;
}

bool JsonObject::contains(const std::string& key) const {
  return implementation_->json.contains(key);
}

std::string JsonObject::text() const {
  std::string text;
  append(text, implementation_->json, 0);
  return text + '\n';
}

std::string library_version() {
  return EQUIDEM_VERSION;
}

void add_common(JsonObject& object, const std::string& status, const std::string& report, const StageTimes& times,
                const Effects& effects) {
  JsonObject seconds;
  for (const auto& [stage, time] : times.stages()) seconds.set(stage, time);
  std::vector<std::string> active;
  JsonObject inactive;
  for (const Effects::Entry& entry : effects.entries) {
    if (entry.active) {
      active.push_back(entry.name);
    } else {
      inactive.set(entry.name, entry.why);
    }
  }
  JsonObject both;
  both.set("active", active).set("inactive", inactive);
  object.set("status", status)
      .set("report", report)
      .set("times", seconds)
      .set("effects", both)
      .set("version", library_version());
}

void add_equilibrium(JsonObject& object, const Equilibrium& equilibrium) {
  object.set("unknowns", equilibrium.unknowns)
      .set("relative_residual", equilibrium.relative_residual)
      .set("rounded_residual", equilibrium.rounded_residual)
      .set("condition", equilibrium.condition)
      .set("error_bound", equilibrium.error_bound)
      .set("negative_pivots", equilibrium.negative_pivots)
      .set("unstable_modes", equilibrium.unstable_modes)
      .set("refinements", equilibrium.refinements)
      .set("pivot_growth", equilibrium.pivot_growth)
      .set("factor_nonzeros", equilibrium.factor_nonzeros)
      .set("factor_bytes", equilibrium.factor_bytes)
      .set("solver", equilibrium.solver)
      .set("energy", equilibrium.energy);
  if (equilibrium.negative_pivots < 0) object.set_null("negative_pivots");
  if (equilibrium.unstable_modes < 0) object.set_null("unstable_modes");
}

std::optional<double> number_in_json(std::string_view text, const std::string& path) {
  const Json root = Json::parse(text, nullptr, false);
  std::string pointer = "/" + path;
  std::replace(pointer.begin(), pointer.end(), '.', '/');
  const Json::json_pointer at(pointer);
  if (root.is_discarded() || !root.contains(at) || !root[at].is_number()) return {};
  return root[at].get<double>();
}

void add_tension(JsonObject& object, const TensionTest& test, const TensionSetup& setup, const TensionResult& result) {
  JsonObject gauge;
  gauge.set("placement", to_string(test.gauge))
      .set("horizontal", discs_of(setup.horizontal))
      .set("vertical", discs_of(setup.vertical));
  object.set("poisson_ratio", result.poisson_ratio)
      .set("stiffness_ratio", result.stiffness_ratio)
      .set("strain", result.strain)
      .set("stress", result.stress)
      .set("fitted_poisson_ratio", result.fitted_poisson_ratio)
      .set("displacement_gradient", result.fitted_gradient)
      .set("height", setup.height)
      .set("gauge", gauge);
}

JsonObject solve_json(const std::string& status, const std::string& report, const StageTimes& times,
                      const Effects& effects, const Equilibrium& equilibrium) {
  JsonObject object;
  add_common(object, status, report, times, effects);
  add_equilibrium(object, equilibrium);
  return object;
}

}  // namespace equidem
