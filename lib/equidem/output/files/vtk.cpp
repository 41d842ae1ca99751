// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/vtk.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// \param discs of which the data are, the first ones \param numbers of discs; empty: not written
void write_state_discs(const TextSink& to, const AssemblyState& state, std::size_t discs,
                       std::span<const std::int64_t> numbers) {
  const Assembly& assembly = state.assembly;
  PolyData data(discs, discs, 0);
  if (!numbers.empty()) {
    data.declare<std::int64_t>("PointData", "number", discs, 1, [=](std::size_t disc, int) { return numbers[disc]; });
  }
  data.point_numbers("radius", [&](std::size_t disc) { return assembly.radii[disc]; });
  if (!assembly.cell_areas.empty()) {
    data.point_numbers("cell_area", [&](std::size_t disc) { return assembly.cell_areas[disc]; });
  }
  if (!state.motions.empty()) {
    data.point_vectors("displacement", [&](std::size_t disc) { return state.motions[disc].u; });
    data.point_numbers("rotation", [&](std::size_t disc) { return state.motions[disc].theta; });
  }
  if (!state.stresses.empty()) {
    data.point_numbers("stress_xx", [&](std::size_t disc) { return state.stresses[disc].xx; });
    data.point_numbers("stress_yy", [&](std::size_t disc) { return state.stresses[disc].yy; });
    data.point_numbers("stress_xy", [&](std::size_t disc) { return state.stresses[disc].xy; });
    data.point_numbers("stress_yx", [&](std::size_t disc) { return state.stresses[disc].yx; });
    data.point_numbers("mean_stress", [=](std::size_t disc) { return mean_stress(state.stresses[disc]); });
  }
  data.places([&](std::size_t disc) { return assembly.centres[disc]; });
  data.write(to);
}

void write_state_contacts(const TextSink& to, const AssemblyState& state) {
  const Assembly& assembly = state.assembly;
  const auto contact_of = [&](std::size_t c) {
    const ContactForce force = state.contact_forces.empty() ? ContactForce{} : state.contact_forces[c];
    BodyContact contact = bonded_contact(assembly, c, force);
    if (!state.bending_moments.empty()) contact.bending_moment = state.bending_moments[c];
    return contact;
  };
  write_contacts(to, {.places = assembly.centres, .motions = state.motions}, assembly.contacts.size(), contact_of,
                 {.forces = !state.contact_forces.empty(), .moments = !state.bending_moments.empty()});
}

/// The files of discs and of contacts. \param numbers see write_state_discs
void write_both(const std::filesystem::path& discs, const std::filesystem::path& contacts, const AssemblyState& state,
                std::span<const std::int64_t> numbers, bool overwrite) {
  const std::size_t count = numbers.empty() ? state.assembly.size() : numbers.size();
  write_file(
      discs, [&](const TextSink& to) { write_state_discs(to, state, count, numbers); }, overwrite);
  write_file(
      contacts, [&](const TextSink& to) { write_state_contacts(to, state); }, overwrite);
}

/// \param blocks lines of the index
std::string index_text(const std::string& blocks) {
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\" byte_order=\"{}\" "
      "header_type=\"UInt64\">\n  <vtkMultiBlockDataSet>\n{}  </vtkMultiBlockDataSet>\n</VTKFile>\n",
      vtk_byte_order(), blocks);
}

std::string piece_name(const std::string& name, const char* what, int piece) {
  return fmt::format("{}_{}_{}.vtp", name, what, piece);
}

}  // namespace

void write_contacts(const TextSink& to, const BodyPlaces& bodies, std::size_t count,
                    const std::function<BodyContact(std::size_t)>& contact_of, ContactLoads loads, const double* time) {
  // The points: the bodies, then the ends at walls and at images behind the period.
  struct End {
    std::size_t contact, body;
    Vec2 from_centre;
  };
  const std::size_t n = bodies.places.size(), m = count;
  const auto place_of = [&](std::int32_t number) {
    const auto body = static_cast<std::size_t>(number);
    if (bodies.numbers.empty()) return body;
    return static_cast<std::size_t>(std::ranges::lower_bound(bodies.numbers, body) - bodies.numbers.begin());
  };
  std::vector<End> ends;
  for (std::size_t c = 0; c < m; ++c) {
    const BodyContact contact = contact_of(c);
    const bool wall = contact.j < 0;
    if (wall || contact.shift != Vec2{})
      ends.push_back({c, place_of(wall ? contact.i : contact.j), wall ? contact.arm : contact.shift});
  }
  const auto second_of = [&](std::size_t c) {
    const auto end = std::ranges::lower_bound(ends, c, {}, &End::contact);
    if (end != ends.end() && end->contact == c) return n + static_cast<std::size_t>(end - ends.begin());
    return place_of(contact_of(c).j);
  };
  const auto body_of = [&](std::size_t point) { return point < n ? point : ends[point - n].body; };
  PolyData data(n + ends.size(), 0, m);
  data.point_numbers("radius", [](std::size_t) { return 0.0; });
  if (!bodies.motions.empty())
    data.point_vectors("displacement", [&](std::size_t point) { return bodies.motions[body_of(point)].u; });
  const auto vectors = [&](const char* name, auto vector) {
    data.declare<double>("CellData", name, m, 3, [vector, &contact_of](std::size_t c, int component) {
      return component_of(vector(contact_of(c)), component);
    });
  };
  const auto numbers = [&](const char* name, double BodyContact::*member, double sign = 1) {
    data.declare<double>("CellData", name, m, 1,
                         [member, sign, &contact_of](std::size_t c, int) { return sign * contact_of(c).*member; });
  };
  data.declare<std::int32_t>("CellData", "i", m, 1, [&](std::size_t c, int) { return contact_of(c).i; });
  data.declare<std::int32_t>("CellData", "j", m, 1, [&](std::size_t c, int) { return contact_of(c).j; });
  vectors("contact_point", [&](const BodyContact& c) { return bodies.places[place_of(c.i)] + c.arm; });
  if (loads.forces) {
    vectors("force", [](const BodyContact& c) { return c.force; });
    const double sign = loads.on_j ? -1 : 1;
    numbers("normal_force", &BodyContact::normal_force, sign);
    numbers("tangential_force", &BodyContact::tangential_force, sign);
  }
  if (loads.moments) numbers("bending_moment", &BodyContact::bending_moment);
  data.places([&](std::size_t point) {
    return point < n ? bodies.places[point] : bodies.places[ends[point - n].body] + ends[point - n].from_centre;
  });
  data.declare<std::int32_t>("Lines", "connectivity", 2 * m, 1, [&](std::size_t point, int) {
    return point % 2 == 0 ? place_of(contact_of(point / 2).i) : second_of(point / 2);
  });
  data.declare<std::int32_t>("Lines", "offsets", m, 1, [](std::size_t contact, int) { return 2 * (contact + 1); });
  data.write(to, time);
}

std::vector<std::filesystem::path> write_vtk(const std::filesystem::path& folder, const std::string& name,
                                             const AssemblyState& state, bool overwrite) {
  assert_consistent(state);
  const std::string discs = name + "_discs.vtp";
  const std::string contacts = name + "_contacts.vtp";
  const std::vector<std::filesystem::path> paths{folder / (name + ".vtm"), folder / discs, folder / contacts};
  for (const auto& path : paths) check_writable(path, overwrite);
  write_both(paths[1], paths[2], state, {}, overwrite);
  const std::string blocks = fmt::format(
      "    <DataSet index=\"0\" name=\"discs\" file=\"{}\"/>\n"
      "    <DataSet index=\"1\" name=\"contacts\" file=\"{}\"/>\n",
      escape_xml(discs), escape_xml(contacts));
  write_file(paths[0], index_text(blocks), overwrite);
  return paths;
}

std::vector<std::string> vtk_piece_names(const std::string& name, int piece) {
  return {piece_name(name, "discs", piece), piece_name(name, "contacts", piece)};
}

void write_vtk_piece(const std::filesystem::path& folder, const std::string& name, int piece,
                     const AssemblyState& state, std::span<const std::int64_t> numbers, bool overwrite) {
  assert_consistent(state);
  const std::vector<std::string> names = vtk_piece_names(name, piece);
  write_both(folder / names[0], folder / names[1], state, numbers, overwrite);
}

void write_vtk_index(const std::filesystem::path& folder, const std::string& name, int pieces, bool overwrite) {
  std::string blocks;
  int block = 0;
  for (const char* what : {"discs", "contacts"}) {
    blocks += fmt::format("    <Block index=\"{}\" name=\"{}\">\n", block++, what);
    for (int piece = 0; piece < pieces; ++piece) {
      blocks +=
          fmt::format("      <DataSet index=\"{}\" file=\"{}\"/>\n", piece, escape_xml(piece_name(name, what, piece)));
    }
    blocks += "    </Block>\n";
  }
  write_file(folder / (name + ".vtm"), index_text(blocks), overwrite);
}

const char* vtk_byte_order() {
  return std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
}

PolyData::PolyData(std::size_t points, std::size_t vertices, std::size_t lines)
    : points_(points), vertices_(vertices), lines_(lines) {}

void PolyData::declare(const std::string& section, const char* type, const std::string& name, std::size_t tuples,
                       int components, std::uint64_t bytes) {
  if (section != section_) {
    close_section();
    header_ += fmt::format("      <{}>\n", section);
    section_ = section;
  }
  header_ += fmt::format(
      "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" NumberOfTuples=\"{}\" format=\"appended\" "
      "offset=\"{}\"/>\n",
      type, name, components, tuples, offset_);
  offset_ += sizeof bytes + bytes;
}

void PolyData::write(const TextSink& to, const double* time) {
  close_section();
  const std::string field = time == nullptr
                                ? ""
                                : fmt::format(
                                      "    <FieldData>\n      <DataArray type=\"Float64\" Name=\"TimeValue\" "
                                      "NumberOfTuples=\"1\" format=\"ascii\">{}</DataArray>\n    </FieldData>\n",
                                      *time);
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"{}\" "
      "header_type=\"UInt64\">\n  <PolyData>\n{}    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" "
      "NumberOfLines=\"{}\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n{}"
      "    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">\n_",
      vtk_byte_order(), field, points_, vertices_, lines_, header_);
  for (const auto& append : arrays_) append(text, to);
  to(text + "\n  </AppendedData>\n</VTKFile>\n");
}

void PolyData::close_section() {
  if (!section_.empty()) header_ += fmt::format("      </{}>\n", section_);
  section_.clear();
}

std::string escape_xml(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    escaped += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : std::string(1, c);
  }
  return escaped;
}

}  // namespace equidem
