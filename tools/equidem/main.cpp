// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/output/export/engine_model.hpp"
#include "equidem/output/quantities.hpp"

#include "verbs.hpp"

namespace {

constexpr const char* footer = R"(Examples:
  equidem solve data/cases/abe1996_fig6.toml
  equidem solve data/cases/abe1996_fig6.toml --set springs.kT=0.3e9 --out result
  equidem sweep data/cases/abe1996_fig6.toml --key ratio --from 0 --to 1 --steps 11 --out curve
  equidem sweep data/cases/packed_rock.toml --verb calibrate --key packing.grains --values 200,400 --seeds 1-3
  equidem homogenize data/cases/random_cell.toml
  equidem calibrate data/cases/calibrate_random.toml --springs springs.toml
  equidem stability data/cases/random_cell.toml --set assembly.discs=60 --out waves
  equidem run data/cases/run_pulse.toml --out pulse
  equidem run data/cases/grains_cradle.toml --out cradle
  equidem pack data/cases/pack_jammed.toml --out jammed
  equidem export data/cases/abe1996_fig6.toml --to lammps --out handed
  equidem study data/studies/integrators.toml --accuracy 1e-4
  equidem help case          every key of the case file; with --markdown as a page
  equidem help case springs  the keys of one table
  equidem help result        numbers of result.json, their units and meanings
  equidem help engines       what LAMMPS and YADE carry of a model
  equidem help man solve     the page of man(1) on a verb; 'help man' alone: on the program
  equidem help completion bash    completion for the shell

The files of data/cases are installed in share/doc/equidem/examples.
The tables and figures of published papers are computed by scripts of the source, tools/papers.

Exit codes: 0 done, of a sweep some of its points; 1 the computation failed or its results could not all be written, and
the message says why; 2 bad input or usage; 130 interrupted.)";

}  // namespace

int main(int argc, char** argv) {
  using namespace equidem;
  return_freed_memory();
  const Program program{
      .name = "equidem",
      .description = "equidem: the exact equilibrium of assemblies of discs, and the continuum they stand for",
      .noun = "verb",
      .usage = "VERB CASE.toml [OPTIONS]",
      .footer = footer,
      .verbs = verbs,
      .topics = {{"case", "the keys of case files of equidem", describe_case_file, case_file_page, describe_case_table},
                 {"result", "the numbers of result.json of equidem, their units and meanings", describe_result},
                 {"engines", "what LAMMPS and YADE carry of a model", engine_features_table}},
      .refusals = {{"--accuracy", "this verb takes no --accuracy", "it has no setting that could be chosen for one",
                    "solve, homogenize, run and study do"}}};
  return run_program(program, argc, argv);
}
