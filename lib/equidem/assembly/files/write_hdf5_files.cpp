// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

#include "equidem/assembly/files/file_keys.hpp"
#include "equidem/assembly/files/hdf5_columns.hpp"
#include "equidem/assembly/files/hdf5_files.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/files/hdf5.hpp"
#include "equidem/core/files/open_file.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

using namespace hdf5_columns;
namespace fs = std::filesystem;

/// Levers half the distance long, as a file without levers has them.
bool levers_are_halves(const Assembly& assembly) {
  return assembly.contact_arms.empty() && std::ranges::all_of(assembly.contacts, [&](const Contact& c) {
           const double half = 0.5 * norm(assembly.branch(c));
           return c.lever_i == half && c.lever_j == half;
         });
}

/// The datasets of an assembly, and what fills them.
class Writing {
 public:
  explicit Writing(const Assembly& assembly) : assembly_(assembly) {
    layout_.attributes = {{"schema", assembly_schema}, {"title", assembly.kind}};
    add_discs();
    add_contacts();
    for (const auto& [name, group] : assembly.groups) add_group(name, group);
  }

  void write(const fs::path& path) {
    const Hdf5Layout placed = write_hdf5_layout(path, layout_);
    OpenFile file(path, OpenFile::Mode::update);
    for (std::size_t k = 0; k < fills_.size(); ++k) fills_[k](file, placed.arrays[k].offset);
  }

 private:
  /// row(k, numbers) sets the numbers of the row k. \tparam Number double or std::int32_t
  template <typename Number, typename Row>
  void add(const Column& column, std::size_t rows, const Row& row, const std::string& folder = {}) {
    Hdf5Array array{.name = folder + column.name,
                    .number = std::is_same_v<Number, double> ? Hdf5Number::float64 : Hdf5Number::int32,
                    .shape = {rows}};
    if (column.width > 0) array.shape.push_back(column.width);
    if (*column.unit != '\0') array.attributes = {{"unit", column.unit}};
    layout_.arrays.push_back(std::move(array));
    fills_.emplace_back([=](OpenFile& file, std::uint64_t offset) {
      const std::size_t width = std::max<std::size_t>(column.width, 1);
      std::vector<Number> numbers;
      for (std::size_t first = 0; first < rows; first += rows_at_once) {
        stop_if_interrupted();
        const std::size_t count = std::min(rows - first, rows_at_once);
        numbers.resize(count * width);
        for (std::size_t k = 0; k < count; ++k) row(first + k, numbers.data() + k * width);
        file.write_at(offset + first * width * sizeof(Number), std::as_bytes(std::span(numbers)));
      }
    });
  }

  static void set(double* numbers, double first, double second) {
    numbers[0] = first;
    numbers[1] = second;
  }

  void add_discs() {
    const Assembly& a = assembly_;
    if (a.period) add<double>(cell, 2, [&a](std::size_t k, double* to) { *to = k == 0 ? a.period->x : a.period->y; });
    if (a.box) {
      add<double>(box, a.box->upright() ? 2 : 3, [&a](std::size_t k, double* to) {
        const Vec2 corner = k == 0 ? a.box->low : k == 1 ? a.box->high : a.box->along;
        set(to, corner.x, corner.y);
      });
    }
    add<double>(discs, a.size(), [&a](std::size_t k, double* to) {
      set(to, a.centres[k].x, a.centres[k].y);
      to[2] = a.radii[k];
    });
    if (!a.sections.empty()) {
      add<double>(sections, a.size(),
                  [&a](std::size_t k, double* to) { set(to, a.sections[k].area, a.sections[k].polar_moment); });
    }
    if (!a.cell_areas.empty())
      add<double>(cell_areas, a.size(), [&a](std::size_t k, double* to) { *to = a.cell_areas[k]; });
  }

  void add_contacts() {
    const Assembly& a = assembly_;
    const std::size_t count = a.contacts.size();
    add<std::int32_t>(contacts, count, [&a](std::size_t k, std::int32_t* to) {
      const Contact& c = a.contacts[k];
      to[0] = c.i;
      to[1] = c.j;
      to[2] = c.shift_x;
      to[3] = c.shift_y;
    });
    if (!levers_are_halves(a)) {
      add<double>(levers, count,
                  [&a](std::size_t k, double* to) { set(to, a.contacts[k].lever_i, a.contacts[k].lever_j); });
    }
    if (!a.contact_arms.empty()) {
      add<double>(normals, count,
                  [&a](std::size_t k, double* to) { set(to, a.contact_arms[k].normal.x, a.contact_arms[k].normal.y); });
      add<double>(offsets, count,
                  [&a](std::size_t k, double* to) { set(to, a.contact_arms[k].offset_i, a.contact_arms[k].offset_j); });
    }
    for (const ContactNumbers& numbers : contact_numbers) {
      if (!numbers.given(a)) continue;
      add<double>(column_of(numbers), count, [&a, &numbers](std::size_t k, double* to) {
        set(to, (a.*numbers.first)[k], (a.*numbers.second)[k]);
      });
    }
    if (!a.facet_lengths.empty() || (count == 0 && !a.cell_areas.empty()))
      add<double>(facet_lengths, count, [&a](std::size_t k, double* to) { *to = a.facet_lengths[k]; });
  }

  void add_group(const std::string& name, const DiscGroup& group) {
    if (name.empty() || name == "." || name.find('/') != std::string::npos || name.find('\0') != std::string::npos) {
      bad_input(fmt::format("the group '{}' cannot be written to an HDF5 file", name),
                "such a name is a path there, or none", "Rename the group, or write the assembly as JSON");
    }
    const std::string folder = fmt::format("groups/{}/", name);
    add<std::int32_t>(
        {"discs", 0, ""}, group.discs.size(), [&group](std::size_t k, std::int32_t* to) { *to = group.discs[k]; },
        folder);
    if (group.tributary_lengths.empty()) return;
    add<double>(
        {"tributary_lengths", 0, "m"}, group.tributary_lengths.size(),
        [&group](std::size_t k, double* to) { *to = group.tributary_lengths[k]; }, folder);
  }

  const Assembly& assembly_;
  Hdf5Layout layout_;
  std::vector<std::function<void(OpenFile&, std::uint64_t)>> fills_;
};

/// The file that a link leads to, else the path itself; folders are made.
fs::path place_of(const fs::path& path) {
  std::error_code failed;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), failed);
  if (fs::exists(path, failed) && !fs::is_regular_file(path, failed)) {
    bad_input(fmt::format("cannot write '{}'", path.string()), "it is no regular file, as an HDF5 file is",
              "Choose another place");
  }
  return fs::is_symlink(path, failed) ? fs::weakly_canonical(path, failed) : path;
}

}  // namespace

void write_hdf5_assembly(const fs::path& path, const Assembly& assembly) {
  Writing writing(assembly);
  try {
    Replacement replacement(place_of(path));
    writing.write(replacement.path());
    replacement.commit();
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    throw Error(error.kind(), fmt::format("cannot write '{}'", path.string()), error.why(),
                "Make room on its disk, or choose a place that can be written to");
  }
}

}  // namespace equidem
