// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/assembly.hpp"

#include <map>
#include <string>
#include <utility>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/files.hpp"
#include "equidem/assembly/touching.hpp"
#include "equidem/casefile/assembly/build.hpp"
#include "equidem/casefile/assembly/case.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/given.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/packing/packing.hpp"

#include "command.hpp"
#include "module.hpp"
#include "problem.hpp"

namespace equidem::python {
namespace {

using Shared = std::shared_ptr<Assembly>;

Shared shared(Assembly assembly) {
  return std::make_shared<Assembly>(std::move(assembly));
}

Vec2 row_of(const Floats& rows, py::ssize_t k) {
  return {rows.at(k, 0), rows.at(k, 1)};
}

using Period = std::optional<std::pair<double, double>>;

Assembly discs_at(const char* kind, const Floats& centres, const Floats& radii, const Period& period) {
  Assembly assembly;
  assembly.kind = kind;
  if (period) assembly.period = Vec2{period->first, period->second};
  for (py::ssize_t d = 0; d < centres.shape(0); ++d) assembly.centres.push_back(row_of(centres, d));
  assembly.radii.assign(radii.data(), radii.data() + radii.size());
  return assembly;
}

Shared from_arrays(const Floats& centres, const Floats& radii, const std::optional<Integers>& contacts,
                   const std::optional<Floats>& levers, const Period& period, double gap_tolerance) {
  if (centres.shape(0) == 0) bad_input("there are no discs", "an assembly has at least one", "Give their centres");
  Assembly assembly = discs_at("arrays", centres, radii, period);
  for (py::ssize_t c = 0; contacts && c < contacts->shape(0); ++c) {
    const bool shifted = contacts->shape(1) == 4;
    assembly.contacts.push_back({.i = contacts->at(c, 0),
                                 .j = contacts->at(c, 1),
                                 .shift_x = shifted ? contacts->at(c, 2) : 0,
                                 .shift_y = shifted ? contacts->at(c, 3) : 0});
  }
  return without_lock([&] {
    if (contacts) {
      const auto discs = static_cast<std::int32_t>(assembly.size());
      const auto exists = [&](std::int32_t disc) { return disc >= 0 && disc < discs; };
      for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
        Contact& contact = assembly.contacts[c];
        if (!exists(contact.i) || !exists(contact.j)) continue;  // check() names it
        const Vec2 given = levers ? row_of(*levers, static_cast<py::ssize_t>(c)) : Vec2{};
        const double half = 0.5 * norm(assembly.branch(contact));
        contact.lever_i = levers ? given.x : half;
        contact.lever_j = levers ? given.y : half;
      }
    } else {
      check(assembly);
      assembly.gap_tolerance = gap_tolerance;
      assembly.contacts = touching_discs(assembly, gap_tolerance);
      check_found_contacts(assembly);
    }
    check(assembly);
    measure_cells(assembly);
    return shared(std::move(assembly));
  });
}

/// Discs whose contacts are the edges of their triangulation.
Shared triangulated(const Floats& centres, const Floats& radii, const Period& period) {
  Assembly assembly = discs_at("delaunay", centres, radii, period);
  return without_lock([&] {
    triangulate(assembly);
    check(assembly);
    return shared(std::move(assembly));
  });
}

Shared from_text(std::string text) {
  return without_lock([&] {
    const Given<std::string> given("assembly", std::make_shared<const std::string>(std::move(text)));
    return shared(read_assembly(given.name()));
  });
}

/// The assembly with the columns of `rows`, one row for each contact, in two of its lists.
template <std::vector<double> Assembly::*first, std::vector<double> Assembly::*second>
Shared with_pairs(const Assembly& assembly, const Floats& rows) {
  Assembly result = assembly;
  (result.*first).clear();
  (result.*second).clear();
  for (py::ssize_t c = 0; c < rows.shape(0); ++c) {
    (result.*first).push_back(rows.at(c, 0));
    (result.*second).push_back(rows.at(c, 1));
  }
  check(result);
  return shared(std::move(result));
}

/// (m, 2): the forces at rest, N/m, or (0, 2).
py::array forces_of(const Assembly& assembly) {
  std::vector<Vec2> forces(assembly.contact_normal_force.size());
  for (std::size_t c = 0; c < forces.size(); ++c)
    forces[c] = {assembly.contact_normal_force[c], assembly.contact_tangential_force[c]};
  const auto owner = std::make_shared<const std::vector<Vec2>>(std::move(forces));
  return columns_of(owner, *owner, &Vec2::x, 2);
}

py::array normals_of(const Assembly& assembly) {
  std::vector<Vec2> normals(assembly.contacts.size());
  for (std::size_t c = 0; c < normals.size(); ++c) normals[c] = frame_of(assembly, c).normal;
  const auto owner = std::make_shared<const std::vector<Vec2>>(std::move(normals));
  return columns_of(owner, *owner, &Vec2::x, 2);
}

/// (n, 4): xx, xy, yx, yy
py::array stresses_of(const Assembly& assembly, const Floats& forces) {
  std::vector<ContactForce> on_i;
  for (py::ssize_t c = 0; c < forces.shape(0); ++c)
    on_i.push_back({.normal = forces.at(c, 0), .tangential = forces.at(c, 1)});
  const auto owner = std::make_shared<const std::vector<Tensor2>>(disc_stresses(assembly, on_i));
  return columns_of(owner, *owner, &Tensor2::xx, 4);
}

py::dict groups_of(const Shared& assembly) {
  py::dict result;
  for (const auto& [name, group] : assembly->groups)
    result[py::str(name)] =
        view(assembly, group.discs.data(), {py::ssize_t(group.discs.size())}, {sizeof(std::int32_t)});
  return result;
}

template <std::vector<double> Assembly::*numbers>
py::array numbers_of(const Shared& assembly) {
  const std::vector<double>& values = (*assembly).*numbers;
  return view(assembly, values.data(), {py::ssize_t(values.size())}, {sizeof(double)});
}

/// Discs of these radii in a box, in this order: (the network of their contacts, measures).
/// \param settling numbers of SettlingOptions by their names
py::tuple pack_discs(const Floats& radii, std::pair<double, double> box, const std::string& method,
                     const std::string& sides, std::uint64_t seed, double overlap, std::int64_t attempts,
                     const std::map<std::string, double>& settling) {
  PackingOptions options;
  options.method = enum_from<PackingMethod>(method);
  options.box = {{box.first, box.second}, enum_from<PackingBox::Sides>(sides)};
  options.radii.assign(radii.data(), radii.data() + radii.size());
  options.seed = seed;
  options.as_dense_as_possible = true;
  options.overlap = overlap;
  options.attempts = attempts;
  SettlingOptions& fall = options.settling;
  for (const auto& [name, number] : {std::pair{"kN", &fall.springs.kN},
                                     {"kT", &fall.springs.kT},
                                     {"damping", &fall.damping},
                                     {"friction", &fall.friction},
                                     {"wall_friction", &fall.wall_friction},
                                     {"unbalanced", &fall.rest},
                                     {"longest", &fall.longest}})
    if (const auto given = settling.find(name); given != settling.end()) *number = given->second;
  PackingMeasures measures;
  double seconds = 0;
  Shared network = without_lock([&] {
    const GrainPacking packing = pack(options);
    measures = measure(packing);
    seconds = packing.seconds;
    return shared(with_cells(network_of(packing, {})));
  });
  py::dict found;
  found["solid_fraction"] = measures.solid_fraction;
  found["coordination_number"] = measures.coordination;
  found["coordination_number_without_rattlers"] = measures.coordination_without_rattlers;
  found["rattlers"] = measures.rattlers;
  found["largest_overlap"] = measures.largest_overlap;
  found["seconds"] = seconds;
  return py::make_tuple(std::move(network), found);
}

}  // namespace

void bind_assembly(py::module_& module) {
  py::class_<Assembly, Shared>(module, "Assembly", made_here())
      .def_property_readonly("kind", [](const Assembly& a) { return a.kind; })
      .def("__len__", &Assembly::size)
      .def_property_readonly("centres", [](const Shared& a) { return columns_of(a, a->centres, &Vec2::x, 2); })
      .def_property_readonly("radii", numbers_of<&Assembly::radii>)
      .def_property_readonly("cell_areas", numbers_of<&Assembly::cell_areas>)
      .def_property_readonly("facet_lengths", numbers_of<&Assembly::facet_lengths>)
      .def_property_readonly("contacts", [](const Shared& a) { return columns_of(a, a->contacts, &Contact::i, 2); })
      .def_property_readonly("shifts", [](const Shared& a) { return columns_of(a, a->contacts, &Contact::shift_x, 2); })
      .def_property_readonly("levers", [](const Shared& a) { return columns_of(a, a->contacts, &Contact::lever_i, 2); })
      .def_property_readonly("normals", normals_of)
      .def_property_readonly("period",
                             [](const Assembly& a) -> Period {
                               if (!a.period) return {};
                               return std::pair(a.period->x, a.period->y);
                             })
      .def_property_readonly("area", &Assembly::area)
      .def_property_readonly("solid_fraction", &Assembly::solid_fraction)
      .def_property_readonly("coordination_number", &Assembly::coordination_number)
      .def_property_readonly("groups", groups_of)
      .def_property_readonly("forces", forces_of)
      .def("with_springs", with_pairs<&Assembly::contact_kN, &Assembly::contact_kT>)
      .def("with_strengths", with_pairs<&Assembly::contact_tension, &Assembly::contact_shear>)
      .def("with_forces", with_pairs<&Assembly::contact_normal_force, &Assembly::contact_tangential_force>)
      .def("disc_stresses", stresses_of)
      .def("json", json_of);

  module.def("from_arrays", from_arrays);
  module.def("from_json", from_text);
  module.def("triangulated", triangulated);
  module.def("pack_discs", pack_discs);
  module.def("build_assembly", [](const std::string& case_text) {
    return without_lock([&] { return shared(build_assembly(parse_case(case_text, "case#0", {}))); });
  });
  module.def("read_assembly", [](const std::filesystem::path& path, double gap_tolerance, std::string unit_of_length,
                                 std::optional<std::int64_t> frame, std::optional<std::filesystem::path> contacts,
                                 std::optional<bool> periodic_box, const Period& period, const std::string& plane) {
    const AssemblyFileOptions options{
        .gap_tolerance = gap_tolerance,
        .unit_of_length = std::move(unit_of_length),
        .frame = frame,
        .contacts = std::move(contacts),
        .plane = enum_from<SamplePlane>(plane),
        .periodic_box = periodic_box,
        .period = period ? std::optional(Vec2{period->first, period->second}) : std::nullopt};
    return without_lock([&] { return shared(read_assembly(path, options)); });
  });
  module.def("write_assembly", [](const std::filesystem::path& path, const Assembly& assembly, bool overwrite) {
    without_lock([&] { write_assembly(path, assembly, overwrite); });
  });
}

}  // namespace equidem::python
