// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/import/imported_assembly.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>

#include "equidem/assembly/files/file_keys.hpp"
#include "equidem/assembly/import/particle_table.hpp"
#include "equidem/assembly/touching.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

const std::vector<std::string> names_of_i = {"i", "id1", "id_1", "batom1"}, names_of_j = {"j", "id2", "id_2", "batom2"};
/// Pairs of columns of which both are given or none.
constexpr std::array<std::array<const char*, 2>, 4> column_pairs = {
    {{"shift_x", "shift_y"}, {"lever_i", "lever_j"}, {"normal_x", "normal_y"}, {"offset_i", "offset_j"}}};

using OptionalColumn = std::optional<std::size_t>;

struct ContactColumns {
  std::size_t i = 0, j = 1;
  std::array<std::array<OptionalColumn, 2>, column_pairs.size()> optional{};
};

/// A column that is nearly one of those that are read is taken for a typing error.
void refuse_near_names(const TableFile& table) {
  std::vector<std::string> known;
  for (const auto& pair : column_pairs) known.insert(known.end(), pair.begin(), pair.end());
  for (const ColumnName& column : table.names()) {
    if (std::ranges::find(known, column.name) != known.end() || column.name.size() < 4) continue;
    if (const auto meant = nearest(column.name, known))
      table.fail_at_names(fmt::format("there is no column '{}' of contacts", column.name),
                          "it is nearly one that is read", fmt::format("Did you mean '{}'?", *meant));
  }
}

ContactColumns contact_columns(const TableFile& table, bool local_dump) {
  ContactColumns c;
  if (table.names().empty() || (local_dump && !table.find(names_of_i))) {
    if (table.width() == 2) return c;
    table.fail(fmt::format("the table has {} columns", table.width()),
               local_dump ? "their names do not say which are the two particles" : "they have no names",
               local_dump ? "Dump two columns, or name them: dump_modify colname 1 i colname 2 j"
                          : "Name them in a first line: i j");
  }
  refuse_near_names(table);
  c.i = table.need(names_of_i, "a contact joins two particles");
  c.j = table.need(names_of_j, "a contact joins two particles");
  for (std::size_t p = 0; p < column_pairs.size(); ++p) {
    for (std::size_t k = 0; k < 2; ++k) c.optional[p][k] = table.find({column_pairs[p][k]});
    if (c.optional[p][0].has_value() != c.optional[p][1].has_value())
      table.fail_at_names(
          fmt::format("only one of the columns {} and {} is there", column_pairs[p][0], column_pairs[p][1]),
          "they belong together", "Give both, or none");
  }
  const auto& [shifts, levers, normals, offsets] = c.optional;
  if ((normals[0] || offsets[0]) && !(normals[0] && offsets[0] && levers[0]))
    table.fail_at_names("normals, offsets and levers are not all there",
                        "off the line of centres a contact has a normal, levers along it and offsets across it",
                        "Give all six columns, or none of normal_x, normal_y, offset_i, offset_j");
  return c;
}

/// The unit that the names of levers and offsets carry; none where none does.
std::optional<double> unit_of_contact_lengths(const TableFile& table, const ContactColumns& columns) {
  const auto& [shifts, levers, normals, offsets] = columns.optional;
  if (!levers[0]) return {};
  const auto unit = table.factor(*levers[0], Dimension::length);
  for (const OptionalColumn place : {levers[1], offsets[0], offsets[1]}) {
    if (place && table.factor(*place, Dimension::length) != unit)
      table.fail_at_names("levers and offsets are in different units", "they have one unit", "Convert one of them");
  }
  return unit;
}

/// The rows of the last frame of a local dump, with the names of their columns before them.
std::string table_of_local_dump(std::string_view text) {
  constexpr std::string_view heading = "ITEM: ENTRIES";
  const std::size_t at = text.rfind(heading);
  if (at == std::string_view::npos)
    bad_input_at("line 1", "the dump has no ENTRIES", "contacts are those of \"dump local\"",
                 "Dump them by \"compute 1 all property/local batom1 batom2\" and \"dump local\"");
  // Empty lines in place of what stands before keep the numbers of the lines.
  return std::string(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'), '\n') +
         std::string(text.substr(at + heading.size()));
}

}  // namespace

std::vector<ContactRow> read_contact_rows(std::string_view text) {
  const bool local_dump = text.starts_with("ITEM:");
  const std::string kept = local_dump ? table_of_local_dump(text) : std::string();
  TableFile table(local_dump ? std::string_view(kept) : text, {}, {names_of_i, names_of_j});
  if (!table.next()) bad_input("the table has no rows", "every row is a contact", "Write it again");
  const ContactColumns columns = contact_columns(table, local_dump);
  const auto& [shifts, levers, normals, offsets] = columns.optional;
  const std::optional<double> unit = unit_of_contact_lengths(table, columns);
  std::vector<ContactRow> rows;
  do {
    ContactRow row{.line = table.line(), .unit = unit};
    row.i = table.whole(columns.i, "particle");
    row.j = table.whole(columns.j, "particle");
    if (shifts[0]) {
      row.shift_x = table.whole(*shifts[0]);
      row.shift_y = table.whole(*shifts[1]);
    }
    if (levers[0]) {
      row.lever_i = table.number(*levers[0]);
      row.lever_j = table.number(*levers[1]);
    }
    if (normals[0]) {
      row.normal = Vec2{table.number(*normals[0]), table.number(*normals[1])};
      row.offset_i = table.number(*offsets[0]);
      row.offset_j = table.number(*offsets[1]);
    }
    rows.push_back(row);
  } while (table.next());
  return rows;
}

namespace {

using Particle = ParticleRows::Particle;

std::string at_line(int line) {
  return fmt::format("line {}", line);
}

/// The plane of the sample as x and y.
void turn_to_plane(SamplePlane plane, ParticleRows& rows) {
  if (plane == SamplePlane::xy) return;
  const bool from_yz = plane == SamplePlane::yz;
  for (Particle& particle : rows.particles) {
    if (from_yz) std::swap(particle.x, particle.y);
    std::swap(particle.y, particle.z);
  }
  if (!rows.box) return;
  ParticleRows::Box& box = *rows.box;
  if (from_yz) {
    std::swap(box.low.x, box.low.y), std::swap(box.high.x, box.high.y);
    std::swap(box.periodic_x, box.periodic_y);
  }
  std::swap(box.low.y, box.low_z), std::swap(box.high.y, box.high_z);
  std::swap(box.periodic_y, box.periodic_z);
}

ParticleRows rows_of(std::string_view text, ParticleFormat format, const AssemblyFileOptions& options) {
  if (options.frame && format != ParticleFormat::lammps_dump)
    bad_input("a frame is named, and the file holds one state", "frames are those of a LAMMPS dump",
              "Leave out assembly.frame");
  switch (format) {
    case ParticleFormat::lammps_dump:
      return read_lammps_dump(text, options.frame);
    case ParticleFormat::lammps_data:
      return read_lammps_data(text);
    case ParticleFormat::table:
    case ParticleFormat::none:
      break;
  }
  return read_particle_table(text);
}

/// Metres of the unit of the file. A number without a unit is no length: it is asked for.
double unit_of_rows(const ParticleRows& rows, const std::string& given) {
  if (given.empty()) {
    if (rows.unit) return *rows.unit;
    const std::string why = rows.units.empty() ? fmt::format("{} holds plain numbers", rows.format)
                                               : fmt::format("its units are {}", rows.units);
    bad_input("the file does not say its unit of length", why,
              "Give it: assembly.unit_of_length = \"mm\", \"m\" or a length such as \"2.5 mm\"");
  }
  const std::optional<double> unit = length_unit(given);
  if (!unit)
    bad_input(fmt::format("'{}' is no unit of length", given), "units are m, cm, mm, um, nm, or a length as \"2.5 mm\"",
              "Correct assembly.unit_of_length");
  constexpr double rounding = 1e-12;
  if (rows.unit && std::abs(*unit - *rows.unit) > rounding * *unit)
    bad_input(fmt::format("assembly.unit_of_length is {}, and the file is in units of {} m", given, *rows.unit),
              "one of them is wrong", "Leave out unit_of_length, or correct it");
  return *unit;
}

/// The period, m; none: free.
std::optional<Vec2> period_of(const ParticleRows& rows, double unit, const AssemblyFileOptions& options) {
  if (!rows.box) {
    if (options.periodic_box && !options.period)
      bad_input("the file has no box", "assembly.periodic_box is about the box of a LAMMPS file",
                "Give assembly.period, or leave it out");
    return options.period;
  }
  if (options.period)
    bad_input("the file says its box, and the case a period", "one of them is too much", "Leave out assembly.period");
  const auto &px = rows.box->periodic_x, &py = rows.box->periodic_y;
  const Vec2 size = unit * (rows.box->high - rows.box->low);
  if (options.periodic_box) {
    if (*options.periodic_box && px && !(*px && *py))
      bad_input("assembly.periodic_box is true, and the box of the file is not periodic along both x and y",
                "its flags say so", "Leave it out");
    return *options.periodic_box ? std::optional(size) : std::nullopt;
  }
  if (!px)
    bad_input("the file does not say whether its box is periodic", fmt::format("{} has no flags of it", rows.format),
              "Give assembly.periodic_box = true or false");
  if (*px != *py)
    bad_input(fmt::format("the box is periodic along {} only", *px ? "x" : "y"),
              "a cell here is periodic along both, or free",
              "Give assembly.periodic_box = false to take it as free: what touches across the period is then parted");
  return *px ? std::optional(size) : std::nullopt;
}

/// Ascending ids, no two alike.
void sort_by_id(std::vector<Particle>& particles) {
  if (!std::ranges::is_sorted(particles, {}, &Particle::id)) std::ranges::stable_sort(particles, {}, &Particle::id);
  const auto twice = std::ranges::adjacent_find(particles, {}, &Particle::id);
  if (twice == particles.end()) return;
  bad_input_at(at_line(std::next(twice)->line), fmt::format("particle {} is there twice", twice->id),
               fmt::format("it stands at line {}, too", twice->line), "Keep one");
}

/// All centres in the plane that the case names, by default x-y.
void check_plane(const std::vector<Particle>& particles, SamplePlane plane) {
  const double rounding = 1e-6 * std::ranges::max_element(particles, {}, &Particle::radius)->radius;
  const auto range = [&](double Particle::*axis) {
    const auto [low, high] = std::ranges::minmax_element(particles, {}, axis);
    return std::tuple((*low).*axis, (*high).*axis, high->line);
  };
  const auto [low, high, line] = range(&Particle::z);
  if (high - low <= rounding) return;
  if (plane != SamplePlane::xy)
    bad_input_at(at_line(line),
                 fmt::format("the sample does not lie in the plane {}: across it centres go from {:.6g} to {:.6g}",
                             to_string(plane), low, high),
                 "discs lie in one plane", "Correct assembly.plane, or leave it out");
  for (const auto& [axis, name, found] :
       {std::tuple(&Particle::y, "y", SamplePlane::xz), std::tuple(&Particle::x, "x", SamplePlane::yz)}) {
    const auto [least, most, at] = range(axis);
    if (most - least > rounding) continue;
    bad_input_at(at_line(line),
                 fmt::format("the sample lies in the plane {}: every {} is {:.6g}, and z goes from {:.6g} to {:.6g}",
                             to_string(found), name, least, low, high),
                 "discs are read in the plane x-y, y upwards, unless the case says otherwise",
                 fmt::format("Give assembly.plane = \"{}\"", to_string(found)));
  }
  bad_input_at(at_line(line),
               fmt::format("the particles are three-dimensional: z goes from {:.6g} to {:.6g}", low, high),
               "discs lie in one plane", "Export a two-dimensional packing, all of it with one z");
}

Assembly discs_of(const std::vector<Particle>& particles, double unit) {
  Assembly assembly;
  assembly.kind = "file";
  for (const Particle& particle : particles) {
    if (!is_positive(particle.radius))
      bad_input_at(at_line(particle.line), fmt::format("the radius is {:.6g}", particle.radius),
                   "every disc has a size; LAMMPS gives point particles none", "Correct it, or leave the particle out");
    assembly.centres.push_back({unit * particle.x, unit * particle.y});
    assembly.radii.push_back(unit * particle.radius);
  }
  return assembly;
}

/// A particle that stands twice in the file, perhaps with other digits.
void refuse_particles_in_one_place(const std::vector<Particle>& particles, const Assembly& assembly,
                                   std::span<const Contact> touching) {
  constexpr double digits = 1e-6, most = 0.01;  // of the coordinates; of the smaller radius
  for (const Contact& contact : touching) {
    const auto i = static_cast<std::size_t>(contact.i), j = static_cast<std::size_t>(contact.j);
    const double radius = std::min(assembly.radii[i], assembly.radii[j]), distance = norm(assembly.branch(contact));
    const double size = std::max({radius, std::abs(assembly.centres[i].x), std::abs(assembly.centres[i].y)});
    if (distance > std::min(most * radius, digits * size)) continue;
    const auto [first, second] =
        std::minmax(particles[i], particles[j], [](const Particle& a, const Particle& b) { return a.line < b.line; });
    bad_input_at(at_line(second.line), fmt::format("particles {} and {} lie in one place", first.id, second.id),
                 fmt::format("their centres are {:.3g} m apart; the other stands at line {}", distance, first.line),
                 "Keep one of them");
  }
}

std::int32_t disc_of(const std::vector<Particle>& particles, std::int64_t id, int line) {
  const auto found = std::ranges::lower_bound(particles, id, {}, &Particle::id);
  if (found == particles.end() || found->id != id)
    bad_input_at(at_line(line), fmt::format("the contact names particle {}, which is not there", id),
                 fmt::format("the particles are numbered from {} to {}", particles.front().id, particles.back().id),
                 "Take contacts and particles of one state; rows without ids count from 0");
  return static_cast<std::int32_t>(found - particles.begin());
}

std::int32_t nearest_shift(double distance, double period) {
  return -static_cast<std::int32_t>(std::lround(distance / period));
}

Contact contact_of(const ContactRow& row, const std::vector<Particle>& particles, const Assembly& assembly) {
  Contact contact{.i = disc_of(particles, row.i, row.line), .j = disc_of(particles, row.j, row.line)};
  constexpr std::int64_t most_periods = 1 << 20;
  if (row.shift_x) {
    if (std::abs(*row.shift_x) > most_periods || std::abs(*row.shift_y) > most_periods)
      bad_input_at(at_line(row.line), "the shift is out of range", "it is a number of periods", "Correct it");
    contact.shift_x = static_cast<std::int32_t>(*row.shift_x);
    contact.shift_y = static_cast<std::int32_t>(*row.shift_y);
  } else if (assembly.period) {
    const Vec2 d =
        assembly.centres[static_cast<std::size_t>(contact.j)] - assembly.centres[static_cast<std::size_t>(contact.i)];
    contact.shift_x = nearest_shift(d.x, assembly.period->x);
    contact.shift_y = nearest_shift(d.y, assembly.period->y);
  }
  return contact;
}

/// A bond over more than half of a box that is taken as free leads through its sides.
void check_within_box(const ContactRow& row, const Contact& contact, const ParticleRows& rows, double unit,
                      const Assembly& assembly) {
  if (!rows.box || assembly.period) return;
  const Vec2 d = assembly.branch(contact), size = unit * (rows.box->high - rows.box->low);
  if (std::abs(d.x) <= 0.5 * size.x && std::abs(d.y) <= 0.5 * size.y) return;
  bad_input_at(at_line(row.line), fmt::format("the contact of particles {} and {} crosses the box", row.i, row.j),
               "the box is taken as free, and they are more than half of it apart",
               "Give assembly.periodic_box = true, or take the contact out");
}

void divide_by_radii(const Assembly& assembly, Contact& contact) {
  const double distance = norm(assembly.branch(contact)), ri = assembly.radii[static_cast<std::size_t>(contact.i)];
  contact.lever_i = distance * ri / (ri + assembly.radii[static_cast<std::size_t>(contact.j)]);
  contact.lever_j = distance - contact.lever_i;
}

enum class ContactPoint { by_radii, middle };

void add_contacts(const std::vector<ContactRow>& given, const ParticleRows& rows, double unit, ContactPoint point,
                  Assembly& assembly) {
  for (const ContactRow& row : given) {
    Contact contact = contact_of(row, rows.particles, assembly);
    check_within_box(row, contact, rows, unit, assembly);
    const double length = row.unit.value_or(unit);
    if (row.lever_i) {
      contact.lever_i = length * *row.lever_i;
      contact.lever_j = length * *row.lever_j;
    } else if (point == ContactPoint::by_radii) {
      divide_by_radii(assembly, contact);
    } else {
      contact.lever_i = contact.lever_j = 0.5 * norm(assembly.branch(contact));
    }
    if (row.normal) assembly.contact_arms.push_back({*row.normal, length * row.offset_i, length * row.offset_j});
    assembly.contacts.push_back(contact);
  }
}

/// Errors of the task with the file before their place.
template <typename Task>
auto within_file(const std::filesystem::path& path, const Task& task) {
  try {
    return task();
  } catch (const Error& error) {
    const std::string where = path.string() + (error.where().empty() ? "" : ": " + error.where());
    throw Error(error.kind(), error.problem(), error.why(), error.remedy(), where);
  }
}

/// The discs and the period, checked.
Assembly discs_of(ParticleRows& rows, double unit, const AssemblyFileOptions& options) {
  sort_by_id(rows.particles);
  check_plane(rows.particles, options.plane);
  Assembly assembly = discs_of(rows.particles, unit);
  assembly.period = period_of(rows, unit, options);
  check(assembly);
  const bool given = options.contacts || rows.contacts;
  check_keys_together([&](const char* key) { return given && std::string_view(key) == "contacts"; },
                      options.gap_tolerance);
  return assembly;
}

}  // namespace

Assembly imported_assembly(const std::filesystem::path& path, std::string_view text, ParticleFormat format,
                           const AssemblyFileOptions& options) {
  ParticleRows rows;
  double unit = 1;
  Assembly assembly = within_file(path, [&] {
    rows = rows_of(text, format, options);
    turn_to_plane(options.plane, rows);
    if (rows.particles.empty())
      bad_input("the file has no particles", "there is nothing to solve for", "Write it again");
    unit = unit_of_rows(rows, options.unit_of_length);
    return discs_of(rows, unit, options);
  });
  if (options.contacts || rows.contacts)
    within_file(path, [&] { refuse_particles_in_one_place(rows.particles, assembly, touching_discs(assembly)); });
  if (options.contacts) {
    within_file(*options.contacts, [&] {
      add_contacts(read_contact_rows(read_file(*options.contacts)), rows, unit, ContactPoint::by_radii, assembly);
      refuse_repeated_contacts(assembly);
    });
    return assembly;
  }
  within_file(path, [&] {
    if (rows.contacts) {
      add_contacts(*rows.contacts, rows, unit, ContactPoint::middle, assembly);
      refuse_repeated_contacts(assembly);
      return;
    }
    assembly.gap_tolerance = options.gap_tolerance;
    assembly.contacts = touching_discs(assembly, options.gap_tolerance);
    refuse_particles_in_one_place(rows.particles, assembly, assembly.contacts);
  });
  return assembly;
}

}  // namespace equidem
