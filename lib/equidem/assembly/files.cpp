// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/files.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "equidem/assembly/assembly.hpp"
#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/files/file_keys.hpp"
#include "equidem/assembly/files/hdf5_files.hpp"
#include "equidem/assembly/import/imported_assembly.hpp"
#include "equidem/assembly/touching.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/given.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

using Json = nlohmann::json;

const std::vector<std::string> known_keys = [] {
  std::vector<std::string> keys{"schema", "title",   "cell",    "box",        "discs",         "sections", "contacts",
                                "levers", "normals", "offsets", "cell_areas", "facet_lengths", "groups"};
  for (const ContactNumbers& numbers : contact_numbers) keys.emplace_back(numbers.key);
  return keys;
}();

const char* kind_of(const Json& value) {
  switch (value.type()) {
    case Json::value_t::null:
      return "null";
    case Json::value_t::object:
      return "an object";
    case Json::value_t::array:
      return "a list";
    case Json::value_t::string:
      return "a text";
    case Json::value_t::boolean:
      return "a truth value";
    default:
      return "a number";
  }
}

[[noreturn]] void wrong_kind(const Json& value, const std::string& expected, const std::string& entry) {
  bad_input_at(entry, fmt::format("{} stands where {} is expected", kind_of(value), expected), "", "Correct the entry");
}

double number(const Json& value, const std::string& entry) {
  if (!value.is_number()) wrong_kind(value, "a number", entry);
  const auto result = value.get<double>();
  if (!std::isfinite(result)) bad_input_at(entry, "the number is not finite", "", "Correct the entry");
  return result;
}

std::int32_t integer(const Json& value, const std::string& entry) {
  if (!value.is_number_integer()) {
    if (value.is_number()) {
      bad_input_at(entry, fmt::format("{} stands where a whole number is expected", value.dump()), "",
                   "Correct the entry");
    }
    wrong_kind(value, "a whole number", entry);
  }
  const bool fits = value.is_number_unsigned() ? value.get<std::uint64_t>() <= std::numeric_limits<std::int32_t>::max()
                                               : value.get<std::int64_t>() >= std::numeric_limits<std::int32_t>::min();
  if (!fits) {
    bad_input_at(entry, fmt::format("{} is out of range", value.dump()),
                 fmt::format("discs and shifts are whole numbers of a magnitude up to {}",
                             std::numeric_limits<std::int32_t>::max()),
                 "Correct the entry");
  }
  return value.get<std::int32_t>();
}

void check_list(const Json& value, const std::string& entry) {
  if (!value.is_array()) wrong_kind(value, "a list", entry);
}

/// A list of exactly as many entries as `names` names, separated by commas.
void check_row(const Json& value, std::size_t count, const char* names, const std::string& entry) {
  check_list(value, entry);
  if (value.size() == count) return;
  bad_input_at(entry,
               fmt::format("{} {} where {} are expected", counted(value.size(), "number"),
                           value.size() == 1 ? "stands" : "stand", count),
               fmt::format("an entry is [{}]", names), "Correct the entry");
}

/// A list of `count` entries, one for each `what`.
void check_list_per(const char* what, const Json& value, std::size_t count, const std::string& entry) {
  check_list(value, entry);
  if (value.size() == count) return;
  bad_input_at(entry, fmt::format("{} for {}", counted(value.size(), "entry", "entries"), counted(count, what)),
               "there must be one for each",
               entry == "springs" ? "Take the springs of this assembly, or remove them and give kN and kT in the case"
                                  : "Correct the list or remove it");
}

/// "key": one pair of numbers for each of `count`; take(k, first, second). Nothing where the file has no such key.
template <typename Take>
void read_pairs(const Json& file, const char* key, const char* names, const char* what, std::size_t count,
                const Take& take) {
  if (!file.contains(key)) return;
  const Json& pairs = file[key];
  check_list_per(what, pairs, count, key);
  for (std::size_t k = 0; k < count; ++k) {
    const std::string entry = fmt::format("{}[{}]", key, k);
    const Json& pair = pairs[k];
    check_row(pair, 2, names, entry);
    take(k, number(pair[0], entry), number(pair[1], entry));
  }
}

/// "key": one number for each of `count`.
void read_numbers(const Json& file, const char* key, const char* what, std::size_t count, std::vector<double>& to) {
  if (!file.contains(key)) return;
  check_list_per(what, file[key], count, key);
  for (std::size_t k = 0; k < count; ++k) to.push_back(number(file[key][k], fmt::format("{}[{}]", key, k)));
}

void check_keys(const Json& file) {
  if (!file.is_object()) wrong_kind(file, "an object with the keys schema, discs, ...", "");
  const auto found = file.find("schema");
  if (found == file.end() || *found != assembly_schema) {
    const std::string given = found == file.end() ? "" : found->is_string() ? found->get<std::string>() : found->dump();
    check_schema(given, fmt::format("\"schema\": \"{}\"", assembly_schema));
  }
  for (const auto& item : file.items()) check_key(item.key(), known_keys);
  if (!file.contains("discs")) {
    bad_input_at("discs", "the key 'discs' is missing", "an assembly is made of discs",
                 "Add \"discs\": [[x, y, radius], ...]");
  }
  if (file.contains("title") && !file["title"].is_string()) wrong_kind(file["title"], "a text", "title");
}

void read_discs(const Json& file, Assembly& assembly) {
  if (file.contains("cell") && !file["cell"].is_null()) {
    const Json& cell = file["cell"];
    check_row(cell, 2, "Lx, Ly", "cell");
    assembly.period = Vec2{number(cell[0], "cell[0]"), number(cell[1], "cell[1]")};
  }
  if (file.contains("box")) {
    const Json& corners = file["box"];
    const bool turned = corners.is_array() && corners.size() == 3;
    if (!turned) check_row(corners, 2, "[x, y], [x, y]", "box");
    const auto corner = [&](std::size_t k) {
      const std::string entry = fmt::format("box[{}]", k);
      const Json& place = corners[k];
      check_row(place, 2, "x, y", entry);
      return Vec2{number(place[0], entry), number(place[1], entry)};
    };
    assembly.box = TurnedRectangle({.low = corner(0), .high = corner(1)}, turned ? corner(2) : Vec2{1, 0});
  }
  const Json& discs = file["discs"];
  check_list(discs, "discs");
  for (std::size_t k = 0; k < discs.size(); ++k) {
    const std::string entry = fmt::format("discs[{}]", k);
    const Json& disc = discs[k];
    check_row(disc, 3, "x, y, radius", entry);
    assembly.centres.push_back({number(disc[0], entry), number(disc[1], entry)});
    assembly.radii.push_back(number(disc[2], entry));
  }
  read_pairs(file, "sections", "area, polar moment", "disc", assembly.size(),
             [&](std::size_t, double area, double moment) {
               assembly.sections.push_back({area, moment});
             });
  read_numbers(file, "cell_areas", "disc", assembly.size(), assembly.cell_areas);
}

void read_contacts(const Json& file, double gap_tolerance, Assembly& assembly) {
  check_keys_together([&](const char* key) { return file.contains(key); }, gap_tolerance);
  if (!file.contains("contacts")) {
    check(assembly);
    assembly.contacts = touching_discs(assembly, gap_tolerance);
    assembly.gap_tolerance = gap_tolerance;
    return;
  }
  const Json& contacts = file["contacts"];
  check_list(contacts, "contacts");
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const std::string entry = fmt::format("contacts[{}]", k);
    const Json& contact = contacts[k];
    check_row(contact, 4, "i, j, shift x, shift y", entry);
    assembly.contacts.push_back({.i = integer(contact[0], entry),
                                 .j = integer(contact[1], entry),
                                 .shift_x = integer(contact[2], entry),
                                 .shift_y = integer(contact[3], entry)});
  }
  // Discs that exist are needed before the midpoints of branches.
  check(assembly);
  for (Contact& contact : assembly.contacts) {
    contact.lever_i = contact.lever_j = 0.5 * norm(assembly.branch(contact));
  }
}

void read_levers_and_springs(const Json& file, Assembly& assembly) {
  const std::size_t contacts = assembly.contacts.size();
  read_pairs(file, "levers", "r_i, r_j", "contact", contacts, [&](std::size_t k, double r_i, double r_j) {
    assembly.contacts[k].lever_i = r_i;
    assembly.contacts[k].lever_j = r_j;
  });
  if (file.contains("normals")) assembly.contact_arms.resize(contacts);
  read_pairs(file, "normals", "n_x, n_y", "contact", contacts, [&](std::size_t k, double x, double y) {
    assembly.contact_arms[k].normal = {x, y};
  });
  read_pairs(file, "offsets", "o_i, o_j", "contact", contacts, [&](std::size_t k, double o_i, double o_j) {
    assembly.contact_arms[k].offset_i = o_i;
    assembly.contact_arms[k].offset_j = o_j;
  });
  for (const ContactNumbers& numbers : contact_numbers) {
    read_pairs(file, numbers.key, numbers.symbols, "contact", contacts,
               [&](std::size_t, double first, double second) { numbers.add(first, second, assembly); });
  }
  read_numbers(file, "facet_lengths", "contact", contacts, assembly.facet_lengths);
  refuse_repeated_contacts(assembly);
}

DiscGroup read_group(const Json& value, const std::string& entry) {
  const Json* discs = &value;
  const Json* lengths = nullptr;
  if (value.is_object()) {
    for (const auto& [key, part] : value.items()) {
      if (key == "discs") continue;
      if (key == "tributary_lengths") {
        lengths = &part;
        continue;
      }
      bad_input_at(entry, fmt::format("there is no key '{}' in a group", key),
                   "its keys are 'discs' and 'tributary_lengths'", "Correct or remove it");
    }
    if (!value.contains("discs")) bad_input_at(entry, "the key 'discs' is missing", "", "Add the list of discs");
    discs = &value["discs"];
  }
  check_list(*discs, entry);
  if (lengths != nullptr) check_list(*lengths, entry);
  if (lengths != nullptr && lengths->size() != discs->size()) {
    bad_input_at(entry,
                 fmt::format("{} for {}", counted(lengths->size(), "tributary length"), counted(discs->size(), "disc")),
                 "there must be one for each", "Correct the list or remove it");
  }
  std::vector<std::pair<std::int32_t, double>> members;
  for (std::size_t k = 0; k < discs->size(); ++k) {
    const std::string member = fmt::format("{}[{}]", entry, k);
    members.emplace_back(integer((*discs)[k], member), lengths != nullptr ? number((*lengths)[k], member) : 0);
  }
  std::sort(members.begin(), members.end());
  DiscGroup result;
  for (const auto& [disc, length] : members) {
    result.discs.push_back(disc);
    if (lengths != nullptr) result.tributary_lengths.push_back(length);
  }
  return result;
}

Json parse(const std::string& text) {
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) {
    bad_input_at("line 1, column 1", "the file is empty", "an assembly is made of discs", "Write it again");
  }
  // Numbers of a line such as "[0.5, 1, 0.25]" take the most: 16 bytes each and a vector that grows. Refused
  // beforehand, because the parser cannot free its values where memory has run out.
  constexpr double bytes_per_byte = 6;
  require_memory(bytes_per_byte * static_cast<double>(text.size()),
                 fmt::format("{} of JSON need about", readable_bytes(static_cast<double>(text.size()))));
  std::vector<std::set<std::string>> keys;  // of the objects that are open
  const auto refuse_repeated = [&](int, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second) {
      const auto key = parsed.get<std::string>();
      bad_input_at(key, fmt::format("the key '{}' is there twice", key), "one of the two would be dropped",
                   "Remove one");
    }
    return true;
  };
  try {
    return Json::parse(text, refuse_repeated);
  } catch (const Json::parse_error& error) {
    const std::size_t byte = std::min(error.byte, text.size());
    const std::string_view before(text.data(), byte);
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const std::size_t line_start = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
    const bool truncated = error.byte > text.size() || text.empty();
    bad_input_at(fmt::format("line {}, column {}", line, std::max<std::size_t>(byte, line_start + 1) - line_start),
                 truncated ? "the file ends in the middle of an entry" : "this is not JSON",
                 fmt::format("reading stopped at byte {} of {}", byte, text.size()),
                 truncated ? "Get the whole file: it was cut off" : "Correct the text there");
  } catch (const Json::exception&) {
    bad_input("a number is too large for a double", "the largest is 1.8e308", "Correct it");
  }
}

Assembly assembly_of(const Json& file, double gap_tolerance) {
  check_keys(file);
  Assembly assembly;
  assembly.kind = "file";
  read_discs(file, assembly);
  read_contacts(file, gap_tolerance, assembly);
  read_levers_and_springs(file, assembly);
  if (file.contains("groups")) {
    if (!file["groups"].is_object()) wrong_kind(file["groups"], "an object of groups", "groups");
    for (const auto& [name, value] : file["groups"].items()) {
      assembly.groups[name] = read_group(value, fmt::format("groups.{}", name));
    }
  }
  check(assembly);
  measure_missing_cells(assembly);
  return assembly;
}

}  // namespace

std::string quoted_json(const std::string& text) {
  return Json(text).dump();
}

namespace {

/// Files of this program say all that a case could say of others.
void refuse_foreign_options(const AssemblyFileOptions& options) {
  const std::pair<bool, const char*> foreign[] = {
      {!options.unit_of_length.empty(), "unit_of_length"}, {options.frame.has_value(), "frame"},
      {options.plane != SamplePlane::xy, "plane"},         {options.contacts.has_value(), "contacts"},
      {options.periodic_box.has_value(), "periodic_box"},  {options.period.has_value(), "period"}};
  for (const auto& [given, name] : foreign) {
    if (given)
      bad_input(fmt::format("assembly.{} is given, and the file is an assembly file", name),
                "it is for files of other programs; this one says it itself", "Leave it out");
  }
}

void require_text(std::string_view content, const std::filesystem::path& path) {
  constexpr std::size_t head = 512;
  const bool is_text = std::ranges::none_of(content.substr(0, head), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return std::iscntrl(byte) != 0 && std::isspace(byte) == 0;
  });
  if (is_text) return;
  bad_input_at(path.string(), "this is not JSON, nor text of another program",
               "it is compressed, or in a binary form of its program", "Unpack it, or write it as text");
}

}  // namespace

Assembly read_assembly(const std::filesystem::path& path, const AssemblyFileOptions& options) {
  if (const auto given = Given<Assembly>::find(path)) return *given;
  const bool is_hdf5 = is_hdf5_name(path);
  if (is_hdf5) check_readable(path);
  const std::string text = is_hdf5 ? std::string() : read_file(path);
  refuse_utf16(text, path.string());
  require_text(text, path);
  const ParticleFormat format = is_hdf5 || path.extension() == ".json" ? ParticleFormat::none : particle_format(text);
  if (format != ParticleFormat::none) {
    Assembly imported = imported_assembly(path, text, format, options);
    check(imported);
    measure_cells(imported);
    return imported;
  }
  try {
    if (is_hdf5 || text.find_first_not_of(" \t\r\n") != std::string::npos) refuse_foreign_options(options);
    return is_hdf5 ? read_hdf5_assembly(path, options.gap_tolerance) : assembly_of(parse(text), options.gap_tolerance);
  } catch (const Error& error) {
    // "file: entry", so that the user finds both.
    const std::string where = error.where().empty() ? path.string() : path.string() + ": " + error.where();
    throw Error(error.kind(), error.problem(), error.why(), error.remedy(), where);
  }
}

namespace {

/// The shortest text that reads back to the same bits; the sign of -0 needs a point, or it reads as a whole number.
std::string shortest(double value) {
  return value == 0 && std::signbit(value) ? "-0.0" : fmt::format("{}", value);
}

std::string pair_of(double first, double second) {
  return fmt::format("[{}, {}]", shortest(first), shortest(second));
}

/// See json_of.
void write_json(const TextSink& to, const Assembly& assembly) {
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
  const auto append_list = [&](const char* key, std::size_t count, const auto& entry) {  // one per line
    text += fmt::format(",\n\"{}\": [", key);
    for (std::size_t k = 0; k < count; ++k) {
      text += (k == 0 ? "\n" : ",\n") + entry(k);
      pass_block(text, to);
    }
    text += "]";
  };
  append_list("discs", assembly.size(), [&](std::size_t k) {
    return fmt::format("[{}, {}, {}]", shortest(assembly.centres[k].x), shortest(assembly.centres[k].y),
                       shortest(assembly.radii[k]));
  });
  if (!assembly.sections.empty()) {
    append_list("sections", assembly.size(),
                [&](std::size_t k) { return pair_of(assembly.sections[k].area, assembly.sections[k].polar_moment); });
  }
  const auto append_numbers = [&](const char* key, const std::vector<double>& numbers) {
    append_list(key, numbers.size(), [&](std::size_t k) { return shortest(numbers[k]); });
  };
  if (!assembly.cell_areas.empty()) append_numbers("cell_areas", assembly.cell_areas);
  const auto& contacts = assembly.contacts;
  append_list("contacts", contacts.size(), [&](std::size_t k) {
    return fmt::format("[{}, {}, {}, {}]", contacts[k].i, contacts[k].j, contacts[k].shift_x, contacts[k].shift_y);
  });
  append_list("levers", contacts.size(),
              [&](std::size_t k) { return pair_of(contacts[k].lever_i, contacts[k].lever_j); });
  const auto& arms = assembly.contact_arms;
  if (!arms.empty()) {
    append_list("normals", contacts.size(), [&](std::size_t k) { return pair_of(arms[k].normal.x, arms[k].normal.y); });
    append_list("offsets", contacts.size(), [&](std::size_t k) { return pair_of(arms[k].offset_i, arms[k].offset_j); });
  }
  for (const ContactNumbers& numbers : contact_numbers) {
    if (!numbers.given(assembly)) continue;
    append_list(numbers.key, contacts.size(),
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
  to(text + "}\n");
}

}  // namespace

std::string json_of(const Assembly& assembly) {
  std::string all;
  write_json([&](std::string_view part) { all += part; }, assembly);
  return all;
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
  write_file(
      path, [&](const TextSink& to) { write_json(to, assembly); }, overwrite);
}

}  // namespace equidem
