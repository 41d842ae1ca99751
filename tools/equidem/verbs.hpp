// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The verbs of the program. A verb is one file with one declare function, its examples in help/, and one line in
/// the table below. Verbs are
/// also carried out within another one, as the command line would do it.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "equidem/core/file.hpp"

#include "command.hpp"
#include "program.hpp"
#include "verb_texts.hpp"

namespace equidem {

/// One run of a verb, without files.
class VerbRun {
 public:
  /// \param verb its name
  /// \param overrides of keys of the case, as those of --set
  /// \param options further ones of the command line
  /// \throws Error (bad_input) on an option that the verb does not have
  VerbRun(const std::string& verb, const std::filesystem::path& case_file, const std::vector<std::string>& overrides,
          const std::vector<std::string>& options);

  /// \throws Error as the verb does
  [[nodiscard]] Delivery operator()(Arrays arrays = Arrays::not_wanted) const {
    const ProtectedInputs inputs(replaceable_inputs(command_));
    return collect(run_, arrays, command_line_);
  }

 private:
  CLI::App command_;
  std::string command_line_;
  std::function<void()> run_;
};

Run declare_solve(CLI::App& command);
Run declare_homogenize(CLI::App& command);
Run declare_calibrate(CLI::App& command);
Run declare_stability(CLI::App& command);
Run declare_pack(CLI::App& command);
Run declare_run(CLI::App& command);
Run declare_quasistatic(CLI::App& command);
Run declare_export(CLI::App& command);
Run declare_sweep(CLI::App& command);
Run declare_study(CLI::App& command);

/// Apply threads and quiet, and read the case with its overrides.
/// \throws Error (bad_input) as read_case and check_taken
Case read_case(const CommonOptions& options);

/// The case as a verb reads it, whatever its kind.
/// \throws Error (bad_input) as the reader of the verb
CaseDocument read_document(const std::string& verb, const CommonOptions& options);

/// \param taker of the case
/// \throws Error (bad_input), with the line of the case file, where the case asks for an effect that the taker does
///         not take
void check_taken(const Case& resolved, std::string_view taker, const Takes& takes);

/// Names of the options of all verbs that take no value, without hyphens in front.
std::set<std::string> flags_of_verbs();

inline constexpr std::array verbs{
    Verb{"solve", "equilibrium under supports and loads, or Abe's tension test", declare_solve, true, solve_txt,
         Takes{.prestress = true, .bending = true, .viscoelastic = Takes::Viscoelastic::at_rest}},
    Verb{"homogenize", "effective stiffness and moduli of an assembly, with bounds", declare_homogenize, true,
         homogenize_txt, Takes{.prestress = true, .bending = true, .viscoelastic = Takes::Viscoelastic::all}},
    Verb{"calibrate", "wanted moduli -> springs, as a file that every other verb accepts", declare_calibrate, true,
         calibrate_txt, Takes{.bending = true}},
    Verb{"stability", "mechanisms, waves, critical kT/kN, highest frequency and time step", declare_stability, true,
         stability_txt, Takes{.prestress = true, .bending = true}},
    Verb{"pack", "make an assembly: bodies in a box, at random or at rest", declare_pack, true, pack_txt},
    Verb{"run", "dynamics: bonded discs stepped in time or relaxed to rest, or bodies that collide", declare_run, true,
         run_txt, Takes{.bending = true, .viscoelastic = Takes::Viscoelastic::moving}},
    Verb{"quasistatic", "contacts that break one after another under a growing load", declare_quasistatic, true,
         quasistatic_txt},
    Verb{"export", "the model as input of LAMMPS or YADE, or its equations as matrices", declare_export, false,
         export_txt, Takes{.prestress = true, .bending = true}},
    Verb{"sweep", "a verb over values of keys and seeds: one table, and curves", declare_sweep, false, sweep_txt,
         Takes{.of_another = true}},
    Verb{"study", "error against time: the order of a method, the cheapest setting for an accuracy", declare_study,
         false, study_txt},
};

}  // namespace equidem
