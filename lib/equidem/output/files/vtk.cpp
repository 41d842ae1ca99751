// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/vtk.hpp"

#include <bit>
#include <cstdint>
#include <cstring>
#include <functional>
#include <type_traits>
#include <utility>

#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/xml.hpp"

namespace equidem {
namespace {

constexpr const char* byte_order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";

template <class Number>
constexpr const char* vtk_type() {
  if constexpr (std::is_same_v<Number, double>) return "Float64";
  if constexpr (std::is_same_v<Number, std::int32_t>) return "Int32";
  if constexpr (std::is_same_v<Number, std::int64_t>) return "Int64";
}

/// One PolyData piece. Arrays are declared first and generated when the file is put together, so that only the text
/// of the file itself is ever held. Appended raw data: an underscore, then for each array its length in bytes
/// (UInt64) and its numbers; the offsets in the declarations count from behind the underscore.
class PolyData {
 public:
  PolyData(std::size_t points, std::size_t vertices, std::size_t lines)
      : counts_(
            fmt::format("NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\"", points, vertices, lines)) {}

  /// value(tuple, component) for every tuple in [0, tuples).
  template <class Number, class Value>
  void declare(const std::string& section, const std::string& name, std::size_t tuples, int components, Value value) {
    if (section != section_) {
      close_section();
      header_ += fmt::format("      <{}>\n", section);
      section_ = section;
    }
    header_ += fmt::format(
        "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" "
        "offset=\"{}\"/>\n",
        vtk_type<Number>(), name, components, offset_);
    const std::uint64_t bytes = tuples * static_cast<std::uint64_t>(components) * sizeof(Number);
    offset_ += sizeof bytes + bytes;
    arrays_.push_back([=](std::string& text) {
      append_bytes(text, bytes);
      for (std::size_t tuple = 0; tuple < tuples; ++tuple) {
        for (int component = 0; component < components; ++component) {
          append_bytes(text, static_cast<Number>(value(tuple, component)));
        }
      }
    });
  }

  [[nodiscard]] std::string text() {
    close_section();
    std::string text = fmt::format(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"{}\" "
        "header_type=\"UInt64\">\n  <PolyData>\n    <Piece {} NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n{}"
        "    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">\n_",
        byte_order, counts_, header_);
    text.reserve(text.size() + offset_ + 64);
    for (const auto& append : arrays_) append(text);
    text += "\n  </AppendedData>\n</VTKFile>\n";
    return text;
  }

 private:
  template <class Number>
  static void append_bytes(std::string& text, Number number) {
    char bytes[sizeof number];
    std::memcpy(bytes, &number, sizeof number);
    text.append(bytes, sizeof number);
  }

  void close_section() {
    if (!section_.empty()) header_ += fmt::format("      </{}>\n", section_);
    section_.clear();
  }

  std::string counts_, header_, section_;
  std::uint64_t offset_ = 0;
  std::vector<std::function<void(std::string&)>> arrays_;
};

double component_of(Vec2 v, int component) {
  return component == 0 ? v.x : component == 1 ? v.y : 0.0;
}

std::string discs_text(const AssemblyState& state) {
  const Assembly& assembly = state.assembly;
  const std::size_t n = assembly.size();
  PolyData data(n, n, 0);
  const auto scalar = [&](const std::string& name, auto value) {
    data.declare<double>("PointData", name, n, 1, [value](std::size_t disc, int) { return value(disc); });
  };

  scalar("radius", [&](std::size_t disc) { return assembly.radii[disc]; });
  if (!assembly.cell_areas.empty()) {
    scalar("cell_area", [&](std::size_t disc) { return assembly.cell_areas[disc]; });
  }
  if (!state.motions.empty()) {
    data.declare<double>("PointData", "displacement", n, 3,
                         [&](std::size_t disc, int c) { return component_of(state.motions[disc].u, c); });
    scalar("rotation", [&](std::size_t disc) { return state.motions[disc].theta; });
  }
  if (!state.stresses.empty()) {
    scalar("stress_xx", [&](std::size_t disc) { return state.stresses[disc].xx; });
    scalar("stress_yy", [&](std::size_t disc) { return state.stresses[disc].yy; });
    scalar("stress_xy", [&](std::size_t disc) { return state.stresses[disc].xy; });
    scalar("stress_yx", [&](std::size_t disc) { return state.stresses[disc].yx; });
    scalar("mean_stress", [&](std::size_t disc) { return mean_stress(state.stresses[disc]); });
  }
  data.declare<double>("Points", "Points", n, 3,
                       [&](std::size_t disc, int c) { return component_of(assembly.centres[disc], c); });
  data.declare<std::int64_t>("Verts", "connectivity", n, 1, [](std::size_t disc, int) { return disc; });
  data.declare<std::int64_t>("Verts", "offsets", n, 1, [](std::size_t disc, int) { return disc + 1; });
  return data.text();
}

std::string contacts_text(const AssemblyState& state) {
  const Assembly& assembly = state.assembly;
  const std::size_t m = assembly.contacts.size();
  PolyData data(2 * m, 0, m);
  const auto end_of = [&](std::size_t point) {  // the disc at the first or second end of the line
    const Contact& contact = assembly.contacts[point / 2];
    return point % 2 == 0 ? contact.i : contact.j;
  };
  const auto scalar = [&](const std::string& name, auto value) {
    data.declare<double>("CellData", name, m, 1, [value](std::size_t contact, int) { return value(contact); });
  };

  data.declare<double>("PointData", "radius", 2 * m, 1, [](std::size_t, int) { return 0.0; });
  if (!state.motions.empty()) {
    data.declare<double>("PointData", "displacement", 2 * m, 3, [&, end_of](std::size_t point, int c) {
      return component_of(state.motions[end_of(point)].u, c);
    });
  }
  data.declare<std::int32_t>("CellData", "i", m, 1,
                             [&](std::size_t contact, int) { return assembly.contacts[contact].i; });
  data.declare<std::int32_t>("CellData", "j", m, 1,
                             [&](std::size_t contact, int) { return assembly.contacts[contact].j; });
  scalar("branch_length", [&](std::size_t contact) { return norm(assembly.branch(assembly.contacts[contact])); });
  if (!state.contact_forces.empty()) {
    scalar("normal_force", [&](std::size_t contact) { return state.contact_forces[contact].normal; });
    scalar("tangential_force", [&](std::size_t contact) { return state.contact_forces[contact].tangential; });
  }
  data.declare<double>("Points", "Points", 2 * m, 3, [&](std::size_t point, int c) {
    const Contact& contact = assembly.contacts[point / 2];
    const Vec2 start = assembly.centres[contact.i];
    return component_of(point % 2 == 0 ? start : start + assembly.branch(contact), c);
  });
  data.declare<std::int64_t>("Lines", "connectivity", 2 * m, 1, [](std::size_t point, int) { return point; });
  data.declare<std::int64_t>("Lines", "offsets", m, 1, [](std::size_t contact, int) { return 2 * (contact + 1); });
  return data.text();
}

std::string index_text(const std::string& discs, const std::string& contacts) {
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\" byte_order=\"{}\" "
      "header_type=\"UInt64\">\n  <vtkMultiBlockDataSet>\n"
      "    <DataSet index=\"0\" name=\"discs\" file=\"{}\"/>\n"
      "    <DataSet index=\"1\" name=\"contacts\" file=\"{}\"/>\n"
      "  </vtkMultiBlockDataSet>\n</VTKFile>\n",
      byte_order, escape_xml(discs), escape_xml(contacts));
}

}  // namespace

std::vector<std::filesystem::path> write_vtk(const std::filesystem::path& folder, const std::string& name,
                                             const AssemblyState& state, bool overwrite) {
  assert_consistent(state);
  const std::string discs = name + "_discs.vtp";
  const std::string contacts = name + "_contacts.vtp";
  const std::vector<std::filesystem::path> paths{folder / (name + ".vtm"), folder / discs, folder / contacts};
  for (const auto& path : paths) check_writable(path, overwrite);
  write_file(paths[1], discs_text(state), overwrite);
  write_file(paths[2], contacts_text(state), overwrite);
  write_file(paths[0], index_text(discs, contacts), overwrite);
  return paths;
}

}  // namespace equidem
