// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The page and the report.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <set>

#include "equidem/core/text.hpp"

#include "machine.hpp"
#include "validation/validation.hpp"

namespace equidem::validation {
namespace {

/// "0.6601 ± 0.0012": two digits of the error; without an error ten digits.
std::string shown(const Estimate& estimate) {
  if (!(estimate.error > 1e-11 * std::abs(estimate.value))) return fmt::format("{:.10g}", estimate.value);
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(estimate.error))), 0, 12);
  return fmt::format("{:.{}f} ± {:.{}f}", estimate.value, decimals, estimate.error, decimals);
}

std::string row(const std::vector<std::string>& cells) {
  return "| " + joined(cells, " | ") + " |\n";
}

std::string head(const std::vector<std::string>& cells) {
  return row(cells) + row(std::vector<std::string>(cells.size(), "---"));
}

std::string command(const std::string& only, bool quick) {
  return "equidem-papers validation" + only + (quick ? " --quick" : "") + " --out DIR";
}

std::string seconds_text(double seconds) {
  return seconds < 1 ? "under a second" : fmt::format("{:.0f} s", seconds);
}

std::string section_text(const Section& section, bool quick) {
  const Findings& findings = section.findings;
  std::string text = fmt::format("## {}\n\n{}\n\n", section.item->heading, findings.text);
  for (const auto& [name, plot] : findings.plots) text += fmt::format("![{}](validation/{}.svg)\n\n", plot.title, name);
  if (!findings.comparisons.empty()) {
    text += head({"", "published", "source", "ours", "within the error"});
    for (const Comparison& c : findings.comparisons)
      text += row({c.quantity, shown(c.theirs), c.source, shown(c.ours), c.verdict()});
    text += "\n";
  }
  if (!findings.trends.empty()) {
    text += head({"statement", "source", "ours", ""});
    for (const Trend& trend : findings.trends)
      text += row({trend.statement, trend.source, trend.evidence, trend.holds ? "holds" : "**does not hold**"});
    text += "\n";
  }
  for (const std::string& note : findings.notes) text += note + "\n\n";
  return text + fmt::format("`{}`: {}.\n\n", command(fmt::format(" --only {}", section.item->name), quick),
                            seconds_text(section.seconds));
}

/// Keys of the sources that a section uses, each once.
std::vector<std::string> sources_of(const Section& section) {
  std::vector<std::string> used;
  const auto use = [&](const std::string& source) {
    if (std::find(used.begin(), used.end(), source) == used.end()) used.push_back(source);
  };
  for (const Comparison& c : section.findings.comparisons) use(c.source);
  for (const Trend& t : section.findings.trends) use(t.source);
  return used;
}

std::string summary(const std::vector<Section>& sections) {
  std::string text = head({"", "compared", "agree or hold", "source"});
  for (const Section& section : sections) {
    std::string anchor = section.item->heading;
    std::replace(anchor.begin(), anchor.end(), ' ', '-');
    std::transform(anchor.begin(), anchor.end(), anchor.begin(), [](unsigned char c) { return std::tolower(c); });
    text += row({fmt::format("[{}](#{})", section.item->heading, anchor), fmt::format("{}", section.statements()),
                 fmt::format("{}", section.agreements()), joined(sources_of(section))});
  }
  return text;
}

}  // namespace

std::size_t Section::statements() const {
  return findings.comparisons.size() + findings.trends.size();
}

std::size_t Section::agreements() const {
  return static_cast<std::size_t>(
      std::count_if(findings.comparisons.begin(), findings.comparisons.end(), std::mem_fn(&Comparison::agrees)) +
      std::count_if(findings.trends.begin(), findings.trends.end(), std::mem_fn(&Trend::holds)));
}

std::string page(const std::vector<Section>& sections, bool quick) {
  double seconds = 0;
  for (const Section& section : sections) seconds += section.seconds;
  std::string text = fmt::format(
      "# Validation\n\nNumbers that others have published, beside those of this program with their standard errors; "
      "written by\n\n    {}\n\nin {} on {}, into DIR/validation.md; DIR holds the figures (SVG, PNG), the numbers "
      "behind them (CSV) and all comparisons (comparisons.csv). Nothing is fitted to the published numbers; where a "
      "size dependence is removed with a published exponent, the text says so.\n\nA number *agrees* where the "
      "difference is at most 2.6 standard errors, ours and the published one together, which a true value exceeds "
      "once in a hundred times. Where a published relation leaves out something of known size (the overlap left at "
      "jamming, the turn of a normal in a contact of finite duration), that is allowed for. Where the two differ, "
      "the reason stands beside them.\n\n",
      command("", quick), seconds_text(seconds), this_machine().text());
  text += summary(sections) + "\n";
  for (const Section& section : sections) text += section_text(section, quick);
  text += "## Sources\n\n";
  std::set<std::string> used;
  for (const Section& section : sections) {
    for (const std::string& source : sources_of(section)) used.insert(source);
  }
  for (const Source& source : sources()) {
    if (used.contains(source.key)) text += fmt::format("- **{}**: {}.\n", source.key, source.text);
  }
  return text;
}

std::string report(const std::vector<Section>& sections) {
  std::string text;
  for (const Section& section : sections) {
    text += fmt::format("{}: {} of {} agree or hold, {}\n", section.item->heading, section.agreements(),
                        section.statements(), seconds_text(section.seconds));
    for (const Comparison& c : section.findings.comparisons)
      text += fmt::format("  {}: {} ({}), ours {}, {}\n", c.quantity, shown(c.theirs), c.source, shown(c.ours),
                          c.verdict());
    for (const Trend& t : section.findings.trends)
      text +=
          fmt::format("  {} ({}): {}; {}\n", t.statement, t.source, t.holds ? "holds" : "DOES NOT HOLD", t.evidence);
    text += "\n";
  }
  return text;
}

}  // namespace equidem::validation
