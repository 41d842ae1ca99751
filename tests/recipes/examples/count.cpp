// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include "equidem/casefile/assembly/build.hpp"

#include "command.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

void count_discs(const CommonOptions& common) {
  const Case resolved = read_case(common);
  const Assembly assembly = build_assembly(resolved);
  Results results;
  results.line("assembly").add("discs", "", assembly.size(), "disc", {Shown::count});
  deliver(common, "counted", results, {});
}

}  // namespace

Run declare_count(CLI::App& command) {
  const auto common = std::make_shared<CommonOptions>();
  add_common_options(command, *common);
  return [common] { return count_discs(*common); };
}

}  // namespace equidem
