// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/xdmf.hpp"

#include "equidem/core/text.hpp"
#include "equidem/output/files/xml.hpp"

namespace equidem {
namespace {

/// \param shape "10 2"
std::string array(const XdmfSource& source, const std::string& name, const std::string& shape,
                  const std::string& number = "Float\" Precision=\"8") {
  return fmt::format(R"(<DataItem Format="HDF" NumberType="{}" Dimensions="{}">{}:/{}</DataItem>)", number, shape,
                     escape_xml(source.file), name);
}

/// The slab of one frame: start, stride and count along each axis.
std::string slab(const XdmfSource& source, const std::string& name, std::uint64_t frame, int components) {
  const std::uint64_t n = source.discs;
  if (components == 1) {
    return fmt::format(
        "<DataItem ItemType=\"HyperSlab\" Dimensions=\"{0}\"><DataItem Format=\"XML\" NumberType=\"Int\" "
        "Dimensions=\"3 2\">{1} 0 1 1 1 {0}</DataItem>{2}</DataItem>",
        n, frame, array(source, name, fmt::format("{} {}", source.room, n)));
  }
  // ParaView keeps the points of a frame under what it finds first in here, and reports an error where that is an
  // element.
  return fmt::format(
      "<DataItem ItemType=\"HyperSlab\" Dimensions=\"{0} 3\"><!--frame {1}-->"
      "<DataItem Format=\"XML\" NumberType=\"Int\" Dimensions=\"3 3\">{1} 0 0 1 1 1 1 {0} 3</DataItem>{2}</DataItem>",
      n, frame, array(source, name, fmt::format("{} {} 3", source.room, n)));
}

std::string attribute(const std::string& name, const char* type, const std::string& data) {
  return fmt::format("<Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Node\">{}</Attribute>\n", name, type, data);
}

}  // namespace

std::string xdmf_frame(const XdmfSource& source, std::uint64_t frame, double time) {
  const std::uint64_t n = source.discs;
  std::string text = fmt::format("<Grid Name=\"discs\" GridType=\"Uniform\"><Time Value=\"{}\"/>\n", time);
  text +=
      fmt::format("<Topology TopologyType=\"Polyvertex\" NodesPerElement=\"1\" NumberOfElements=\"{}\">{}</Topology>\n",
                  n, array(source, "discs/number", fmt::format("{} 1", n), "Int\" Precision=\"4"));
  text += source.travelling
              ? fmt::format("<Geometry GeometryType=\"XYZ\">{}</Geometry>\n", slab(source, "position", frame, 3))
              : fmt::format("<Geometry GeometryType=\"XY\">{}</Geometry>\n",
                            array(source, "discs/centre", fmt::format("{} 2", n)));
  text += attribute("radius", "Scalar", array(source, "discs/radius", fmt::format("{}", n)));
  for (const std::string& name : source.of_discs)
    text += attribute(name, "Scalar", array(source, "discs/" + name, fmt::format("{}", n)));
  for (const char* name : {source.travelling ? "position" : "displacement", "velocity"})
    text += attribute(name, "Vector", slab(source, name, frame, 3));
  for (const char* name : {source.travelling ? "angle" : "rotation", "spin"})
    text += attribute(name, "Scalar", slab(source, name, frame, 1));
  return text + "</Grid>\n";
}

std::string xdmf_text(const std::string& frames) {
  return "<?xml version=\"1.0\"?>\n<Xdmf Version=\"2.0\"><Domain>\n"
         "<Grid Name=\"frames\" GridType=\"Collection\" CollectionType=\"Temporal\">\n" +
         frames + "</Grid>\n</Domain></Xdmf>\n";
}

}  // namespace equidem
