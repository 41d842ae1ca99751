// SPDX-License-Identifier: GPL-3.0-or-later
#include "verbs.hpp"

#include <algorithm>

#include "equidem/casefile/engine/keys.hpp"
#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/casefile/packing/pack_case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/given.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// The command that does the same. A case in memory is that of the page, with its overrides; the folder of the results
/// is left out.
std::string command_of(const std::string& verb, const std::filesystem::path& case_file,
                       const std::vector<std::string>& overrides, const std::vector<std::string>& options) {
  const bool in_memory = Given<std::string>::find(case_file) != nullptr;
  std::vector<std::string> words{"equidem", verb, in_memory ? "case.toml" : case_file.string()};
  if (!in_memory)
    for (const std::string& assignment : overrides) words.insert(words.end(), {"--set", assignment});
  for (std::size_t k = 0; k < options.size(); ++k) {
    if (options[k] == "--overwrite") continue;
    options[k] == "--out" ? void(++k) : words.push_back(options[k]);
  }
  return shell_words(words);
}

/// "solve, homogenize and stability take it". \param has whether a verb does
std::string takers(const std::function<bool(const Takes&)>& has) {
  std::vector<std::string> names;
  for (const Verb& verb : verbs)
    if (has(verb.takes)) names.emplace_back(verb.name);
  return listed(names) + " take it";
}

void check_viscoelastic(const Case& resolved, std::string_view taker, Takes::Viscoelastic takes) {
  using enum Takes::Viscoelastic;
  if (!resolved.viscoelastic || takes == all) return;
  const auto refuse = [&](const std::string& problem, const char* why, const std::string& remedy) {
    bad_input_at(resolved.where("viscoelastic"), problem, why, remedy);
  };
  if (takes == none)
    refuse(fmt::format("{} takes elastic springs, and the case gives [viscoelastic]", taker),
           "its answer would be that of other springs",
           "Remove [viscoelastic]; " + takers([](const Takes& other) { return other.viscoelastic != none; }));
  const Viscoelasticity& springs = resolved.viscoelastic->springs;
  for (const SpringModel model : {SpringModel::maxwell, SpringModel::standard_solid, SpringModel::table}) {
    if (springs.normal.model != model && springs.tangential.model != model) continue;
    if (takes == moving)
      refuse(fmt::format("a run has no springs of the model \"{}\"", to_string(model)),
             "its contacts are springs with dashpots beside them, Kelvin-Voigt",
             "Use kelvin_voigt, or 'equidem homogenize' for complex moduli");
    if (model == SpringModel::maxwell)
      refuse("a Maxwell spring has no equilibrium", "its dashpot flows as long as it carries a force",
             "Use 'equidem homogenize', which gives complex moduli, or another model");
    if (model == SpringModel::table)
      refuse("a table of springs over frequency has no equilibrium", "its stiffness at rest is not known",
             "Use 'equidem homogenize', or remove [viscoelastic] to solve with elastic springs");
  }
}

}  // namespace

Case read_case(const CommonOptions& options) {
  prepare(options);
  Case resolved = read_case(options.case_file, overrides_of(options));
  check_taken(resolved, options.verb, entry_named(verbs, options.verb, "verb").takes);
  return resolved;
}

CaseDocument read_document(const std::string& verb, const CommonOptions& options) {
  prepare(options);
  if (verb == "pack") return read_pack_case(options.case_file, overrides_of(options));
  if (verb == "run" && describes_grains(casefile::read_document(options.case_file, options.set)))
    return read_grain_case(options.case_file, options.set);
  return read_case(options);
}

void check_taken(const Case& resolved, std::string_view taker, const Takes& takes) {
  if (takes.of_another) return;
  check_viscoelastic(resolved, taker, takes.viscoelastic);
  if (resolved.prestress == PrestressChoice::on && !takes.prestress)
    bad_input_at(
        resolved.where("effects.prestress"), fmt::format("{} takes no prestress, and the case asks for it", taker),
        "its answer would be that of the springs alone", "Remove effects.prestress; " + takers(&Takes::prestress));
  if (!resolved.bending.given() || takes.bending) return;
  const char* table = resolved.material ? "material" : "springs";
  bad_input_at(resolved.where(fmt::format("{}.{}", table, resolved.bending.kM ? "kM" : "bond_width")),
               fmt::format("{} takes no bending springs, and the case gives some", taker),
               "its answer would be that of contacts without moments", "Remove it; " + takers(&Takes::bending));
}

VerbRun::VerbRun(const std::string& verb, const std::filesystem::path& case_file,
                 const std::vector<std::string>& overrides, const std::vector<std::string>& options) {
  command_.name(verb);
  command_line_ = command_of(verb, case_file, overrides, options);
  run_ = entry_named(verbs, verb, "verb").declare(command_);
  std::vector<std::string> arguments{case_file.string()};
  for (const std::string& assignment : overrides) arguments.insert(arguments.end(), {"--set", assignment});
  arguments.insert(arguments.end(), options.begin(), options.end());
  try {
    parse(command_, std::move(arguments));
  } catch (const CLI::ParseError& error) {
    bad_input(error.what(), "", "See 'equidem help'");
  }
}

std::set<std::string> flags_of_verbs() {
  std::set<std::string> names;
  for (const Verb& verb : verbs) {
    CLI::App command;
    const Run run = verb.declare(command);
    for (const CLI::Option* option : command.get_options())
      if (option->get_items_expected_max() == 0) names.insert(option->get_lnames().begin(), option->get_lnames().end());
  }
  return names;
}

}  // namespace equidem
