// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstdint>
#include <string>

#include "equidem/assembly/contact_numbers.hpp"
#include "equidem/assembly/files.hpp"
#include "equidem/assembly/files/file_keys.hpp"
#include "equidem/assembly/files/hdf5_files.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// The shortest text that reads back to the same bits; the sign of -0 needs a point, or it reads as a whole number.
std::string shortest(double value) {
  return value == 0 && std::signbit(value) ? "-0.0" : fmt::format("{}", value);
}

/// "key": [one per line].
template <typename Entry>
void append_list(std::string& text, const char* key, std::size_t count, const Entry& entry) {
  text += fmt::format(",\n\"{}\": [", key);
  for (std::size_t k = 0; k < count; ++k) text += (k == 0 ? "\n" : ",\n") + entry(k);
  text += "]";
}
std::string pair_of(double first, double second) {
  return fmt::format("[{}, {}]", shortest(first), shortest(second));
}

}  // namespace

std::string json_of(const Assembly& assembly) {
  std::string text = fmt::format("{{\"schema\": \"{}\"", assembly_schema);
  text += ",\n\"title\": " + quoted_json(assembly.kind);
  text += assembly.period
              ? fmt::format(",\n\"cell\": [{}, {}]", shortest(assembly.period->x), shortest(assembly.period->y))
              : ",\n\"cell\": null";
  if (assembly.box) {
    const auto& [low, high] = static_cast<const Rectangle&>(*assembly.box);
    const Vec2 along = assembly.box->along;
    text += fmt::format(",\n\"box\": [{}, {}", pair_of(low.x, low.y), pair_of(high.x, high.y));
    text += assembly.box->upright() ? "]" : fmt::format(", {}]", pair_of(along.x, along.y));
  }
  append_list(text, "discs", assembly.size(), [&](std::size_t k) {
    return fmt::format("[{}, {}, {}]", shortest(assembly.centres[k].x), shortest(assembly.centres[k].y),
                       shortest(assembly.radii[k]));
  });
  if (!assembly.sections.empty()) {
    append_list(text, "sections", assembly.size(),
                [&](std::size_t k) { return pair_of(assembly.sections[k].area, assembly.sections[k].polar_moment); });
  }
  const auto append_numbers = [&](const char* key, const std::vector<double>& numbers) {
    append_list(text, key, numbers.size(), [&](std::size_t k) { return shortest(numbers[k]); });
  };
  if (!assembly.cell_areas.empty()) append_numbers("cell_areas", assembly.cell_areas);
  const auto& contacts = assembly.contacts;
  append_list(text, "contacts", contacts.size(), [&](std::size_t k) {
    return fmt::format("[{}, {}, {}, {}]", contacts[k].i, contacts[k].j, contacts[k].shift_x, contacts[k].shift_y);
  });
  append_list(text, "levers", contacts.size(),
              [&](std::size_t k) { return pair_of(contacts[k].lever_i, contacts[k].lever_j); });
  const auto& arms = assembly.contact_arms;
  if (!arms.empty()) {
    append_list(text, "normals", contacts.size(),
                [&](std::size_t k) { return pair_of(arms[k].normal.x, arms[k].normal.y); });
    append_list(text, "offsets", contacts.size(),
                [&](std::size_t k) { return pair_of(arms[k].offset_i, arms[k].offset_j); });
  }
  for (const ContactNumbers& numbers : contact_numbers) {
    if (!numbers.given(assembly)) continue;
    append_list(text, numbers.key, contacts.size(),
                [&](std::size_t k) { return pair_of((assembly.*numbers.first)[k], (assembly.*numbers.second)[k]); });
  }
  if (!assembly.cell_areas.empty() && assembly.facet_lengths.size() == contacts.size())
    append_numbers("facet_lengths", assembly.facet_lengths);
  if (!assembly.groups.empty()) {
    std::string separator = ",\n\"groups\": {\n";
    for (const auto& [name, members] : assembly.groups) {
      const std::string discs =
          fmt::format("[{}]", joined(members.discs, [](std::int32_t disc) { return fmt::format("{}", disc); }));
      text += separator + quoted_json(name) + ": ";
      text += members.tributary_lengths.empty() ? discs
                                                : fmt::format("{{\"discs\": {}, \"tributary_lengths\": [{}]}}", discs,
                                                              joined(members.tributary_lengths, shortest));
      separator = ",\n";
    }
    text += "}";
  }
  return text + "}\n";
}

std::string assembly_file_name(const std::string& stem, AssemblyFormat format) {
  switch (format) {
    case AssemblyFormat::json:
      break;
    case AssemblyFormat::hdf5:
      return stem + ".h5";
  }
  return stem + ".json";
}

void write_assembly(const std::filesystem::path& path, const Assembly& assembly, bool overwrite) {
  check_writable(path, overwrite);
  check(assembly);
  if (is_hdf5_name(path)) return write_hdf5_assembly(path, assembly);
  write_file(path, json_of(assembly), overwrite);
}

}  // namespace equidem
