// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// VTK XML PolyData (.vtp): points, vertices and lines with arrays, as appended raw binary.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

#include "equidem/core/vector.hpp"

namespace equidem {

/// "LittleEndian" or "BigEndian": the byte order of this machine.
const char* vtk_byte_order();

/// The x, y or z = 0 of a vector.
constexpr double component_of(Vec2 v, int component) {
  return component == 0 ? v.x : component == 1 ? v.y : 0.0;
}

/// One piece of PolyData. Arrays are declared first and generated in text(), so that only the text of the file is held.
/// Appended raw data: an underscore, then for each array its length in bytes (UInt64) and its numbers; the offsets in
/// the declarations count from behind the underscore.
class PolyData {
 public:
  PolyData(std::size_t points, std::size_t vertices, std::size_t lines);

  /// value(tuple, component) for every tuple in [0, tuples).
  template <class Number, class Value>
  void declare(const std::string& section, const std::string& name, std::size_t tuples, int components, Value value) {
    const std::uint64_t bytes = tuples * static_cast<std::uint64_t>(components) * sizeof(Number);
    declare(section, vtk_type<Number>(), name, tuples, components, bytes);
    arrays_.push_back([=](std::string& text) {
      append_bytes(text, bytes);
      for (std::size_t tuple = 0; tuple < tuples; ++tuple) {
        for (int component = 0; component < components; ++component) {
          append_bytes(text, static_cast<Number>(value(tuple, component)));
        }
      }
    });
  }
  /// An array of doubles at every point; number(point) or, of 3-vectors, vector(point).
  template <class Value>
  void point_numbers(const std::string& name, Value number) {
    declare<double>("PointData", name, points_, 1, [=](std::size_t point, int) { return number(point); });
  }
  template <class Value>
  void point_vectors(const std::string& name, Value vector) {
    declare<double>("PointData", name, points_, 3,
                    [=](std::size_t point, int component) { return component_of(vector(point), component); });
  }
  /// place(point), and a vertex at each of the points that vertices were declared for.
  template <class Value>
  void places(Value place) {
    declare<double>("Points", "Points", points_, 3,
                    [=](std::size_t point, int component) { return component_of(place(point), component); });
    if (vertices_ == 0) return;
    declare<std::int32_t>("Verts", "connectivity", vertices_, 1, [](std::size_t vertex, int) { return vertex; });
    declare<std::int32_t>("Verts", "offsets", vertices_, 1, [](std::size_t vertex, int) { return vertex + 1; });
  }

  /// The file. \param time in s, kept as the field "TimeValue" that VTK's readers take for the time of the data
  [[nodiscard]] std::string text(const double* time = nullptr);

 private:
  template <class Number>
  static constexpr const char* vtk_type() {
    if constexpr (std::is_same_v<Number, double>) return "Float64";
    if constexpr (std::is_same_v<Number, std::int32_t>) return "Int32";
    if constexpr (std::is_same_v<Number, std::int64_t>) return "Int64";
  }
  template <class Number>
  static void append_bytes(std::string& text, Number number) {
    char bytes[sizeof number];
    std::memcpy(bytes, &number, sizeof number);
    text.append(bytes, sizeof number);
  }
  void declare(const std::string& section, const char* type, const std::string& name, std::size_t tuples,
               int components, std::uint64_t bytes);
  void close_section();

  std::size_t points_, vertices_, lines_;
  std::string header_, section_;
  std::uint64_t offset_ = 0;
  std::vector<std::function<void(std::string&)>> arrays_;
};

}  // namespace equidem
