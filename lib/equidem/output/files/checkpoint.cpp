// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/checkpoint.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "equidem/core/checksum.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/files/hdf5.hpp"
#include "equidem/core/files/open_file.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/results.hpp"

namespace equidem {
namespace {

constexpr std::string_view magic = "equidem-checkpoint/";
constexpr int format_version = 13;
constexpr std::size_t header_size = 512;

/// The 512 bytes before the HDF5 part; the last line is a checksum of the lines before and of all that follows.
struct Header {
  std::string library;
  std::uint64_t bytes = 0;  ///< of the whole file
  std::uint64_t checksum = 0;

  [[nodiscard]] std::string first_lines() const {
    return fmt::format("{}{}\nlibrary {}\nbytes {}\n", magic, format_version, library, bytes);
  }
  [[nodiscard]] std::string text() const {
    std::string text = first_lines() + fmt::format("fnv1a {:016x}\n", checksum);
    text.resize(header_size, '\0');
    return text;
  }
};

std::uint64_t checksum_of(const OpenFile& file, const Header& header) {
  Checksum sum;
  const std::string lines = header.first_lines();
  sum.add(std::as_bytes(std::span(lines)));
  std::vector<std::byte> piece(1 << 20);
  for (std::uint64_t at = header_size; at < header.bytes; at += piece.size()) {
    const auto part = std::span(piece).first(std::min<std::uint64_t>(piece.size(), header.bytes - at));
    file.read_at(at, part);
    sum.add(part);
  }
  return sum.value();
}

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& why,
                         const std::string& remedy = "Give another checkpoint, or start the run afresh") {
  bad_input(fmt::format("cannot go on from '{}'", path.string()), why, remedy);
}

/// The value behind "KEY " on the next line of the text.
std::string next_value(std::string_view& text, std::string_view key) {
  const std::size_t end = text.find('\n');
  if (end == std::string_view::npos || !text.starts_with(key)) return {};
  std::string value(text.substr(key.size(), end - key.size()));
  text.remove_prefix(end + 1);
  return value;
}

std::uint64_t number(const std::string& digits, int base) {
  std::uint64_t value = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), value, base);
  return value;
}

/// The file is a whole checkpoint of this version, byte for byte as it was written.
void check_whole(const std::filesystem::path& path, const OpenFile& file) {
  std::string text(std::min<std::uint64_t>(header_size, file.size()), '\0');
  file.read_at(0, std::as_writable_bytes(std::span(text)));
  if (!text.starts_with(magic)) refuse(path, "it is no checkpoint of equidem");
  std::string_view rest = text;
  const std::string version = next_value(rest, magic);
  if (version != fmt::format("{}", format_version)) {
    refuse(path, fmt::format("its format has version '{}', and this library reads version {}", version, format_version),
           "Go on with the library that wrote it");
  }
  Header header;
  header.library = next_value(rest, "library ");
  header.bytes = number(next_value(rest, "bytes "), 10);
  header.checksum = number(next_value(rest, "fnv1a "), 16);
  if (text.size() < header_size || file.size() < header.bytes) {
    refuse(path, fmt::format("it is truncated: {} bytes are left of {}", file.size(), header.bytes));
  }
  if (text != header.text() || file.size() != header.bytes || checksum_of(file, header) != header.checksum) {
    refuse(path, "it was altered since it was written: its checksum is wrong");
  }
  if (header.library != library_version()) {
    refuse(path,
           fmt::format("equidem {} wrote it, this is {}, and the bits of two versions may differ", header.library,
                       library_version()),
           "Go on with the version that wrote it");
  }
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

constexpr std::string_view first_of_record = "energies";

/// The record as arrays behind those of the state; names that no simulation uses.
std::vector<SavedArray> arrays_of(const RunRecord& record) {
  SavedArray energies{.name = std::string(first_of_record), .columns = 2 + energy_terms().size(), .values = {}};
  for (const EnergySample& sample : record.energies) {
    energies.values.insert(energies.values.end(), {static_cast<double>(sample.step), sample.time});
    for (const EnergyTerm& term : energy_terms()) energies.values.push_back(sample.ledger.*term.value);
  }
  SavedArray paths{
      .name = "paths", .columns = record.paths.empty() ? 1 : 2 * record.paths.front().size(), .values = {}};
  for (const std::vector<Vec2>& places : record.paths)
    for (const Vec2 place : places) paths.values.insert(paths.values.end(), {place.x, place.y});
  SavedArray film{
      .name = "film", .columns = record.film.empty() ? 1 : 2 + 3 * record.film.front().motions.size(), .values = {}};
  for (const FilmFrame& frame : record.film) {
    film.values.insert(film.values.end(), {static_cast<double>(frame.step), frame.time});
    const std::vector<double> numbers = numbers_of(frame.motions);
    film.values.insert(film.values.end(), numbers.begin(), numbers.end());
  }
  SavedArray film_walls{
      .name = "film_walls",
      .columns = record.film.empty() ? 1 : std::max<std::size_t>(1, 2 * record.film.front().walls.size()),
      .values = {}};
  for (const FilmFrame& frame : record.film)
    for (const Vec2 place : frame.walls) film_walls.values.insert(film_walls.values.end(), {place.x, place.y});
  std::vector<SavedArray> arrays{std::move(energies), std::move(paths), std::move(film), std::move(film_walls)};
  arrays.insert(arrays.end(), record.recorded.begin(), record.recorded.end());
  return arrays;
}

RunRecord record_of(std::span<const SavedArray> arrays) {
  const SavedArray &energies = arrays[0], &paths = arrays[1], &film = arrays[2], &film_walls = arrays[3];
  RunRecord record{.energies = {}, .paths = {}, .film = {}, .recorded = {arrays.begin() + 4, arrays.end()}};
  for (const double* next = energies.values.data(); next != energies.values.data() + energies.values.size();) {
    EnergySample& sample = record.energies.emplace_back();
    sample.step = static_cast<std::int64_t>(*next++);
    sample.time = *next++;
    for (const EnergyTerm& term : energy_terms()) sample.ledger.*term.value = *next++;
  }
  for (std::size_t at = 0; at < paths.values.size(); at += paths.columns) {
    std::vector<Vec2>& places = record.paths.emplace_back();
    for (std::size_t k = 0; k < paths.columns; k += 2)
      places.push_back({paths.values[at + k], paths.values[at + k + 1]});
  }
  for (std::size_t at = 0; at < film.values.size(); at += film.columns) {
    const auto row = std::span(film.values).subspan(at, film.columns);
    FilmFrame& frame =
        record.film.emplace_back(FilmFrame{static_cast<std::int64_t>(row[0]), row[1], motions_of(row.subspan(2))});
    if (film_walls.values.empty()) continue;
    const auto places =
        std::span(film_walls.values).subspan(at / film.columns * film_walls.columns, film_walls.columns);
    for (std::size_t k = 0; k < places.size(); k += 2) frame.walls.push_back({places[k], places[k + 1]});
  }
  return record;
}

std::string text_of(const std::vector<FileMark>& files) {
  std::string text;
  for (const FileMark& mark : files) text += fmt::format("{} {} {:016x} ", mark.name, mark.length, mark.checksum);
  return text;
}

std::vector<FileMark> marks_in(const std::string& text) {
  std::vector<FileMark> files;
  const std::vector<std::string_view> words = words_of(text);
  for (std::size_t k = 0; k + 2 < words.size(); k += 3) {
    FileMark mark{.name = std::string(words[k])};
    const std::string_view sum = words[k + 2];
    const auto length = number_from<std::uint64_t>(words[k + 1]);
    if (!length ||
        std::from_chars(sum.data(), sum.data() + sum.size(), mark.checksum, 16).ptr != sum.data() + sum.size())
      break;
    mark.length = *length;
    files.push_back(mark);
  }
  return files;
}

/// The names of the arrays stand in an attribute of the file.
Hdf5Layout layout_of(const std::vector<SavedArray>& arrays, const std::vector<FileMark>& files,
                     const std::string& case_text) {
  Hdf5Layout layout;
  layout.user_block = header_size;
  layout.arrays = {{"case", Hdf5Number::text, {case_text.size()}}, {"step", Hdf5Number::int64, {1}}};
  for (const SavedArray& array : arrays) {
    std::vector<std::uint64_t> shape{array.values.size() / array.columns};
    if (array.columns > 1) shape.push_back(array.columns);
    layout.arrays.push_back({array.name, Hdf5Number::float64, std::move(shape)});
  }
  layout.attributes["arrays"] = joined(arrays, &SavedArray::name, " ");
  layout.attributes["files"] = text_of(files);
  return layout;
}

template <typename Entry>
void put(OpenFile& file, const Hdf5Array& array, std::span<const Entry> entries) {
  file.write_at(array.offset, std::as_bytes(entries));
}

template <typename Entry>
void get(const OpenFile& file, const Hdf5Array& array, std::span<Entry> entries) {
  file.read_at(array.offset, std::as_writable_bytes(entries));
}

OpenFile open_whole(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) refuse(path, "there is no such file");
  if (!std::filesystem::is_regular_file(path, ignored)) refuse(path, "it is no file");
  OpenFile file(path, OpenFile::Mode::read);
  check_whole(path, file);
  return file;
}

Hdf5Layout find_arrays(const std::filesystem::path& path) {
  const std::string listed = read_hdf5_layout(path, {}).attributes["arrays"];
  std::vector<std::string> names{"case", "step"};
  for (const std::string_view name : words_of(listed)) names.emplace_back(name);
  return read_hdf5_layout(path, names);
}

std::string read_case(const OpenFile& file, const Hdf5Layout& layout) {
  std::string text(layout["case"].bytes(), '\0');
  get(file, layout["case"], std::span<char>(text));
  if (text.back() == '\0') text.pop_back();  // of an empty text HDF5 keeps one byte
  return text;
}

}  // namespace

/// Past a line that only one of the texts has they no longer stand side by side, and one is enough.
std::string first_differences(std::string_view there, std::string_view here) {
  const auto a = lines_of(there), b = lines_of(here);
  const auto show = [](const std::vector<std::string_view>& lines, std::size_t k) {
    return k < lines.size() ? fmt::format("'{}'", lines[k]) : std::string("nothing");
  };
  std::vector<std::string> shown;
  const std::size_t most = a.size() == b.size() ? 3 : 1;
  for (std::size_t k = 0; k < std::max(a.size(), b.size()) && shown.size() < most; ++k) {
    if (k < a.size() && k < b.size() && a[k] == b[k]) continue;
    shown.push_back(fmt::format("line {}: {} there, {} here", k + 1, show(a, k), show(b, k)));
  }
  return shown.empty() ? "the ends of their lines" : joined(shown, "; ");
}

CheckpointWriter::CheckpointWriter(std::filesystem::path path, std::string case_text, bool overwrite)
    : path_(std::move(path)), case_text_(std::move(case_text)) {
  check_writable(path_, overwrite);
}

const FileMark& Checkpoint::mark_of(const std::string& name) const {
  const auto found = std::ranges::find(files, name, &FileMark::name);
  if (found == files.end()) {
    bad_input(fmt::format("the run cannot go on with '{}'", name), "it was stopped without that file",
              "Record what the run recorded when it was stopped, or start it afresh");
  }
  return *found;
}

void CheckpointWriter::write(const Checkpoint& checkpoint) const {
  std::error_code ignored;
  if (path_.has_parent_path()) std::filesystem::create_directories(path_.parent_path(), ignored);
  std::vector<SavedArray> arrays = checkpoint.state.arrays;
  for (SavedArray& array : arrays_of(checkpoint.record)) arrays.push_back(std::move(array));
  Replacement replacement(path_);
  const Hdf5Layout layout = write_hdf5_layout(replacement.path(), layout_of(arrays, checkpoint.files, case_text_));
  OpenFile file(replacement.path(), OpenFile::Mode::update);
  put(file, layout["case"], std::span<const char>(case_text_));
  put(file, layout["step"], std::span(&checkpoint.state.step, 1));
  for (const SavedArray& array : arrays) put(file, layout[array.name], std::span<const double>(array.values));
  Header header{.library = library_version(), .bytes = file.size()};
  header.checksum = checksum_of(file, header);
  const std::string text = header.text();
  file.write_at(0, std::as_bytes(std::span(text)));
  file.sync();
  replacement.commit();
  sync_folder_of(path_);
}

Checkpoint read_checkpoint(const std::filesystem::path& path, const std::string& case_text) {
  const OpenFile file = open_whole(path);
  const Hdf5Layout layout = find_arrays(path);
  if (const std::string there = read_case(file, layout); there != case_text) {
    refuse(path, fmt::format("it belongs to another case: {}", first_differences(there, case_text)),
           "Go on with the case it was made by, or start the run afresh");
  }
  Checkpoint result;
  get(file, layout["step"], std::span(&result.state.step, 1));
  std::vector<SavedArray> arrays;
  for (const Hdf5Array& found : layout.arrays) {
    if (found.name == "case" || found.name == "step") continue;
    arrays.push_back({found.name, found.shape.size() > 1 ? found.shape[1] : 1, std::vector<double>(found.size())});
    get(file, found, std::span(arrays.back().values));
  }
  const auto record = std::ranges::find(arrays, first_of_record, &SavedArray::name);
  result.record = record_of({record, arrays.end()});
  arrays.erase(record, arrays.end());
  result.state.arrays = std::move(arrays);
  result.files = marks_in(layout.attributes.at("files"));
  return result;
}

std::string case_of_checkpoint(const std::filesystem::path& path) {
  const OpenFile file = open_whole(path);
  return read_case(file, find_arrays(path));
}

}  // namespace equidem
