// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/poly_data.hpp"

#include <bit>

#include "equidem/core/text.hpp"

namespace equidem {

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

std::string PolyData::text(const double* time) {
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
  text.reserve(text.size() + offset_ + 64);
  for (const auto& append : arrays_) append(text);
  text += "\n  </AppendedData>\n</VTKFile>\n";
  return text;
}

void PolyData::close_section() {
  if (!section_.empty()) header_ += fmt::format("      </{}>\n", section_);
  section_.clear();
}

}  // namespace equidem
