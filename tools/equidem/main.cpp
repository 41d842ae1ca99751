// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/output/export/engine_model.hpp"
#include "equidem/output/quantities.hpp"

#include "verb_texts.hpp"
#include "verbs.hpp"

int main(int argc, char** argv) {
  using namespace equidem;
  return_freed_memory();
  const Program program{
      .name = "equidem",
      .description = "equidem: the exact equilibrium of assemblies of discs, and the continuum they stand for",
      .noun = "verb",
      .usage = "VERB CASE.toml [OPTIONS]",
      .footer = equidem_txt,
      .verbs = verbs,
      .topics = {{"case", "the keys of case files of equidem", describe_case_file, case_file_page, describe_case_table},
                 {"result", "the numbers of result.json of equidem, their units and meanings", describe_result},
                 {"engines", "what LAMMPS and YADE carry of a model", engine_features_table}},
      .refusals = {{"--accuracy", "this verb takes no --accuracy", "it has no setting that could be chosen for one",
                    "solve, homogenize, run and study do"}}};
  return run_program(program, argc, argv);
}
