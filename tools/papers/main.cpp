// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>

#include "papers.hpp"

namespace {

constexpr const char* footer = R"(Examples:
  equidem-papers abe1996                                  tables on the screen
  equidem-papers abe1996 --out figures                    and figures: seconds
  equidem-papers abe1996_random --out figures             minutes; with --quick seconds
  equidem-papers fujioka2005 --out figures                minutes; with --quick seconds

Exit codes: 0 done; 1 the computation failed, and the message says why; 2 bad input or usage; 130 interrupted.)";

}  // namespace

int main(int argc, char** argv) {
  using namespace equidem;
  constexpr std::array papers{
      Verb{"abe1996", "Abe (1996): tension test of a lattice, macroscopic stress", abe1996::declare},
      Verb{"abe1996_random", "Abe (1996): the mean field against exact moduli of random assemblies",
           abe1996_random::declare},
      Verb{"fujioka2005", "Fujioka & Ushijima (2005): normal contact laws in collisions", fujioka2005::declare},
  };
  return run_program({.name = "equidem-papers",
                      .description = "equidem-papers: tables and figures of published papers, computed again and set "
                                     "beside the printed numbers",
                      .noun = "paper",
                      .usage = "PAPER [OPTIONS]",
                      .footer = footer,
                      .verbs = papers},
                     argc, argv);
}
