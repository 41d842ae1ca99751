// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/page/page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <variant>

#include "equidem/core/file.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/vtk.hpp"
#include "equidem/output/quantities.hpp"
#include "equidem/output/texts.hpp"

namespace equidem {
namespace {

thread_local DrawnFigures* innermost = nullptr;

}  // namespace

DrawnFigures::DrawnFigures() : outer_(std::exchange(innermost, this)) {}

DrawnFigures::~DrawnFigures() {
  innermost = outer_;
}

void DrawnFigures::add(DrawnFigure figure) {
  if (innermost != nullptr) innermost->list_.push_back(std::move(figure));
}

bool DrawnFigures::gnuplot_hangs() {
  return innermost != nullptr && std::ranges::any_of(innermost->list_, &DrawnFigure::timed_out);
}

namespace {

/// The rows of answers.csv.
const std::vector<ShownNumber>& shown_numbers() {
  static const std::vector<ShownNumber> all = [] {
    std::vector<ShownNumber> numbers;
    for (const std::vector<std::string>& row : csv_cells(answers_csv)) {
      if (row[0] == "verb") continue;  // the names of the columns
      const bool power = row[7].starts_with('e');
      const auto digits = number_from<int>(std::string_view(row[7]).substr(power ? 1 : 0));
      numbers.push_back({row[0],
                         row[1],
                         row[2],
                         row[3],
                         row[4],
                         row[5],
                         row[6],
                         {power ? Shown::power : Shown::number, digits.value_or(8)}});
    }
    return numbers;
  }();
  return all;
}

/// The value of a result of that type; null: there is none.
template <class Value>
const Value* value_of(const Results& results, std::string_view path) {
  const Result* found = find_result(results, path);
  return found == nullptr ? nullptr : std::get_if<Value>(&found->value.value);
}

using NestedResults = std::shared_ptr<const Results>;
using ListOfResults = std::shared_ptr<const std::vector<Results>>;

/// Paths in which names or positions stand for the '*', each with the name.
std::vector<std::pair<std::string, std::string>> expanded(const Results& results, const std::string& path) {
  const std::size_t star = path.find('*');
  if (star == std::string::npos) return {{path, ""}};
  std::vector<std::pair<std::string, std::string>> all;
  const std::string before = path.substr(0, star - 1), after = path.substr(star + 1);
  for (const Result& part : results.parts()) {
    if (part.key.starts_with(before + "/") && part.key.ends_with(after)) {
      const std::string name = part.key.substr(star, part.key.size() - star - after.size());
      if (name.find('/') == std::string::npos) all.emplace_back(part.key, name);
    }
    const auto* list = std::get_if<ListOfResults>(&part.value.value);
    if (part.key != before || list == nullptr) continue;
    for (std::size_t k = 0; k < (*list)->size(); ++k) {
      const auto* name = value_of<std::string>((**list)[k], "case");
      all.emplace_back(fmt::format("{}/{}{}", before, k, after), name != nullptr ? *name : "");
    }
  }
  return all;
}

std::optional<double> number_of(const Results& results, const std::string& path) {
  if (const auto* whole = value_of<std::int64_t>(results, path)) return static_cast<double>(*whole);
  if (const auto* number = value_of<double>(results, path)) return *number;
  if (const auto* list = value_of<ListOfResults>(results, path)) return static_cast<double>((*list)->size());
  return std::nullopt;
}

/// The unit of a number in result.json.
std::string unit_of(const Results& units, const std::string& path) {
  std::string name;
  for (const std::string_view word : parts_of(path, '/')) {
    const bool position =
        word == "$" || (!word.empty() && word.find_first_not_of("0123456789") == std::string_view::npos);
    if (!position) name += fmt::format("{}{}", name.empty() ? "" : ".", word);
  }
  const auto* unit = value_of<std::string>(units, name);
  return unit != nullptr ? *unit : "";
}

/// Factor and name of the unit in which the value lies between 1 and 1000.
std::pair<double, std::string> prefixed(double value, const std::string& unit) {
  constexpr std::array<const char*, 9> prefixes{"p", "n", "µ", "m", "", "k", "M", "G", "T"};
  constexpr std::array<std::string_view, 5> scalable{"Pa", "s", "J", "J/m", "Hz"};
  if (value == 0 || std::ranges::find(scalable, unit) == scalable.end()) return {1, unit};
  const int power = static_cast<int>(std::floor(std::log10(std::abs(value)) / 3));
  if (power < -4 || power > 4) return {1, unit};
  return {std::pow(1000.0, power), prefixes[static_cast<std::size_t>(power + 4)] + unit};
}

std::string range_html(const std::vector<double>& values, int digits) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(number_html(value, digits));
  return joined(texts, values.size() == 2 ? " to " : ", ");
}

std::vector<Answer> shown(const Results& results, const Results& units, std::string_view verb, std::string_view place,
                          int digits) {
  std::vector<Answer> answers;
  for (const ShownNumber& key : numbers_shown_of(verb, place)) {
    for (const auto& [path, name] : expanded(results, key.path)) {
      Answer answer{.label = name.empty() ? key.label : fmt::format("{}, {}", key.label, name), .text = {}};
      if (const auto* range = value_of<std::vector<double>>(results, path)) {
        answer.text = range_html(*range, digits);
        answer.value = range->empty() ? 0 : range->front();
        answers.push_back(answer);
        continue;
      }
      const auto value = number_of(results, path);
      if (!value || !std::isfinite(*value)) continue;
      const std::string unit = unit_of(units, path);
      const auto [factor, name_of_unit] = prefixed(*value, unit);
      answer.value = *value;
      const bool whole = std::floor(*value) == *value && std::abs(*value) < 1e9 && unit.empty();
      answer.text = whole ? grouped(static_cast<std::int64_t>(*value)) : number_html(*value / factor, digits);
      answer.unit = name_of_unit;
      if (const auto error = number_of(results, key.error); error && std::isfinite(*error))
        answer.error = fmt::format("± {} {}", number_html(*error / factor, 2), escape_xml(name_of_unit));
      answers.push_back(std::move(answer));
    }
  }
  return answers;
}

}  // namespace

bool has_page(std::string_view verb) {
  return std::ranges::find(shown_numbers(), verb, &ShownNumber::verb) != shown_numbers().end();
}

std::vector<ShownNumber> numbers_shown_of(std::string_view verb, std::string_view place) {
  std::vector<ShownNumber> found;
  std::ranges::copy_if(shown_numbers(), std::back_inserter(found),
                       [&](const ShownNumber& number) { return number.verb == verb && number.place == place; });
  return found;
}

Answers answers_of(std::string_view verb, const Results& results) {
  constexpr std::size_t most = 4;
  const Results described = units_and_labels(results);
  const auto* units = value_of<NestedResults>(described, "units");
  const Results none;
  const Results& known = units != nullptr ? **units : none;
  Answers answers{shown(results, known, verb, "main", 6), shown(results, known, verb, "quality", 4)};
  if (answers.main.size() > most) answers.main.resize(most);
  return answers;
}

std::string number_html(double value, int digits) {
  const std::string text = fmt::format("{:.{}g}", value, digits);
  const std::size_t e = text.find('e');
  if (e == std::string::npos) {
    const bool negative = text.starts_with('-');
    return negative ? "−" + text.substr(1) : text;
  }
  std::string exponent = text.substr(e + 1);
  const bool negative = exponent.starts_with('-');
  exponent.erase(0, exponent.find_first_not_of("+-0"));
  const std::string mantissa = text.substr(0, e);
  return fmt::format("{}{} × 10<sup>{}{}</sup>", mantissa.starts_with('-') ? "−" : "",
                     mantissa.starts_with('-') ? mantissa.substr(1) : mantissa, negative ? "−" : "", exponent);
}

namespace {

using enum TrustCheck::Verdict;

// A step up to half the critical one is safe for several contacts at a body; an overlap of a hundredth of the radius
// changes normals and contact areas by about as much, which a linear contact law neglects; the balance of energies is
// that of run_results.
constexpr double safe_step_of_contact = 0.5;      // over that of one contact
constexpr std::pair overlap_limits{0.01, 0.05};   // of the radius
constexpr std::pair imbalance_limits{1e-3, 0.1};  // of the largest energy
constexpr std::pair unbalanced_force_limits{1e-6, 1e-3};

std::optional<double> number(const Results& results, const char* path) {
  const auto value = number_of(results, path);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

/// Good up to the first limit, doubtful up to the second.
TrustCheck graded(std::string name, double value, std::pair<double, double> limits, std::string found,
                  std::string advice) {
  const auto verdict = value <= limits.first ? good : value <= limits.second ? doubtful : bad;
  return {verdict, std::move(name), std::move(found), verdict == good ? "" : std::move(advice)};
}

std::optional<TrustCheck> check_step(const Results& results) {
  const auto step = number(results, "time_step");
  if (!step) return std::nullopt;
  if (const auto ratio = number(results, "time_step_ratio")) {
    const auto* exact = value_of<bool>(results, "critical_time_step_exact");
    const bool critical = exact != nullptr && *exact;
    return graded("time step", *ratio, {1, 1},
                  fmt::format("{:.3g} of the {} step", *ratio, critical ? "critical" : "guaranteed"),
                  "Leave run.time_step out, or give a shorter one: beyond the critical step the motion grows");
  }
  if (const auto critical = number(results, "critical_time_step")) {
    return graded("time step", *step / *critical, {safe_step_of_contact, 1},
                  fmt::format("{:.3g} of the critical step of one contact", *step / *critical),
                  "Compare with a run.time_step a third as long: several contacts at a body lower the critical step");
  }
  if (const auto contact = number(results, "steps_in_contact"))
    return TrustCheck{good, "time step",
                      fmt::format("{:.3g} steps in the shortest contact, exact at any step", *contact)};
  if (find_result(results, "time_step_ratio") != nullptr)
    return TrustCheck{good, "time step", "nothing vibrates, any step is stable"};
  return TrustCheck{doubtful, "time step", "the duration of a contact is not known",
                    "Give collisions.closing_speed, or compare with a run.time_step half as long"};
}

std::optional<TrustCheck> check_overlap(const Results& results) {
  if (const auto change = number(results, "largest_deformation")) {
    return graded("overlap", *change, overlap_limits,
                  fmt::format("contacts change by at most {:.2g} of the sum of their radii", *change),
                  "Take stiffer springs or smaller loads: the contact law is that of small overlaps");
  }
  if (find_result(results, "grains") == nullptr) return std::nullopt;
  const auto overlap = number(results, "largest_overlap");
  if (!overlap) return TrustCheck{good, "overlap", "no bodies touch at the end"};
  return graded("overlap", *overlap, overlap_limits,
                fmt::format("at most {:.2g} of the smaller radius at the end", *overlap),
                "Take a shorter collisions.contact_duration or a larger stiffness: bodies overlap visibly");
}

std::optional<TrustCheck> check_balance(const Results& results) {
  if (const auto force = number(results, "relative_unbalanced_force")) {
    return graded("balance of forces", *force, unbalanced_force_limits,
                  fmt::format("unbalanced by {:.1e} of the contact forces", *force), "Give a smaller run.until_rest");
  }
  const auto error = number(results, "energy/relative_error");
  if (!error) return std::nullopt;
  return graded("balance of energies", std::abs(*error), imbalance_limits,
                fmt::format("closed to {:.1e} of the largest energy", std::abs(*error)),
                "Compare with a shorter run.time_step before trusting the motion");
}

/// The mean field of bonded discs, nu = (1 - kT/kN)/4 in plane strain (Abe 1996, eq. 35), is at most 1/4 without
/// negative springs, 1/3 in plane stress.
std::optional<TrustCheck> check_poisson_ratio(const Results& results) {
  const auto ratio = number(results, "springs/ratio");
  if (!ratio || find_result(results, "grains") != nullptr) return std::nullopt;
  if (*ratio >= 0)
    return TrustCheck{good, "Poisson's ratio", fmt::format("feasible: no spring is negative (kT/kN = {:.4g})", *ratio)};
  return TrustCheck{bad, "Poisson's ratio", fmt::format("not feasible in motion: kT/kN = {:.4g} is negative", *ratio),
                    "Ask for at most 1/4 in plane strain, 1/3 in plane stress: 'equidem calibrate' tells the range of "
                    "an assembly"};
}

}  // namespace

std::vector<TrustCheck> trust_checks(const Results& results) {
  std::vector<TrustCheck> checks;
  for (auto& check :
       {check_step(results), check_overlap(results), check_balance(results), check_poisson_ratio(results)})
    if (check) checks.push_back(*check);
  return checks;
}

namespace {

constexpr std::size_t most_text_bytes = 100'000;  ///< of the case and of the report

std::string text_of(const Results& results, const char* path) {
  const auto* text = value_of<std::string>(results, path);
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

/// The lines of the report that are warnings, without the columns and breaks of the report.
std::vector<std::string> warnings_of(const Results& results) {
  std::vector<std::string> found;
  Results line;
  bool warns = false;
  const auto end_line = [&] {
    if (std::exchange(warns, false)) found.push_back(one_paragraph(line.report()));
    line = {};
  };
  for (const Result& part : results.parts()) {
    const bool text = part.part == Result::Part::block;
    if (part.hidden || part.part == Result::Part::table || part.part == Result::Part::list) continue;
    if (text || part.part == Result::Part::line) end_line();
    warns = warns || part.warning.has_value();
    if (part.part == Result::Part::line) {
      line.line(part.warning && !part.warning->empty() ? *part.warning : part.label);
    } else if (part.part == Result::Part::value) {
      line.add("", part.label, part.value, part.unit, part.shown);
    } else {
      text ? line.block(part.label) : line.note(part.label);
    }
  }
  end_line();
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
  const auto* lines = value_of<std::vector<std::string>>(results, "advice");
  for (const std::string& line : lines != nullptr ? *lines : std::vector<std::string>{})
    html += fmt::format("<p>{}</p>\n", escape_xml(line));
  for (const Result& part : results.parts()) {
    if (part.part != Result::Part::table) continue;
    const Results table = Results().table("", *std::get<ListOfResults>(part.value.value));
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
  const auto* names = value_of<std::vector<std::string>>(results, "effects/active");
  if (names != nullptr && !names->empty()) {
    html += "<ul class=\"active\">\n";
    for (const std::string& name : *names) html += fmt::format("<li>{}</li>\n", escape_xml(name));
    html += "</ul>\n";
  }
  const auto* reasons = value_of<NestedResults>(results, "effects/inactive");
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
      missing += fmt::format("<li><a href=\"{0}\">{0}</a>: no room is left for it on this page</li>\n",
                             escape_xml(figure.file.filename().string()));
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
  std::vector<std::string> warnings = warnings_of(page.results);
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
  return fmt::format(page_html, fmt::arg("heading", escape_xml(heading)), fmt::arg("style", page_css),
                     fmt::arg("verb", page.verb), fmt::arg("status", escape_xml(page.status)),
                     fmt::arg("state", escape_xml(page.status == "at_rest" ? "at rest" : page.status)),
                     fmt::arg("body", body), fmt::arg("version", escape_xml(page.version)));
}

}  // namespace equidem
