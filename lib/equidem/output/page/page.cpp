// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/page/page.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>
#include <variant>

#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/vtk.hpp"
#include "equidem/output/page/answers.hpp"

namespace equidem {
namespace {

constexpr std::size_t most_text_bytes = 100'000;  ///< of the case and of the report

/// Marks of lines of the report that a reader must not miss.
constexpr std::array<std::string_view, 11> marks{"WARNING",          "UNSTABLE",     "NOT FEASIBLE", "NOT CONVERGED",
                                                 "NOT TOLD APART",   "BROKEN",       "ASSUMED",      "that is much",
                                                 "units than meant", "Pa are meant", "INCOMPLETE"};

std::string text_of(const Results& results, const char* path) {
  const Result* found = find_result(results, path);
  const auto* text = found != nullptr ? std::get_if<std::string>(&found->value.value) : nullptr;
  return text != nullptr ? *text : "";
}

/// Words with one space between them.
std::string one_paragraph(const std::string& text) {
  std::string paragraph;
  for (const char c : text) {
    const bool space = c == ' ' || c == '\n';
    if (!space || (!paragraph.empty() && paragraph.back() != ' ')) paragraph += space ? ' ' : c;
  }
  if (paragraph.ends_with(' ')) paragraph.pop_back();
  return paragraph;
}

/// The lines of the report with a mark, without the columns and breaks of the report.
std::vector<std::string> warnings_of(const Results& results) {
  std::vector<Results> lines(1);
  std::vector<std::string> found;
  for (const Result& part : results.parts()) {
    if (part.hidden || part.part == Result::Part::table || part.part == Result::Part::list) continue;
    if (part.part == Result::Part::line || part.part == Result::Part::block) lines.emplace_back();
    Results& line = lines.back();
    switch (part.part) {
      case Result::Part::line:
        line.line(part.label == "failed" ? "WARNING, failed:" : part.label);
        break;
      case Result::Part::note:
        line.note(part.label);
        break;
      case Result::Part::block:
        line.block(part.label);
        break;
      case Result::Part::value:
        line.add("", part.label, part.value, part.unit, part.shown);
        break;
      case Result::Part::table:
      case Result::Part::list:
        break;
    }
  }
  for (const Results& line : lines) {
    const std::string text = one_paragraph(line.report());
    for (const std::string_view mark : marks) {
      if (text.find(mark) == std::string::npos) continue;
      found.push_back(text);
      break;
    }
  }
  return found;
}

std::string section(const std::string& name, const std::string& heading, const std::string& content) {
  if (content.empty()) return {};
  return fmt::format(
      "<section id=\"{0}\" aria-labelledby=\"{0}-heading\">\n<h2 id=\"{0}-heading\">{1}</h2>\n{2}</section>\n", name,
      heading, content);
}

std::string value_html(const Answer& answer) {
  return fmt::format(
      "<data value=\"{}\">{}</data>{}", answer.value, answer.text,
      answer.unit.empty() ? "" : fmt::format(" <span class=\"unit\">{}</span>", escape_xml(answer.unit)));
}

std::string answers_html(const Answers& answers) {
  std::string html = "<dl class=\"answers\">\n";
  for (const Answer& answer : answers.main) {
    html += fmt::format("<div><dt>{}</dt><dd>{}{}</dd></div>\n", escape_xml(answer.label), value_html(answer),
                        answer.error.empty() ? "" : fmt::format("<span class=\"error\">{}</span>", answer.error));
  }
  html += "</dl>\n";
  if (answers.quality.empty()) return html;
  html += "<dl class=\"quality\">\n";
  for (const Answer& answer : answers.quality)
    html += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", escape_xml(answer.label), value_html(answer));
  return html + "</dl>\n";
}

/// Advice, and the tables of a report that are its answer.
std::string tables_html(const Results& results) {
  std::string html;
  const Result* advice = find_result(results, "advice");
  const auto* lines = advice != nullptr ? std::get_if<std::vector<std::string>>(&advice->value.value) : nullptr;
  for (const std::string& line : lines != nullptr ? *lines : std::vector<std::string>{})
    html += fmt::format("<p>{}</p>\n", escape_xml(line));
  for (const Result& part : results.parts()) {
    if (part.part != Result::Part::table) continue;
    const Results table = Results().table("", *std::get<std::shared_ptr<const std::vector<Results>>>(part.value.value));
    html += fmt::format("<pre class=\"table\" tabindex=\"0\">{}</pre>\n", escape_xml(table.report()));
  }
  return html;
}

std::string trust_html(const std::vector<TrustCheck>& checks) {
  if (checks.empty()) return {};
  constexpr std::array<std::pair<const char*, const char*>, 3> looks{{{"good", "✓"}, {"doubtful", "!"}, {"bad", "✗"}}};
  std::string html = "<ul class=\"trust\">\n";
  for (const TrustCheck& check : checks) {
    const auto& [name, sign] = looks[static_cast<std::size_t>(check.verdict)];
    html += fmt::format(
        "<li class=\"{0}\"><span class=\"sign\" role=\"img\" aria-label=\"{0}\">{1}</span> <b>{2}</b> <span "
        "class=\"found\">{3}</span>{4}</li>\n",
        name, sign, escape_xml(check.name), escape_xml(check.found),
        check.advice.empty() ? "" : fmt::format("<em>{}</em>", escape_xml(check.advice)));
  }
  return html + "</ul>\n";
}

std::string effects_html(const Results& results) {
  std::string html;
  const Result* active = find_result(results, "effects/active");
  const auto* names = active != nullptr ? std::get_if<std::vector<std::string>>(&active->value.value) : nullptr;
  if (names != nullptr && !names->empty()) {
    html += "<ul class=\"active\">\n";
    for (const std::string& name : *names) html += fmt::format("<li>{}</li>\n", escape_xml(name));
    html += "</ul>\n";
  }
  const Result* inactive = find_result(results, "effects/inactive");
  const auto* reasons =
      inactive != nullptr ? std::get_if<std::shared_ptr<const Results>>(&inactive->value.value) : nullptr;
  if (reasons == nullptr || (*reasons)->parts().empty()) return html;
  html += "<table><caption>Not active, and why</caption>\n";
  for (const Result& reason : (*reasons)->parts()) {
    const auto* why = std::get_if<std::string>(&reason.value.value);
    html += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", escape_xml(reason.key),
                        why != nullptr ? escape_xml(*why) : "");
  }
  return html + "</table>\n";
}

std::string folded(const std::string& summary, std::string text) {
  if (text.empty()) return {};
  if (text.size() > most_text_bytes) {
    std::size_t end = most_text_bytes;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0U) == 0x80U) --end;
    text.resize(end);
    text += "\n...";
  }
  return fmt::format("<details><summary>{}</summary>\n<pre tabindex=\"0\">{}</pre>\n</details>\n", summary,
                     escape_xml(text));
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(4 * (bytes.size() / 3 + 1));
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - at);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[at + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? digits[group >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

/// An image element that holds the bytes of the file.
std::string image_of(const DrawnFigure& figure) {
  const bool vector = figure.file.extension() == ".svg";
  return fmt::format("<img alt=\"{}\" src=\"data:image/{};base64,{}\">", escape_xml(figure.title),
                     vector ? "svg+xml" : "png", base64(read_file(figure.file)));
}

/// \param room bytes
std::string figures_html(const std::vector<DrawnFigure>& figures, std::size_t room) {
  std::string html, missing;
  std::size_t used = 0;
  for (const DrawnFigure& figure : figures) {
    if (!figure.player.empty()) continue;
    if (!figure.missing.empty()) {
      missing += fmt::format("<li>{}: {}</li>\n", escape_xml(figure.name), escape_xml(figure.missing));
      continue;
    }
    const std::string image = image_of(figure);
    used += image.size();
    if (used > room) {
      used -= image.size();
      missing += fmt::format("<li>{}: no room is left on this page; its files hold it</li>\n", escape_xml(figure.name));
      continue;
    }
    html += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", image, escape_xml(figure.title));
  }
  if (!html.empty()) html = fmt::format("<div class=\"figures\">\n{}</div>\n", html);
  return missing.empty() ? html : fmt::format("{}<ul class=\"missing\">\n{}</ul>\n", html, missing);
}

std::string players_html(const std::vector<DrawnFigure>& figures) {
  std::string html;
  for (const DrawnFigure& figure : figures) html += figure.player;
  return html;
}

std::string repeat_html(const ResultPage& page) {
  std::string html = fmt::format("<pre class=\"command\" tabindex=\"0\">{}</pre>\n", escape_xml(page.command));
  if (!page.case_text.empty() && page.verb != "sweep" && page.verb != "study")
    html += fmt::format("<p>or, with the case above as <code>case.toml</code>: <code>equidem {} case.toml</code></p>\n",
                        page.verb);
  return html;
}

}  // namespace

std::string result_page_html(const ResultPage& page) {
  const std::string title = text_of(page.results, "title");
  const std::string heading = title.empty() ? "equidem " + page.verb : title;
  std::vector<std::string> warnings;
  for (std::string& line : warnings_of(page.results)) warnings.push_back(std::move(line));
  if (page.status == "unstable" && warnings.empty())
    warnings.emplace_back("UNSTABLE: any disturbance would grow: this is no state of rest");
  std::string warning_list;
  for (const std::string& line : warnings) warning_list += fmt::format("<p>{}</p>\n", escape_xml(line));
  if (!warning_list.empty())
    warning_list =
        fmt::format("<div class=\"warnings\" role=\"note\" aria-label=\"Warnings\">\n{}</div>\n", warning_list);

  const bool table = page.verb == "sweep" || page.verb == "study";
  std::string body = warning_list;
  body += section("answer", "Answer",
                  answers_html(answers_of(page.verb, page.results)) + (table ? tables_html(page.results) : ""));
  if (page.verb == "run") body += section("trust", "Can it be trusted?", trust_html(trust_checks(page.results)));
  body += section("case", "What was asked", folded("The case with all its keys (TOML)", page.case_text));
  body += section("effects", "What acts", effects_html(page.results));
  body += section("motion", "Motion", players_html(page.figures));
  const std::string end = section("repeat", "How to repeat it", repeat_html(page)) +
                          section("report", "Report", folded("All that the program printed", page.report));
  constexpr std::size_t reserve = 50'000;  // of the style sheet, headings and captions
  const std::size_t used = body.size() + end.size() + reserve;
  body += section("figures", "Figures", figures_html(page.figures, most_page_bytes - std::min(most_page_bytes, used)));
  body += end;
  return fmt::format(page_template, fmt::arg("heading", escape_xml(heading)), fmt::arg("style", page_style),
                     fmt::arg("verb", page.verb), fmt::arg("status", escape_xml(page.status)),
                     fmt::arg("state", escape_xml(page.status == "at_rest" ? "at rest" : page.status)),
                     fmt::arg("body", body), fmt::arg("version", escape_xml(page.version)));
}

}  // namespace equidem
