// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem export: the model of a case as input of another program.
#include <memory>

#include <CLI/CLI.hpp>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/export/engine_model.hpp"

#include "command.hpp"
#include "export/formats.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

int export_case(const ExportOptions& options) {
  prepare(options);
  const ExportFormat& format = entry_named(export_formats, options.to, "format of --to");
  if (!options.out && !options.dry_run)
    bad_input("export without --out", "its files need a folder", "Name one: --out DIR");
  const OutputPlan plan(options);
  plan.expect_results();
  const auto lock = lock_out(options);
  Exported made = format.make(options);
  for (const ExportedFile& file : made.files) plan.expect(file.name);
  made.results.line("files", joined(made.files, &ExportedFile::name)).set("format", format.name);
  if (options.dry_run) {
    deliver(options, "dry_run", made.results, made.times);
    return 0;
  }
  std::vector<OutputPart> parts{{"case.toml", [&] { made.write_case(options); }}};
  for (const ExportedFile& file : made.files)
    parts.push_back({file.name, [&] { write_file(*options.out / file.name, file.text(), options.overwrite); }});
  deliver(options, "done", made.results, made.times, parts);
  return 0;
}

}  // namespace

Run declare_export(CLI::App& command) {
  const auto options = std::make_shared<ExportOptions>();
  add_common_options(command, *options);
  command.add_option("--to", options->to, "the program or format: " + help_of(export_formats))
      ->required()
      ->type_name("FORMAT");
  command
      .add_option("--accept", options->accept,
                  fmt::format("export this although the program computes it otherwise, as its refusal says: {}",
                              joined(acceptable_features(), ", ")))
      ->type_name("WHAT")
      ->allow_extra_args(false);
  command.footer(
      "Examples:\n"
      "  equidem export data/cases/abe1996_fig6.toml --to lammps --out tension      then lmp -in in.equidem\n"
      "  equidem export data/cases/delaunay_tension.toml --to yade --out tension    then yade run_equidem.py\n"
      "  equidem export data/cases/grains_cradle.toml --set collisions.law=linear_dashpot --to yade --out cradle\n"
      "  equidem export data/cases/cantilever.toml --to matrix-market --out beam");
  return [options] { return export_case(*options); };
}

}  // namespace equidem
