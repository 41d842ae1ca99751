// SPDX-License-Identifier: GPL-3.0-or-later
#include "papers.hpp"

#include <memory>

#include <CLI/CLI.hpp>

#include "equidem/core/file.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"

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

void start_paper(const CommonOptions& options, const std::vector<std::string>& plots,
                 const std::vector<std::string>& files) {
  if (options.threads > 0) set_thread_count(options.threads);
  set_progress_shown(!options.quiet);
  const OutputPlan plan(options);
  plan.expect_json();
  for (const std::string& name : plots)
    for (const char* end : {".csv", ".gp", ".svg", ".png"}) plan.expect(name + end);
  for (const std::string& name : files) plan.expect(name);
  for (const char* name : {"report.txt", "result.json"}) plan.expect(name);
}

int finish_paper(const CommonOptions& options, const PaperResult& result) {
  std::string text = result.report;
  StageTimes times = result.times;
  if (options.out) {
    Stopwatch watch;
    write_file(*options.out / "report.txt", text, options.overwrite);
    for (const auto& [name, table] : result.tables) write_csv(*options.out / (name + ".csv"), table, options.overwrite);
    std::string failure;
    for (const auto& [name, plot] : result.plots) {
      const PlotResult written = write_plot(*options.out, name, plot, options.overwrite);
      if (!written.drawn) failure = written.message;
    }
    const std::string plots = counted(static_cast<long long>(result.plots.size()), "plot");
    text += "\n" + (failure.empty() ? fmt::format("{} in '{}'", plots, options.out->string()) : failure) + "\n";
    times.add("files", watch.lap());
  }
  JsonObject object;
  add_common(object, result.status, text, times, result.effects);
  object.set("paper", result.paper);
  result.add_numbers(object);
  deliver(options, text, object);
  if (options.out) say(options, fmt::format("written to {}", options.out->string()));
  return 0;
}

}  // namespace equidem
