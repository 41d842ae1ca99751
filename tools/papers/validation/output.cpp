// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Files, JSON and command line.
#include <algorithm>
#include <memory>

#include <CLI/CLI.hpp>

#include "equidem/core/text.hpp"

#include "tables.hpp"
#include "validation/validation.hpp"

namespace equidem::validation {
namespace {

struct Options {
  CommonOptions common;
  bool quick = false;
  std::vector<std::string> only;

  [[nodiscard]] bool wanted(const Item& item) const {
    return only.empty() || std::find(only.begin(), only.end(), item.name) != only.end();
  }
};

std::string file_of_table(const std::string& name) {
  return name + "_values";
}

Table comparisons_table(const std::vector<Section>& sections) {
  struct Row {
    std::string item;
    Comparison comparison;
  };
  std::vector<Row> rows;
  for (const Section& section : sections) {
    for (const Comparison& comparison : section.findings.comparisons) rows.push_back({section.item->name, comparison});
  }
  Table table;
  table.add("item", rows, &Row::item);
  table.add("quantity", rows, [](const Row& r) { return r.comparison.quantity; });
  table.add("published", rows, [](const Row& r) { return r.comparison.theirs.value; });
  table.add("published_error", rows, [](const Row& r) { return r.comparison.theirs.error; });
  table.add("source", rows, [](const Row& r) { return r.comparison.source; });
  table.add("ours", rows, [](const Row& r) { return r.comparison.ours.value; });
  table.add("standard_error", rows, [](const Row& r) { return r.comparison.ours.error; });
  table.add("verdict", rows, [](const Row& r) { return r.comparison.verdict(); });
  return table;
}

Results json_of(const Section& section) {
  std::vector<Results> comparisons, trends;
  for (const Comparison& c : section.findings.comparisons) {
    Results one;
    one.set("quantity", c.quantity).set("published", c.theirs.value).set("published_error", c.theirs.error);
    one.set("source", c.source).set("ours", c.ours.value).set("standard_error", c.ours.error);
    one.set("agrees", c.agrees()).set("verdict", c.verdict());
    comparisons.push_back(one);
  }
  for (const Trend& t : section.findings.trends) {
    Results one;
    one.set("statement", t.statement).set("source", t.source).set("holds", t.holds).set("evidence", t.evidence);
    trends.push_back(one);
  }
  Results object;
  object.set("item", section.item->name).set("seconds", section.seconds);
  object.set("comparisons", comparisons).set("trends", trends);
  return object;
}

int validate(const Options& options) {
  std::vector<std::string> plots, files{"validation.md", "comparisons.csv"};
  for (const Item& item : items()) {
    if (!options.wanted(item)) continue;
    plots.insert(plots.end(), item.plots.begin(), item.plots.end());
    for (const std::string& table : item.tables) files.push_back(file_of_table(table) + ".csv");
  }
  const auto lock = start_paper(options.common, plots, files);
  std::vector<Section> sections;
  PaperResult result{.paper = "validation",
                     .report = {},
                     .times = {},
                     .effects = derive_effects(ContactSprings({1, 0}), Rotation::from_scene),
                     .add_numbers = {}};
  for (const Item& item : items()) {
    if (!options.wanted(item)) continue;
    Stopwatch watch;
    sections.push_back({&item, item.compute(options.quick), 0});
    sections.back().seconds = watch.lap();
    result.times.add(item.name, sections.back().seconds);
    for (const auto& [name, table] : sections.back().findings.tables)
      result.tables.emplace_back(file_of_table(name), table);
    for (const auto& plot : sections.back().findings.plots) result.plots.push_back(plot);
  }
  result.report = report(sections);
  result.tables.emplace_back("comparisons", comparisons_table(sections));
  result.texts = {{"validation.md", page(sections, options.quick)}};
  result.add_numbers = [&](Results& object) {
    std::vector<Results> all;
    for (const Section& section : sections) all.push_back(json_of(section));
    object.set("quick", options.quick).set("items", all);
  };
  return finish_paper(options.common, result);
}

}  // namespace

Run declare(CLI::App& command) {
  const auto options = std::make_shared<Options>();
  add_result_options(command, options->common);
  command.add_flag("--quick", options->quick, "smaller cells and fewer seeds: under a minute");
  const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Item& item : items()) all.emplace_back(item.name);
    return all;
  }();
  command.add_option("--only", options->only, "items to compute, of " + joined(names))->check(CLI::IsMember(names));
  command.footer(
      "Numbers that others have published (rigidity, adsorption, jamming, friction, impacts, LAMMPS, a point "
      "load,\nmoduli), computed again, with error bars and verdicts.");
  return [options] { return validate(*options); };
}

}  // namespace equidem::validation
