// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/frames.hpp"

#include <algorithm>
#include <cassert>
#include <string_view>
#include <system_error>

#include "equidem/core/error.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/motion/any_simulation.hpp"
#include "equidem/output/files/body_tables.hpp"
#include "equidem/output/files/vtk.hpp"

namespace equidem {
namespace {

constexpr const char* list_head =
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n  <Collection>\n";
constexpr const char* list_tail = "  </Collection>\n</VTKFile>\n";
constexpr std::string_view time_key = "timestep=\"", discs_stem = "discs_", contacts_stem = "contacts_",
                           vtp_extension = ".vtp";

std::vector<double> coordinates_of(const std::vector<Vec2>& points) {
  std::vector<double> numbers;
  for (const Vec2 point : points) numbers.insert(numbers.end(), {point.x, point.y});
  return numbers;
}

/// Finds the text between two others; empty where they are absent.
std::string_view between(std::string_view text, std::string_view begin, std::string_view end) {
  const std::size_t at = text.find(begin);
  if (at == std::string_view::npos) return {};
  text.remove_prefix(at + begin.size());
  return text.substr(0, text.find(end));
}

/// The discs of bodies that are there.
struct MovingDiscs {
  std::vector<std::size_t> discs;  ///< their numbers in the assembly
  std::vector<DiscMotion> motions, velocities;
};
MovingDiscs discs_there(std::size_t count, std::span<const FramePart> parts, std::span<const DiscMotion> motions,
                        std::span<const DiscMotion> velocities) {
  MovingDiscs shown;
  for (std::size_t disc = 0; disc < count; ++disc) {
    const FramePart part = parts.empty() ? FramePart{.body = disc, .offset = {}} : parts[disc];
    const DiscMotion &body = motions[part.body], &rate = velocities[part.body];
    if (!is_there(body)) continue;
    const bool in_the_middle = part.offset == Vec2{};
    const Vec2 arm = in_the_middle ? Vec2{} : turned(part.offset, body.theta);
    shown.discs.push_back(disc);
    shown.motions.push_back({body.u + arm, body.theta});
    shown.velocities.push_back({rate.u + rate.theta * perpendicular(arm), rate.theta});
  }
  return shown;
}

void write_frame_discs(const TextSink& to, const Assembly& assembly, const FrameOptions& options, double time,
                       const MovingDiscs& shown) {
  const std::vector<std::size_t>& discs = shown.discs;
  PolyData data(discs.size(), discs.size(), 0);
  data.point_numbers("radius", [&](std::size_t k) { return assembly.radii[discs[k]]; });
  for (const DiscNumbers& added : options.of_discs) {
    assert(added.values.size() == assembly.size());
    data.point_numbers(added.name, [&](std::size_t k) { return added.values[discs[k]]; });
  }
  if (!options.travelling) data.point_vectors("displacement", [&](std::size_t k) { return shown.motions[k].u; });
  data.point_numbers(options.travelling ? "angle" : "rotation", [&](std::size_t k) { return shown.motions[k].theta; });
  data.point_vectors("velocity", [&](std::size_t k) { return shown.velocities[k].u; });
  data.point_numbers("spin", [&](std::size_t k) { return shown.velocities[k].theta; });
  data.places([&](std::size_t k) { return options.travelling ? shown.motions[k].u : assembly.centres[discs[k]]; });
  data.write(to, &time);
}

/// The contacts of the bodies, which are the discs where none has parts.
void write_frame_contacts(const TextSink& to, const Assembly& assembly, const FrameOptions& options, double time,
                          std::span<const DiscMotion> motions, std::span<const BodyContact> contacts) {
  const ContactLoads loads{.forces = true, .moments = options.moments, .on_j = options.travelling};
  const auto contact_of = [&](std::size_t c) { return contacts[c]; };
  if (!options.travelling)
    return write_contacts(to, {.places = assembly.centres, .motions = motions}, contacts.size(), contact_of, loads,
                          &time);
  std::vector<Vec2> places;
  std::vector<std::size_t> numbers;
  for (std::size_t body = 0; body < motions.size(); ++body) {
    if (!is_there(motions[body])) continue;
    places.push_back(motions[body].u);
    numbers.push_back(body);
  }
  if (places.size() == motions.size()) numbers.clear();
  write_contacts(to, {.places = places, .numbers = numbers}, contacts.size(), contact_of, loads, &time);
}

[[noreturn]] void cannot_add_frames(const std::filesystem::path& path, const std::string& why) {
  bad_input(fmt::format("cannot add frames to '{}'", path.string()), why,
            "Put back the files as this run wrote them, or start the run afresh");
}

}  // namespace

double bytes_of_frame(double discs, double contacts, const FrameOptions& options) {
  const double moving = options.travelling ? 0 : 24;  // the displacement
  const double of_disc = 80 + moving + 8.0 * static_cast<double>(options.of_discs.size());
  return discs * of_disc + (options.contacts ? discs * (32 + moving) + (options.moments ? 92 : 84) * contacts : 0);
}

FrameWriter::FrameWriter(const std::filesystem::path& folder, const std::string& name, const Assembly& assembly,
                         const FrameOptions& options)
    : folder_(folder), name_(name), assembly_(assembly), options_(options) {
  const bool replace = options_.overwrite || options_.continue_from;
  check_writable(folder_ / (name_ + ".pvd"), replace);
  sum_.add(coordinates_of(assembly_.centres));
  sum_.add(assembly_.radii);
  for (const DiscNumbers& added : options_.of_discs) sum_.add(added.values);
  marked_ = {name_ + ".pvd", 0, sum_.value()};
  if (options_.continue_from) go_on(*options_.continue_from);
  const std::vector<std::filesystem::path> others = other_files();
  for (const auto& path : others) check_writable(path, replace);
  check_writable(folder_ / file_name(discs_stem, 0), true);
  std::error_code failed;
  std::filesystem::create_directories(folder_ / name_, failed);
  for (const auto& path : others) std::filesystem::remove(path, failed);
  write_index();
}

void FrameWriter::append(std::int64_t step, double time, std::span<const DiscMotion> motions,
                         std::span<const DiscMotion> velocities, std::span<const BodyContact> contacts, bool regular) {
  assert(step > last_step());
  const MovingDiscs shown = discs_there(assembly_.size(), options_.parts, motions, velocities);
  write(file_name(discs_stem, step),
        [&](const TextSink& to) { write_frame_discs(to, assembly_, options_, time, shown); });
  if (options_.contacts)
    write(file_name(contacts_stem, step),
          [&](const TextSink& to) { write_frame_contacts(to, assembly_, options_, time, motions, contacts); });
  list_frame(step, fmt::format("{}", time));
  if (regular) marked_ = {marked_.name, steps_.size(), sum_.value()};
  if (steps_.size() % (1 + steps_.size() / 200) == 0) write_index();
}

void FrameWriter::sync() {
  write_index();
  unsynced_.push_back(folder_ / (name_ + ".pvd"));
  sync_files(unsynced_);
  unsynced_.clear();
}

std::string FrameWriter::file_name(std::string_view what, std::int64_t step) const {
  return fmt::format("{}/{}{:09}{}", name_, what, step, vtp_extension);
}

std::vector<std::string> FrameWriter::file_names(std::int64_t step) const {
  std::vector<std::string> names{file_name(discs_stem, step)};
  if (options_.contacts) names.push_back(file_name(contacts_stem, step));
  return names;
}

/// Files of frames in the folder NAME that are not those of steps_, and unfinished ones.
std::vector<std::filesystem::path> FrameWriter::other_files() const {
  std::vector<std::filesystem::path> others;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / name_, ignored)) {
    const std::string file = entry.path().filename().string();
    const bool whole = file.ends_with(vtp_extension);
    if (!whole && !file.ends_with(".part")) continue;
    for (const std::string_view stem : {discs_stem, contacts_stem}) {
      const auto step = number_from<std::int64_t>(file.starts_with(stem) ? between(file, stem, vtp_extension) : "");
      const bool listed = step && std::ranges::binary_search(steps_, *step);
      if (step && !(whole && listed && (stem == discs_stem || options_.contacts))) others.push_back(entry.path());
    }
  }
  return others;
}

/// Take over the frames of the mark.
void FrameWriter::go_on(const FileMark& mark) {
  const std::filesystem::path path = folder_ / (name_ + ".pvd");
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) cannot_add_frames(path, "there is no such file");
  const std::string text = read_file(path);
  std::string_view rest = text;
  if (!rest.starts_with(list_head)) cannot_add_frames(path, "it lists no frames");
  rest.remove_prefix(std::string_view(list_head).size());
  while (steps_.size() < mark.length) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    const std::string_view time = between(line, time_key, "\"");
    const std::string file = std::string(between(line, "file=\"", "\""));
    const auto step = number_from<std::int64_t>(between(file, fmt::format("/{}", discs_stem), vtp_extension));
    if (!step || *step <= last_step())
      cannot_add_frames(path, fmt::format("it lists {} of {} frames", steps_.size(), mark.length));
    for (const std::string& name : file_names(*step)) {
      if (!std::filesystem::exists(folder_ / name, ignored)) cannot_add_frames(folder_ / name, "there is no such file");
      const std::string content = read_file(folder_ / name);
      sum_.add(std::as_bytes(std::span(content)));
    }
    const std::size_t before = index_.size();
    list_frame(*step, std::string(time));
    if (!rest.starts_with(std::string_view(index_).substr(before)))
      cannot_add_frames(path, "it was altered since it was written");
    rest.remove_prefix(index_.size() - before);
  }
  if (sum_.value() != mark.checksum)
    cannot_add_frames(path,
                      "its files were altered since they were written, or the discs or frame_contacts are others");
  marked_ = mark;
}

void FrameWriter::write(const std::string& name, const std::function<void(const TextSink&)>& make) {
  Checksum sum = sum_;
  const auto write_and_sum = [&](const TextSink& to) {
    make([&](std::string_view part) {
      to(part);
      sum.add(std::as_bytes(std::span(part)));
    });
  };
  write_file(folder_ / name, write_and_sum, true);
  sum_ = sum;
  unsynced_.push_back(folder_ / name);
}

void FrameWriter::list_frame(std::int64_t step, const std::string& time) {
  const std::size_t before = index_.size();
  int part = 0;
  for (const std::string& file : file_names(step)) {
    index_ += fmt::format("    <DataSet {}{}\" part=\"{}\" name=\"{}\" file=\"{}\"/>\n", time_key, time, part,
                          part == 0 ? "discs" : "contacts", escape_xml(file));
    ++part;
  }
  sum_.add(std::as_bytes(std::span(index_).subspan(before)));
  steps_.push_back(step);
}

void FrameWriter::write_index() const {
  write_file(folder_ / (name_ + ".pvd"), list_head + index_ + list_tail, true);
}

Assembly discs_of_frames(std::span<const Grain> grains, std::span<const Clump> clumps, bool come_and_go,
                         FrameOptions& options) {
  const auto any = [&](GrainShape shape) {
    return std::ranges::any_of(grains, [&](const Grain& grain) { return grain.shape() == shape; });
  };
  Assembly start;
  options.parts.clear();
  for (std::size_t g = 0; g < grains.size(); ++g) {
    const Grain& grain = grains[g];
    const auto add = [&](Vec2 offset, double radius) {
      options.parts.push_back({g, offset});
      start.centres.push_back(grain.position + turned(offset, grain.angle));
      start.radii.push_back(radius);
    };
    if (grain.shape() != GrainShape::clump) {
      add({}, grain.radius);
    } else {
      for (const Clump::Disc& disc : clumps[static_cast<std::size_t>(grain.clump)].discs) add(disc.offset, disc.radius);
    }
  }
  if (any(GrainShape::ellipse)) {
    options.of_discs.push_back({"short_half_axis", start.radii});
    DiscNumbers& axes = options.of_discs.back();
    for (std::size_t k = 0; k < options.parts.size(); ++k)
      if (const Grain& grain = grains[options.parts[k].body]; grain.shape() == GrainShape::ellipse)
        axes.values[k] = grain.short_half_axis;
  }
  if (any(GrainShape::clump) || come_and_go) {
    options.of_discs.push_back({"body", {}});
    DiscNumbers& bodies = options.of_discs.back();
    for (const FramePart& part : options.parts) bodies.values.push_back(static_cast<double>(part.body));
  }
  options.travelling = true;
  return start;
}

}  // namespace equidem
