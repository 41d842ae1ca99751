// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/files/hdf5_files.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/files/file_keys.hpp"
#include "equidem/assembly/touching.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/files/hdf5.hpp"
#include "equidem/core/files/open_file.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

using namespace hdf5_columns;
namespace fs = std::filesystem;

class Reading {
 public:
  Reading(const fs::path& path, double gap_tolerance) : file_(path), gap_tolerance_(gap_tolerance) {}

  Assembly assembly() {
    check_keys();
    assembly_.kind = "file";
    read_discs();
    read_contacts();
    read_groups();
    check(assembly_);
    measure_missing_cells(assembly_);
    return std::move(assembly_);
  }

 private:
  [[nodiscard]] bool has(const char* name) const { return file_.find(name).has_value(); }

  void check_keys() {
    const auto given = file_.attributes().find("schema");
    check_schema(given == file_.attributes().end() ? "" : given->second,
                 fmt::format("the text attribute schema = \"{}\"", assembly_schema));
    std::vector<std::string> known = {"groups"};
    for (const Column& column : all_columns) known.emplace_back(column.name);
    for (const ContactNumbers& numbers : contact_numbers) known.emplace_back(numbers.key);
    for (const std::string& name : file_.names("/")) {
      check_key(name, known);
      if (name == "groups" ? file_.is_group(name) : file_.find(name).has_value()) continue;
      bad_input_at(name, name == "groups" ? "it is no group" : "it is no dataset", "an assembly file is read strictly",
                   "Write it anew");
    }
    if (!has("discs")) {
      bad_input_at("discs", "the dataset 'discs' is missing", "an assembly is made of discs",
                   "Add it: one row [x, y, radius] for each disc");
    }
    check_keys_together([&](const char* key) { return has(key); }, gap_tolerance_);
  }

  /// The number of rows of a dataset of the right shape and kind.
  std::size_t rows_of(const std::string& name, std::size_t width, Hdf5File::Kind kind) const {
    const Hdf5File::Dataset found = *file_.find(name);
    const bool whole = kind == Hdf5File::Kind::whole;
    if (found.kind == Hdf5File::Kind::other || (whole && found.kind != Hdf5File::Kind::whole)) {
      bad_input_at(name, fmt::format("the dataset holds no {}numbers", whole ? "whole " : ""), "",
                   fmt::format("Write it as {}", whole ? "int32 or int64" : "float64"));
    }
    const std::size_t rank = width == 0 ? 1 : 2;
    if (found.shape.size() != rank || (rank == 2 && found.shape[1] != width)) {
      bad_input_at(name,
                   fmt::format("the dataset has the shape ({})",
                               joined(found.shape, [](std::uint64_t extent) { return fmt::format("{}", extent); })),
                   width == 0 ? "it is a list" : fmt::format("it has {} columns", width), "Write it in that shape");
    }
    constexpr std::uint64_t most = std::numeric_limits<std::int32_t>::max();
    if (found.shape[0] > most) {
      bad_input_at(name, fmt::format("the dataset has {} rows", found.shape[0]),
                   fmt::format("at most {} can be numbered", most), "Split the assembly");
    }
    return found.shape[0];
  }

  void check_rows(const std::string& name, std::size_t rows, const char* what, std::size_t expected) const {
    if (rows == expected) return;
    bad_input_at(name, fmt::format("{} for {}", counted(rows, "row"), counted(expected, what)),
                 "there must be one for each", "Correct the dataset or remove it");
  }

  /// take(k, numbers of the row) for every row. \tparam Number double or std::int64_t
  template <typename Number, typename Take>
  void for_each_row(const std::string& name, std::size_t rows, std::size_t width, const Take& take) const {
    const std::size_t columns = std::max<std::size_t>(width, 1);
    std::vector<Number> numbers;
    for (std::size_t first = 0; first < rows; first += rows_at_once) {
      stop_if_interrupted();
      const std::size_t count = std::min(rows - first, rows_at_once);
      numbers.resize(count * columns);
      file_.read_rows(name, first, std::span(numbers));
      for (std::size_t k = 0; k < count; ++k) {
        const std::span<const Number> row = std::span(numbers).subspan(k * columns, columns);
        for (const Number number : row) check_number(number, name, first + k);
        take(first + k, row);
      }
    }
  }

  static void check_number(double number, const std::string& name, std::size_t row) {
    if (!std::isfinite(number))
      bad_input_at(fmt::format("{}[{}]", name, row), "the number is not finite", "", "Correct the entry");
  }

  static void check_number(std::int64_t number, const std::string& name, std::size_t row) {
    constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();
    if (number >= -most && number <= most) return;
    bad_input_at(fmt::format("{}[{}]", name, row), fmt::format("{} is out of range", number),
                 fmt::format("discs and shifts are whole numbers of a magnitude up to {}", most), "Correct the entry");
  }

  /// Rows of numbers of a dataset, one for each of `expected`; nothing where the file has no such dataset.
  template <typename Take>
  void read(const Column& column, const char* what, std::size_t expected, const Take& take) const {
    if (!has(column.name)) return;
    const std::size_t rows = rows_of(column.name, column.width, Hdf5File::Kind::real);
    check_rows(column.name, rows, what, expected);
    for_each_row<double>(column.name, rows, column.width, take);
  }

  void read_discs() {
    std::vector<double> corners;
    read(cell, "direction", 2, [&](std::size_t, auto row) { corners.push_back(row[0]); });
    if (!corners.empty()) assembly_.period = Vec2{corners[0], corners[1]};
    corners.clear();
    // A third row is the direction of the lower side.
    const bool turned = has(box.name) && rows_of(box.name, box.width, Hdf5File::Kind::real) == 3;
    read(box, "corner", turned ? 3 : 2,
         [&](std::size_t, auto row) { corners.insert(corners.end(), row.begin(), row.end()); });
    if (!corners.empty())
      assembly_.box = TurnedRectangle({{corners[0], corners[1]}, {corners[2], corners[3]}},
                                      turned ? Vec2{corners[4], corners[5]} : Vec2{1, 0});
    const std::size_t count = rows_of(discs.name, discs.width, Hdf5File::Kind::real);
    require_memory(bytes_of_network(static_cast<double>(count)),
                   fmt::format("an assembly of {} discs needs about", grouped(static_cast<std::int64_t>(count))));
    assembly_.centres.resize(count);
    assembly_.radii.resize(count);
    read(discs, "disc", count, [&](std::size_t k, auto row) {
      assembly_.centres[k] = {row[0], row[1]};
      assembly_.radii[k] = row[2];
    });
    read(sections, "disc", count, [&](std::size_t, auto row) { assembly_.sections.push_back({row[0], row[1]}); });
    read(cell_areas, "disc", count, [&](std::size_t, auto row) { assembly_.cell_areas.push_back(row[0]); });
  }

  void read_contacts() {
    if (!has(contacts.name)) {
      check(assembly_);
      assembly_.contacts = touching_discs(assembly_, gap_tolerance_);
      assembly_.gap_tolerance = gap_tolerance_;
      return;
    }
    const std::size_t count = rows_of(contacts.name, contacts.width, Hdf5File::Kind::whole);
    require_memory(static_cast<double>(count * (sizeof(Contact) + sizeof(double))),
                   fmt::format("{} need about", counted(count, "contact")));
    assembly_.contacts.resize(count);
    const auto size = static_cast<std::int64_t>(assembly_.size());
    bool exist = true;  // the discs, which are needed before the midpoints of branches
    for_each_row<std::int64_t>(contacts.name, count, contacts.width, [&](std::size_t k, auto row) {
      const auto narrow = [&](std::size_t column) { return static_cast<std::int32_t>(row[column]); };
      assembly_.contacts[k] = {.i = narrow(0), .j = narrow(1), .shift_x = narrow(2), .shift_y = narrow(3)};
      exist = exist && std::min(row[0], row[1]) >= 0 && std::max(row[0], row[1]) < size;
    });
    if (!exist) check(assembly_);
    read_places_and_springs(count);
    refuse_repeated_contacts(assembly_);
  }

  void read_places_and_springs(std::size_t count) {
    if (!has(levers.name)) {
      for (Contact& c : assembly_.contacts) c.lever_i = c.lever_j = 0.5 * norm(assembly_.branch(c));
    }
    if (has(normals.name)) assembly_.contact_arms.resize(count);
    read(levers, "contact", count, [&](std::size_t k, auto row) {
      assembly_.contacts[k].lever_i = row[0];
      assembly_.contacts[k].lever_j = row[1];
    });
    read(normals, "contact", count, [&](std::size_t k, auto row) {
      assembly_.contact_arms[k].normal = {row[0], row[1]};
    });
    read(offsets, "contact", count, [&](std::size_t k, auto row) {
      assembly_.contact_arms[k].offset_i = row[0];
      assembly_.contact_arms[k].offset_j = row[1];
    });
    for (const ContactNumbers& numbers : contact_numbers) {
      read(column_of(numbers), "contact", count,
           [&](std::size_t, auto row) { numbers.add(row[0], row[1], assembly_); });
    }
    read(facet_lengths, "contact", count, [&](std::size_t, auto row) { assembly_.facet_lengths.push_back(row[0]); });
  }

  void read_groups() {
    if (!file_.is_group("groups")) return;
    for (const std::string& name : file_.names("groups")) {
      const std::string place = "groups/" + name, list = place + "/discs", lengths = place + "/tributary_lengths";
      if (!file_.is_group(place) || !file_.find(list)) {
        bad_input_at(place, "it is no group with a dataset 'discs'", "a group names its discs",
                     "Add the list of discs, or remove it");
      }
      for (const std::string& key : file_.names(place)) {
        if (key == "discs" || (key == "tributary_lengths" && file_.find(lengths))) continue;
        bad_input_at(place, fmt::format("there is no key '{}' in a group", key),
                     "its keys are 'discs' and 'tributary_lengths'", "Correct or remove it");
      }
      DiscGroup& group = assembly_.groups[name];
      const std::size_t count = rows_of(list, 0, Hdf5File::Kind::whole);
      if (count > assembly_.size()) {
        bad_input_at(list, fmt::format("{} for {}", counted(count, "row"), counted(assembly_.size(), "disc")),
                     "a group names each disc once", "Correct the dataset");
      }
      for_each_row<std::int64_t>(
          list, count, 0, [&](std::size_t, auto row) { group.discs.push_back(static_cast<std::int32_t>(row[0])); });
      if (file_.find(lengths)) {
        check_rows(lengths, rows_of(lengths, 0, Hdf5File::Kind::real), "disc", count);
        for_each_row<double>(lengths, count, 0,
                             [&](std::size_t, auto row) { group.tributary_lengths.push_back(row[0]); });
      }
    }
  }

  Hdf5File file_;
  double gap_tolerance_;
  Assembly assembly_;
};

}  // namespace

bool is_hdf5_name(const fs::path& path) {
  const std::string extension = path.extension().string();
  return extension == ".h5" || extension == ".hdf5";
}

Assembly read_hdf5_assembly(const fs::path& path, double gap_tolerance) {
  return Reading(path, gap_tolerance).assembly();
}

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
