// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cctype>
#include <cstdint>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/results.hpp"

#include "command_texts.hpp"
#include "program.hpp"

namespace equidem {
namespace {

/// The character of UTF-8 text at `begin`, as groff names it: \[u03BD].
std::string named_character(std::string_view text, std::size_t& begin) {
  const auto lead = static_cast<unsigned char>(text[begin]);
  const std::size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  std::uint32_t code = lead & (0x7fU >> length);
  for (std::size_t k = 1; k < length; ++k) code = code << 6 | (static_cast<unsigned char>(text.at(begin + k)) & 0x3fU);
  begin += length;
  return fmt::format("\\[u{:04X}]", code);
}

/// Text whose characters have no meaning for roff. All hyphens are those of options, which can be copied.
std::string escaped(std::string_view text) {
  constexpr std::pair<char, std::string_view> names[] = {{'\\', "\\(rs"}, {'-', "\\-"},   {'\'', "\\(aq"},
                                                         {'`', "\\(ga"},  {'^', "\\(ha"}, {'~', "\\(ti"}};
  std::string out;
  for (std::size_t k = 0; k < text.size();) {
    const char c = text[k];
    if (static_cast<unsigned char>(c) >= 0x80) {
      out += named_character(text, k);
      continue;
    }
    const auto* name = std::ranges::find(names, c, &std::pair<char, std::string_view>::first);
    if (c == '.' && (k == 0 || text[k - 1] == '\n')) out += "\\&";
    out += name == std::end(names) ? std::string_view(&c, 1) : name->second;
    ++k;
  }
  return out;
}

std::string bold(std::string_view text) {
  return fmt::format("\\fB{}\\fR", escaped(text));
}

std::string italic(std::string_view text) {
  return fmt::format("\\fI{}\\fR", escaped(text));
}

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

std::string section(const std::string& title) {
  return fmt::format(".SH {}\n", escaped(upper(title)));
}

std::string verbatim(std::string_view text) {
  return fmt::format(".nf\n{}.fi\n", escaped(text));
}

/// \param summary one line, for whatis(1)
std::string top(const Program& program, const std::string& name, int number, std::string_view summary) {
  return fmt::format(".TH {} {} \"{}\" \"equidem {}\" \"{} manual\"\n.nh\n.ad l\n", upper(name), number,
                     EQUIDEM_RELEASE_DATE, library_version(), program.name) +
         section("Name") + fmt::format("{} \\- {}\n", escaped(name), escaped(summary));
}

std::string page_name(const Program& program, const std::string& name) {
  return fmt::format("{}-{}", program.name, name);
}

std::string reference(const std::string& page, int number) {
  return fmt::format(".BR {} ({})", escaped(page), number);
}

std::string options_of(const CLI::App& command, bool positional) {
  std::string out;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_positional() != positional) continue;
    std::string names = positional ? option->get_name() : option->get_name(false, true);
    if (const std::size_t comma = names.find(','); comma != std::string::npos) names.insert(comma + 1, " ");
    const std::string value = positional ? "" : CLI::Formatter().make_option_opts(option);
    out += fmt::format(".TP\n{}{}\n{}\n", positional ? italic(names) : bold(names),
                       value.empty() ? "" : " " + italic(value.substr(value.find_first_not_of(' '))),
                       escaped(option->get_description()));
  }
  return out;
}

/// The text below the options: a line that ends with a colon begins a section, indented lines are kept as they are.
std::string footer_sections(std::string_view footer) {
  constexpr std::string_view exit_codes = "Exit codes: ";
  std::string out;
  bool kept = false, new_paragraph = true;
  while (!footer.empty()) {
    const std::size_t end = std::min(footer.find('\n'), footer.size());
    std::string_view line = footer.substr(0, end);
    footer.remove_prefix(std::min(end + 1, footer.size()));
    if (line.starts_with("  ") != kept) {
      out += kept ? ".fi\n" : ".nf\n";
      new_paragraph = std::exchange(kept, !kept);
    }
    if (line.empty()) {
      new_paragraph = true;
      continue;
    }
    if (!kept && line.ends_with(':')) {
      out += section(std::string(line.substr(0, line.size() - 1)));
    } else if (line.starts_with(exit_codes)) {
      out += section("Exit status") + escaped(line.substr(exit_codes.size())) + "\n";
    } else {
      out += (new_paragraph && !kept ? ".PP\n" : "") + escaped(line) + "\n";
    }
    new_paragraph = false;
  }
  return kept ? out + ".fi\n" : out;
}

std::string program_page(const Program& program, const CLI::App& app) {
  std::string_view summary = program.description;
  summary.remove_prefix(std::string_view(program.name).size() + 2);  // "equidem: "
  std::string out = top(program, program.name, 1, summary);
  out += section("Synopsis") + fmt::format("{} {}\n", bold(program.name), escaped(program.usage));
  out += section(fmt::format("{}s", program.noun));
  for (const Verb& verb : program.verbs) out += fmt::format(".TP\n{}\n{}\n", bold(verb.name), escaped(verb.summary));
  out += section("Options") + options_of(app, false) + footer_sections(app.get_footer()) + section("See also");
  std::string others;
  for (const Verb& verb : program.verbs)
    others += fmt::format("{}{}", others.empty() ? "" : ",\n", reference(page_name(program, verb.name), 1));
  for (const HelpTopic& topic : program.topics)
    others += fmt::format(",\n{}", reference(page_name(program, topic.name), 5));
  return out + others + "\n";
}

std::string command_page(const Program& program, const CLI::App& command, const Verb& verb) {
  std::string out = top(program, page_name(program, verb.name), 1, verb.summary);
  out += section("Synopsis") + bold(fmt::format("{} {}", program.name, verb.name));
  for (const CLI::Option* option : command.get_options())
    if (option->get_positional()) out += " " + italic(option->get_name());
  out += " [" + italic("OPTIONS") + "]\n";
  const std::string arguments = options_of(command, true);
  if (!arguments.empty()) out += section("Arguments") + arguments;
  out += section("Options") + options_of(command, false) + footer_sections(command.get_footer());
  return out + section("See also") + reference(program.name, 1) + "\n";
}

std::string topic_page(const Program& program, const HelpTopic& topic) {
  return top(program, page_name(program, topic.name), 5, topic.summary) + section("Description") +
         verbatim(topic.text()) + section("See also") + reference(program.name, 1) + "\n";
}

}  // namespace

std::optional<std::string> man_page(const Program& program, const CLI::App& app, const std::string& name) {
  if (name.empty()) return program_page(program, app);
  for (const Verb& verb : program.verbs)
    if (name == verb.name) return command_page(program, *app.get_subcommand(name), verb);
  for (const HelpTopic& topic : program.topics)
    if (name == topic.name) return topic_page(program, topic);
  return std::nullopt;
}

/// What bash completes after an option, or as a positional argument; null: nothing is expected.
static const char* completed_by(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  if (option.get_items_expected_max() == 0) return nullptr;
  if (type == "KEY") return "words=$keys";
  if (type == "KEY=VALUE") return "words=$keys; end='='";
  if (type.starts_with("FILE")) return "files=-f";
  if (type == "DIR") return "files=-d";
  return type == "VERB" ? "words=$commands" : "";
}

std::string bash_completion(const Program& program, const CLI::App& app) {
  std::vector<std::string> commands, topics{manual_topic, completion_topic}, after;
  for (const HelpTopic& topic : program.topics) topics.emplace_back(topic.name);
  std::string options, values, function = fmt::format("_{}", program.name);
  std::ranges::replace(function, '-', '_');
  for (const Verb& verb : program.verbs) {
    std::vector<std::string> names;
    std::string positional;
    for (const CLI::Option* option : app.get_subcommand(verb.name)->get_options()) {
      const char* const value = completed_by(*option);
      if (option->get_positional()) {
        positional = value;
        continue;
      }
      names.push_back("--" + option->get_lnames().front());
      if (value == nullptr) continue;
      std::string line = fmt::format("    {}) {} ;;\n", names.back(), value);
      if (std::ranges::find(after, line) == after.end()) after.push_back(std::move(line));
    }
    options += fmt::format("        {}) words='{}' {} ;;\n", verb.name, joined(names, " "), positional);
    commands.emplace_back(verb.name);
  }
  topics.insert(topics.end(), commands.begin(), commands.end());
  const std::vector<CaseKey> keys = case_keys();
  for (const CaseKey& key : keys)
    if (!key.words.empty()) values += fmt::format("      {}) words='{}' ;;\n", key.path, joined(key.words, " "));
  // bash splits words at '=': the value of a key is the second word after it.
  return fmt::format(completion_bash_in, program.name, function, joined(commands, " "),
                     joined(keys, &CaseKey::path, " "), values, joined(after, ""), options, joined(topics, " "));
}

}  // namespace equidem
