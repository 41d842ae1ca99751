// SPDX-License-Identifier: GPL-3.0-or-later
#include "papers.hpp"

#include <memory>

#include <CLI/CLI.hpp>

#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

Run declare_with_quick(CLI::App& command, const std::string& footer,
                       int (*reproduce)(const CommonOptions& options, bool quick)) {
  struct Options {
    CommonOptions common;
    bool quick = false;
  };
  const auto options = std::make_shared<Options>();
  add_result_options(command, options->common);
  command.add_flag("--quick", options->quick, "a smaller computation: seconds or a minute instead of minutes or hours");
  command.footer(footer);
  return [options, reproduce] { return reproduce(options->common, options->quick); };
}

std::optional<FolderLock> start_paper(const CommonOptions& options, const std::vector<std::string>& plots,
                                      const std::vector<std::string>& files) {
  prepare(options);
  const OutputPlan plan(options);
  plan.expect_json();
  for (const std::string& name : plots) plan.expect_plot(name);
  for (const std::string& name : files) plan.expect(name);
  for (const char* name : {"report.txt", "result.json"}) plan.expect(name);
  return lock_out(options);
}

int finish_paper(const CommonOptions& options, const PaperResult& result) {
  const std::string& text = result.report;
  Results results, effects;
  add_effects(effects, result.effects);
  results.block(text).set("paper", result.paper).append(effects.hidden());
  result.add_numbers(results);
  std::vector<OutputPart> parts;
  if (options.out) {
    const std::filesystem::path& out = *options.out;
    parts.push_back({"report.txt", [&] { write_file(out / "report.txt", text, options.overwrite); }});
    for (const auto& made : result.texts)
      parts.push_back({made.first, [&] { write_file(out / made.first, made.second, options.overwrite); }});
    for (const auto& made : result.tables)
      parts.push_back({made.first, [&] { write_csv(out / (made.first + ".csv"), made.second, options.overwrite); }});
    for (const auto& made : result.plots)
      parts.push_back({made.first, [&] { write_plot(out, made.first, made.second, options.overwrite); }});
  }
  deliver(options, result.status, std::move(results), result.times, parts);
  return 0;
}

}  // namespace equidem
