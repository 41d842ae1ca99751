// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Files that ParaView and VTK's own readers open.
/// VTK XML PolyData (.vtp): points, vertices and lines with arrays, as appended raw binary.
/// Text inside XML.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "equidem/core/file.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/motion/any_simulation.hpp"
#include "equidem/output/files/body_tables.hpp"

namespace equidem {

/// Bodies as the ends of contacts.
struct BodyPlaces {
  std::span<const Vec2> places;               ///< centres, m
  std::span<const DiscMotion> motions = {};   ///< displacement of each from its place; empty: not written
  std::span<const std::size_t> numbers = {};  ///< of each, ascending, by which contacts name it; empty: its place here
};

/// Forces and moments of contacts, as far as they are known.
struct ContactLoads {
  bool forces = false, moments = false;
  /// normal_force and tangential_force are those on j, compression positive, as files of colliding bodies have them.
  bool on_j = false;
};

/// The PolyData of contacts: a line each from the centre of i to that of j, also where that leads through the period,
/// or to the contact point at a wall. Arrays of lines: i, j (negative: wall -1 - j), contact_point (m), and as `loads`
/// say force (3-vector, on i), normal_force, tangential_force, bending_moment (BodyContact); of points:
/// displacement, and a radius of zero, so that Glyph draws circles of discs only.
/// \param contact_of the k-th of `count` contacts, asked for by each array
/// \param time see PolyData::write
void write_contacts(const TextSink& to, const BodyPlaces& bodies, std::size_t count,
                    const std::function<BodyContact(std::size_t k)>& contact_of, ContactLoads loads,
                    const double* time = nullptr);

/// Write NAME.vtm, the index to open, and beside it NAME_discs.vtp and NAME_contacts.vtp (VTK XML PolyData, appended
/// raw binary, Float64). SI units; arrays of what the state does not contain are left out.
///   discs     one vertex each at its centre: radius, cell_area, displacement (3-vector), rotation, stress_xx,
///             stress_yy, stress_xy, stress_yx, mean_stress. In ParaView: Glyph with the 2D glyph "circle" scaled by
///             radius, or Point Gaussian.
///   contacts  as write_contacts: "Warp By Vector" bends both files alike.
/// \return the three paths, the index first
/// \throws Error (bad_input) as write_file does, before anything is written where one of the three exists
std::vector<std::filesystem::path> write_vtk(const std::filesystem::path& folder, const std::string& name,
                                             const AssemblyState& state, bool overwrite);

/// Write one piece of an assembly that several processes hold: NAME_discs_K.vtp and NAME_contacts_K.vtp as write_vtk.
/// Discs have the array `number`, that in the whole assembly; `i` and `j` of contacts count the points of the piece.
/// \param numbers of the discs that are written, the first ones of the state; contacts may reach the others
void write_vtk_piece(const std::filesystem::path& folder, const std::string& name, int piece,
                     const AssemblyState& state, std::span<const std::int64_t> numbers, bool overwrite);
/// The names of these two files.
std::vector<std::string> vtk_piece_names(const std::string& name, int piece);
/// Write NAME.vtm, the index of all pieces: a block of discs and one of contacts.
void write_vtk_index(const std::filesystem::path& folder, const std::string& name, int pieces, bool overwrite);

/// "LittleEndian" or "BigEndian": the byte order of this machine.
const char* vtk_byte_order();

/// The x, y or z = 0 of a vector.
constexpr double component_of(Vec2 v, int component) {
  return component == 0 ? v.x : component == 1 ? v.y : 0.0;
}

/// One piece of PolyData. Arrays are declared first and generated in write(), so that none of them is held.
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
    arrays_.push_back([=](std::string& text, const TextSink& to) {
      append_bytes(text, bytes);
      for (std::size_t tuple = 0; tuple < tuples; ++tuple) {
        for (int component = 0; component < components; ++component) {
          append_bytes(text, static_cast<Number>(value(tuple, component)));
        }
        pass_block(text, to);
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
  void write(const TextSink& to, const double* time = nullptr);

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
  std::vector<std::function<void(std::string& text, const TextSink& to)>> arrays_;
};

/// The text with & < > " written as entities, for content and for values in double quotes.
std::string escape_xml(const std::string& text);

}  // namespace equidem
