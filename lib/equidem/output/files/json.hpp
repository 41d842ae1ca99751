// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The result of a verb as one JSON object.
#pragma once

#include <concepts>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/contact/effects.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/homogenize/tension_test.hpp"
#include "equidem/statics/equilibrium.hpp"

namespace equidem {

/// An object whose keys keep the order in which they were set; setting a key again replaces its value. Numbers are
/// written in the shortest form that reads back to the same bits; NaN and infinity, which JSON lacks, become null.
/// Text that is not UTF-8 has its bad bytes replaced.
class JsonObject {
 public:
  JsonObject();
  ~JsonObject();
  JsonObject(const JsonObject& other);
  JsonObject& operator=(const JsonObject& other);
  JsonObject(JsonObject&&) noexcept;
  JsonObject& operator=(JsonObject&&) noexcept;

  JsonObject& set(const std::string& key, double value);
  JsonObject& set(const std::string& key, std::int64_t value);
  JsonObject& set(const std::string& key, bool value);
  JsonObject& set(const std::string& key, std::string_view value);
  JsonObject& set(const std::string& key, const char* value) { return set(key, std::string_view(value)); }
  JsonObject& set(const std::string& key, const Voigt& value);    ///< [xx, yy, xy]
  JsonObject& set(const std::string& key, const Tensor2& value);  ///< [[xx, xy], [yx, yy]]
  JsonObject& set(const std::string& key, const std::vector<double>& values);
  JsonObject& set(const std::string& key, const std::vector<std::int64_t>& values);
  JsonObject& set(const std::string& key, const std::vector<std::string>& values);
  JsonObject& set(const std::string& key, const std::vector<std::vector<double>>& rows);
  JsonObject& set(const std::string& key, const JsonObject& value);
  JsonObject& set(const std::string& key, const std::vector<JsonObject>& values);
  template <std::integral Integer>
  JsonObject& set(const std::string& key, Integer value) {
    return set(key, static_cast<std::int64_t>(value));
  }
  /// The value null: asked for, but not known.
  JsonObject& set_null(const std::string& key);

  [[nodiscard]] bool contains(const std::string& key) const;
  /// Indented by two spaces, arrays of numbers on one line, with a final line break.
  [[nodiscard]] std::string text() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// The number at a path of keys and positions such as "poisson_ratio.plane_strain" or "stress.0" in a JSON text; none
/// where there is none.
std::optional<double> number_in_json(std::string_view text, const std::string& path);

/// The version of the library, "0.1.0".
std::string library_version();

/// The keys of every verb: status, report, times (seconds per stage), effects {active: [names], inactive: {name:
/// why}}, version.
void add_common(JsonObject& object, const std::string& status, const std::string& report, const StageTimes& times,
                const Effects& effects);

/// unknowns, relative_residual, rounded_residual, negative_pivots and unstable_modes (null where unknown), refinements,
/// pivot_growth, factor_nonzeros, factor_bytes, solver, energy (N).
void add_equilibrium(JsonObject& object, const Equilibrium& equilibrium);

/// poisson_ratio, stiffness_ratio, strain and stress (Voigt), fitted_poisson_ratio, displacement_gradient (fitted),
/// height (m), gauge {placement, horizontal: [disc, disc], vertical: [disc, disc]}.
void add_tension(JsonObject& object, const TensionTest& test, const TensionSetup& setup, const TensionResult& result);

/// The whole object of `equidem solve` but for the tension test: add_common, then add_equilibrium.
/// \param times of all stages of the verb, those of the equilibrium among them
JsonObject solve_json(const std::string& status, const std::string& report, const StageTimes& times,
                      const Effects& effects, const Equilibrium& equilibrium);

}  // namespace equidem
