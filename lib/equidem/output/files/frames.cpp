// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/frames.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <numeric>
#include <sstream>
#include <system_error>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/json.hpp"
#include "equidem/output/files/placed_discs.hpp"
#include "equidem/output/files/xdmf.hpp"

namespace equidem {
namespace {

constexpr const char* schema = "equidem-frames/1";

constexpr const char* translation_of(bool travelling) {
  return travelling ? "position" : "displacement";
}
constexpr const char* rotation_of(bool travelling) {
  return travelling ? "angle" : "rotation";
}

/// Arrays of what moves; one entry per frame, as `time` and `step` have too.
constexpr std::array<const char*, 4> moving(bool travelling) {
  return {translation_of(travelling), rotation_of(travelling), "velocity", "spin"};
}

/// Arrays with one entry per frame.
constexpr std::array<const char*, 6> growing(bool travelling) {
  const auto [translation, rotation, velocity, spin] = moving(travelling);
  return {"time", "step", translation, rotation, velocity, spin};
}

constexpr std::size_t text_header = 512;  // bytes

/// Number of discs, room, offsets of the growing arrays; the last line is a checksum of the lines before.
std::string header_of(const Hdf5Layout& layout, std::size_t discs, bool travelling) {
  std::string text = fmt::format("{}\ndiscs {}\nroom {}\n", schema, discs, layout["time"].shape[0]);
  for (const char* name : growing(travelling)) text += fmt::format("{} {}\n", name, layout[name].offset);
  Checksum sum;
  sum.add(std::as_bytes(std::span(text)));
  text += fmt::format("fnv1a {}\n", sum.text());
  text.resize(text_header, '\0');
  return text;
}

/// Bytes of one frame, and where it begins.
std::uint64_t frame_bytes(const Hdf5Array& array) {
  return array.bytes() / array.shape[0];
}
std::uint64_t frame_offset(const Hdf5Array& array, std::size_t frame) {
  return array.offset + frame * frame_bytes(array);
}

template <typename Number>
void write_numbers(OpenFile& file, std::uint64_t offset, const std::vector<Number>& numbers) {
  file.write_at(offset, std::as_bytes(std::span(numbers)));
}

template <typename Number>
std::vector<Number> read_numbers(const OpenFile& file, const Hdf5Array& array, std::uint64_t count) {
  std::vector<Number> numbers(count);
  file.read_at(array.offset, std::as_writable_bytes(std::span(numbers)));
  return numbers;
}

std::vector<double> numbers_of(const std::vector<Vec2>& points) {
  std::vector<double> numbers;
  for (const Vec2 point : points) numbers.insert(numbers.end(), {point.x, point.y});
  return numbers;
}

/// For every disc or contact its numbers, in pieces, so that no second copy of a large array is held.
template <typename Number, typename Entries, typename Append>
void write_entries(OpenFile& file, std::uint64_t offset, const Entries& entries, Append append) {
  constexpr std::size_t piece = 1 << 14;
  std::vector<Number> numbers;
  for (std::size_t begin = 0; begin < entries.size(); begin += piece) {
    numbers.clear();
    const std::size_t end = std::min(begin + piece, entries.size());
    for (std::size_t k = begin; k < end; ++k) append(numbers, entries[k]);
    write_numbers(file, offset, numbers);
    offset += numbers.size() * sizeof(Number);
  }
}

/// Times and steps of frames that are not there.
void write_absent(OpenFile& file, const Hdf5Layout& layout, std::size_t from) {
  const std::size_t count = layout["time"].shape[0] - from;
  write_numbers(file, frame_offset(layout["time"], from),
                std::vector<double>(count, std::numeric_limits<double>::quiet_NaN()));
  write_numbers(file, frame_offset(layout["step"], from), std::vector<std::int64_t>(count, -1));
}

void write_count(OpenFile& file, const Hdf5Layout& layout, std::size_t frames) {
  write_numbers(file, layout["frames"].offset, std::vector<std::int64_t>{static_cast<std::int64_t>(frames)});
}

[[noreturn]] void cannot_add_frames(const std::filesystem::path& path, const std::string& why) {
  bad_input(fmt::format("cannot add frames to '{}'", path.string()), why,
            "Put back the file as this run wrote it, or start the run afresh");
}

}  // namespace

FrameWriter::FrameWriter(const std::filesystem::path& folder, const std::string& name, const Assembly& assembly,
                         const FrameOptions& options)
    : path_(folder / (name + ".h5")),
      index_path_(folder / (name + ".xdmf2")),
      assembly_(assembly),
      travelling_(options.travelling),
      of_discs_(options.of_discs),
      parts_(options.parts) {
  assert(options.expected >= 1);
  const bool replace = options.overwrite || options.continue_from;
  check_writable(path_, replace);
  check_writable(index_path_, replace);
  sum_.add(numbers_of(assembly_.centres));
  sum_.add(assembly_.radii);
  for (const DiscNumbers& added : of_discs_) sum_.add(added.values);
  marked_ = {path_.filename().string(), 0, sum_.value()};
  if (options.continue_from) {
    go_on(*options.continue_from, options.expected);
  } else {
    std::error_code ignored;
    std::filesystem::create_directories(folder, ignored);
    resize(options.expected);
  }
  write_index();
}

void FrameWriter::append(std::int64_t step, double time, std::span<const DiscMotion> motions,
                         std::span<const DiscMotion> velocities, bool regular) {
  assert(step > last_step());
  std::vector<DiscMotion> of_parts, rates_of_parts;
  if (!parts_.empty()) {
    for (const FramePart& part : parts_) {
      const DiscMotion &body = motions[part.body], &rate = velocities[part.body];
      const bool in_the_middle = part.offset == Vec2{};
      const Vec2 arm = in_the_middle ? Vec2{} : turned(part.offset, body.theta);
      of_parts.push_back({body.u + arm, body.theta});
      rates_of_parts.push_back({rate.u + rate.theta * perpendicular(arm), rate.theta});
    }
    motions = of_parts;
    velocities = rates_of_parts;
  }
  assert(motions.size() == assembly_.size() && velocities.size() == assembly_.size());
  const std::size_t frame = times_.size();
  if (frame == layout_["time"].shape[0]) resize(2 * frames());
  sum_.add(static_cast<std::uint64_t>(step));
  sum_.add(time);
  write_field(translation_of(travelling_), rotation_of(travelling_), motions);
  write_field("velocity", "spin", velocities);
  write_numbers(*file_, frame_offset(layout_["time"], frame), std::vector{time});
  write_numbers(*file_, frame_offset(layout_["step"], frame), std::vector{step});
  write_count(*file_, layout_, frame + 1);  // last: what is counted is there
  times_.push_back(time);
  steps_.push_back(step);
  if (regular) marked_ = {marked_.name, times_.size(), sum_.value()};
  list_frame(frame);
  if (times_.size() % (1 + times_.size() / 200) == 0) write_index();
}

void FrameWriter::finish() {
  const std::int64_t needed = std::max<std::int64_t>(frames(), 1);
  if (static_cast<std::uint64_t>(needed) < layout_["time"].shape[0]) resize(needed);
  write_index();
}

void FrameWriter::write_field(const std::string& translation, const std::string& rotation,
                              std::span<const DiscMotion> values) {
  const std::size_t frame = times_.size();
  write_entries<double>(*file_, frame_offset(layout_[translation], frame), values,
                        [this](std::vector<double>& numbers, const DiscMotion& motion) {
                          for (const double number : {motion.u.x, motion.u.y, 0.0}) {
                            numbers.push_back(number);
                            sum_.add(number);
                          }
                        });
  write_entries<double>(*file_, frame_offset(layout_[rotation], frame), values,
                        [this](std::vector<double>& numbers, const DiscMotion& motion) {
                          numbers.push_back(motion.theta);
                          sum_.add(motion.theta);
                        });
}

void FrameWriter::write_static(OpenFile& file, const Hdf5Layout& layout) const {
  write_numbers(file, layout["discs/centre"].offset, assembly_.centres);
  write_numbers(file, layout["discs/radius"].offset, assembly_.radii);
  std::vector<std::int32_t> numbers(assembly_.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  write_numbers(file, layout["discs/number"].offset, numbers);
  const auto write_contacts = [&](const std::string& name, auto number, auto pair_of) {
    using Number = decltype(number);
    write_entries<Number>(file, layout[name].offset, assembly_.contacts,
                          [&](std::vector<Number>& pairs, const Contact& contact) {
                            const auto [first, second] = pair_of(contact);
                            pairs.insert(pairs.end(), {first, second});
                          });
  };
  write_contacts("contacts/discs", std::int32_t{}, [](const Contact& c) { return std::pair(c.i, c.j); });
  write_contacts("contacts/shift", std::int32_t{}, [](const Contact& c) { return std::pair(c.shift_x, c.shift_y); });
  write_contacts("contacts/lever", double{}, [](const Contact& c) { return std::pair(c.lever_i, c.lever_j); });
  for (const DiscNumbers& added : of_discs_) {
    assert(added.values.size() == assembly_.size());
    write_numbers(file, layout["discs/" + added.name].offset, added.values);
  }
  if (assembly_.period) write_numbers(file, layout["period"].offset, std::vector{*assembly_.period});
}

Hdf5Layout FrameWriter::layout_of(std::int64_t room) const {
  using enum Hdf5Number;
  const std::uint64_t n = assembly_.size(), m = assembly_.contacts.size(), k = static_cast<std::uint64_t>(room);
  Hdf5Layout layout;
  layout.user_block = text_header;
  layout.attributes = {{"schema", schema}, {"library_version", library_version()}};
  layout.arrays = {{"discs/centre", float64, {n, 2}, "m"},
                   {"discs/radius", float64, {n}, "m"},
                   {"discs/number", int32, {n}},
                   {"contacts/discs", int32, {m, 2}},
                   {"contacts/shift", int32, {m, 2}},
                   {"contacts/lever", float64, {m, 2}, "m"},
                   {"frames", int64, {1}},
                   {"time", float64, {k}, "s"},
                   {"step", int64, {k}},
                   {translation_of(travelling_), float64, {k, n, 3}, "m"},
                   {rotation_of(travelling_), float64, {k, n}, "rad"},
                   {"velocity", float64, {k, n, 3}, "m/s"},
                   {"spin", float64, {k, n}, "rad/s"}};
  if (assembly_.period) layout.arrays.push_back({"period", float64, {2}, "m"});
  for (const DiscNumbers& numbers : of_discs_)
    layout.arrays.push_back({"discs/" + numbers.name, float64, {n}, numbers.unit});
  return layout;
}

/// A new file takes the place of the old one, if any, with the frames of that.
void FrameWriter::resize(std::int64_t room) {
  Replacement replacement(path_);
  const Hdf5Layout layout = write_hdf5_layout(replacement.path(), layout_of(room));
  OpenFile file(replacement.path(), OpenFile::Mode::update);
  const std::string header = header_of(layout, assembly_.size(), travelling_);
  file.write_at(0, std::as_bytes(std::span(header)));
  write_static(file, layout);
  std::vector<std::byte> bytes;
  for (const char* name : moving(travelling_)) {
    for (std::size_t frame = 0; frame < times_.size(); ++frame) {
      bytes.resize(frame_bytes(layout[name]));
      file_->read_at(frame_offset(layout_[name], frame), bytes);
      file.write_at(frame_offset(layout[name], frame), bytes);
    }
  }
  write_absent(file, layout, times_.size());
  write_numbers(file, layout["time"].offset, times_);
  write_numbers(file, layout["step"].offset, steps_);
  write_count(file, layout, times_.size());
  replacement.commit();
  layout_ = layout;
  file_ = std::move(file);
  index_.clear();
  for (std::size_t frame = 0; frame < times_.size(); ++frame) list_frame(frame);
}

/// The frames of the mark, copied into a new file.
void FrameWriter::go_on(const FileMark& mark, std::int64_t expected) {
  std::error_code ignored;
  if (!std::filesystem::exists(path_, ignored)) cannot_add_frames(path_, "there is no such file");
  file_.emplace(path_, OpenFile::Mode::read);
  std::string text(std::min<std::uint64_t>(text_header, file_->size()), '\0');
  file_->read_at(0, std::as_writable_bytes(std::span(text)));
  std::istringstream words(text);
  std::string word;
  std::uint64_t discs = 0;
  std::int64_t room = 0;
  words >> word >> word >> discs >> word >> room;
  if (words && discs != assembly_.size())
    cannot_add_frames(path_, fmt::format("it has {} discs, not {}", discs, assembly_.size()));
  layout_ = layout_of(room);
  for (const char* name : growing(travelling_)) {
    const auto array = std::ranges::find(layout_.arrays, name, &Hdf5Array::name);
    words >> word >> array->offset;
  }
  if (text != header_of(layout_, assembly_.size(), travelling_))
    cannot_add_frames(path_, "it holds no frames, or it was altered since it was written");
  if (static_cast<std::uint64_t>(room) < mark.length)
    cannot_add_frames(path_, fmt::format("it has room for {} of {} frames", room, mark.length));
  steps_ = read_numbers<std::int64_t>(*file_, layout_["step"], mark.length);
  times_ = read_numbers<double>(*file_, layout_["time"], mark.length);
  std::vector<double> numbers;
  for (std::size_t frame = 0; frame < mark.length; ++frame) {
    sum_.add(static_cast<std::uint64_t>(steps_[frame]));
    sum_.add(times_[frame]);
    for (const char* name : moving(travelling_)) {
      numbers.resize(frame_bytes(layout_[name]) / sizeof(double));
      file_->read_at(frame_offset(layout_[name], frame), std::as_writable_bytes(std::span(numbers)));
      sum_.add(numbers);
    }
  }
  if (sum_.value() != mark.checksum)
    cannot_add_frames(path_, "it was altered since it was written, or its discs are others");
  marked_ = mark;
  resize(std::max(expected, frames()));
}

void FrameWriter::list_frame(std::size_t frame) {
  XdmfSource source{path_.filename().string(), assembly_.size(), layout_["time"].shape[0], travelling_};
  for (const DiscNumbers& added : of_discs_) source.of_discs.push_back(added.name);
  index_ += xdmf_frame(source, frame, times_[frame]);
}

void FrameWriter::write_index() const {
  write_file(index_path_, xdmf_text(index_), true);
}

}  // namespace equidem
