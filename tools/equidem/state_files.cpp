// SPDX-License-Identifier: GPL-3.0-or-later
#include "state_files.hpp"

#include <filesystem>
#include <system_error>
#include <vector>

#include "equidem/assembly/files.hpp"
#include "equidem/output/files/body_tables.hpp"
#include "equidem/output/files/vtk.hpp"

namespace equidem {

namespace {

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

}  // namespace

void expect_state(const OutputPlan& plan, const OutputCase& wanted, const std::string& suffix) {
  for (const std::string& name : state_names(wanted, suffix)) plan.expect(name);
}

void remove_state(const CommonOptions& options, const OutputCase& wanted, const std::string& suffix) {
  std::error_code ignored;
  for (const std::string& name : state_names(wanted, suffix)) std::filesystem::remove(*options.out / name, ignored);
}

void write_state(const CommonOptions& options, const OutputCase& wanted, const std::string& suffix,
                 const AssemblyState& state) {
  if (wanted.csv) {
    write_disc_csv(*options.out / ("discs" + suffix + ".csv"), state, options.overwrite);
    write_contact_csv(*options.out / ("contacts" + suffix + ".csv"), state, options.overwrite);
  }
  if (wanted.vtk) write_vtk(*options.out, "state" + suffix, state, options.overwrite);
}

void write_state_picture(const CommonOptions& options, const OutputCase& wanted, const std::string& suffix,
                         const AssemblyState& state, const PictureOptions& picture) {
  if (wanted.picture) write_picture(*options.out, "picture" + suffix, state, picture, options.overwrite);
}

void expect_assembly(const OutputPlan& plan, const OutputCase& wanted) {
  if (wanted.assembly) plan.expect(assembly_file_name("assembly", *wanted.assembly));
}

void write_assembly(const CommonOptions& options, const OutputCase& wanted, const Assembly& assembly) {
  if (!wanted.assembly) return;
  write_assembly(*options.out / assembly_file_name("assembly", *wanted.assembly), assembly, options.overwrite);
}

}  // namespace equidem
