// SPDX-License-Identifier: GPL-3.0-or-later
#include "state_files.hpp"

#include <cstddef>
#include <filesystem>
#include <system_error>
#include <tuple>

#include "equidem/assembly/files.hpp"
#include "equidem/output/files/vtk.hpp"

namespace equidem {

std::vector<ResultArray> motion_arrays(const std::string& prefix,
                                       const std::shared_ptr<const std::vector<DiscMotion>>& owner) {
  constexpr std::size_t stride = sizeof(DiscMotion) / sizeof(double);
  static_assert(sizeof(DiscMotion) == 3 * sizeof(double));
  const auto* first = reinterpret_cast<const double*>(owner->data());
  return {{prefix + "displacements", "m", owner, first, owner->size(), 2, stride},
          {prefix + "rotations", "rad", owner, first + 2, owner->size(), 1, stride}};
}

std::vector<ResultArray> state_arrays(const std::string& prefix,
                                      const std::shared_ptr<const Equilibrium>& equilibrium) {
  const auto& [motions, contact_forces] = std::tie(equilibrium->motions, equilibrium->contact_forces);
  std::vector<ResultArray> arrays = motion_arrays(prefix, {equilibrium, &motions});
  arrays.push_back(array_of(prefix + "contact_forces", "N/m",
                            std::shared_ptr<const std::vector<ContactForce>>(equilibrium, &contact_forces), 2));
  if (const auto& bending = equilibrium->bending_moments; !bending.empty()) {
    arrays.push_back(array_of(prefix + "bending_moments", "N",
                              std::shared_ptr<const std::vector<double>>(equilibrium, &bending), 1));
  }
  std::vector<std::int32_t> discs;
  std::vector<Vec2> forces;
  std::vector<double> moments;
  for (const Reaction& reaction : equilibrium->reactions) {
    discs.push_back(reaction.disc);
    forces.push_back(reaction.force);
    moments.push_back(reaction.moment);
  }
  const auto owner = std::make_shared<const std::vector<std::int32_t>>(std::move(discs));
  arrays.push_back({prefix + "supported_discs", "", owner, owner->data(), owner->size()});
  arrays.push_back(array_of(prefix + "reactions", "N/m", std::move(forces), 2));
  arrays.push_back(array_of(prefix + "reaction_moments", "N", std::move(moments), 1));
  return arrays;
}

std::vector<std::string> state_names(const OutputCase& wanted, const std::string& suffix) {
  std::vector<std::string> names;
  if (wanted.csv)
    for (const char* stem : {"discs", "contacts"}) names.push_back(stem + suffix + ".csv");
  if (wanted.vtk)
    for (const char* end : {".vtm", "_discs.vtp", "_contacts.vtp"}) names.push_back("state" + suffix + end);
  if (wanted.picture)
    for (const char* end : {".svg", ".png"}) names.push_back("picture" + suffix + end);
  return names;
}

void remove_files(const CommonOptions& options, const std::vector<std::string>& names) {
  std::error_code ignored;
  for (const std::string& name : names) std::filesystem::remove(*options.out / name, ignored);
}

void write_state(const CommonOptions& options, const OutputCase& wanted, const std::string& suffix,
                 const AssemblyState& state) {
  if (options.pictures_only) return;
  if (wanted.csv) {
    write_disc_csv(*options.out / ("discs" + suffix + ".csv"), state, options.overwrite);
    write_contact_csv(*options.out / ("contacts" + suffix + ".csv"), state, options.overwrite);
  }
  if (wanted.vtk) write_vtk(*options.out, "state" + suffix, state, options.overwrite);
}

double bytes_of_state_picture(const CommonOptions& options, const OutputCase& wanted, const Assembly& assembly) {
  return options.out && wanted.picture ? bytes_of_picture(assembly) : 0;
}

void write_state_picture(const CommonOptions& options, const OutputCase& wanted, const std::string& suffix,
                         const AssemblyState& state, const PictureOptions& picture) {
  if (wanted.picture) write_picture(*options.out, "picture" + suffix, state, picture, options.overwrite);
}

OutputPart assembly_part(const OutputCase& wanted, const std::function<const Assembly&()>& assembly) {
  OutputPart part{"the assembly", [](const CommonOptions& /*into*/) {}};
  if (!wanted.assembly) return part;
  part.files = {assembly_file_name("assembly", *wanted.assembly)};
  part.write = [=, name = part.files.front()](const CommonOptions& into) {
    write_assembly(*into.out / name, assembly(), into.overwrite);
  };
  return part;
}

}  // namespace equidem
