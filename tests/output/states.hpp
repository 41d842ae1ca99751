// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Assemblies with synthetic states, and checks by Python scripts.
#pragma once

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <unistd.h>

#include "equidem/assembly/lattices.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/body_tables.hpp"

#include "support/temporary_folder.hpp"

namespace equidem {

/// An assembly under a displacement field, with contact forces by the linear law and arbitrary stresses.
struct MadeUpState {
  Assembly assembly;
  std::vector<DiscMotion> motions;
  std::vector<ContactForce> forces;
  std::vector<Tensor2> stresses;

  [[nodiscard]] AssemblyState view() const { return {assembly, motions, forces, stresses}; }
};

inline MadeUpState made_up(Assembly assembly, const Tensor2& gradient) {
  MadeUpState state;
  state.assembly = std::move(assembly);
  for (std::size_t disc = 0; disc < state.assembly.size(); ++disc) {
    const double k = static_cast<double>(disc) + 0.1;
    state.motions.push_back({gradient * state.assembly.centres[disc], 1e-4 * std::sin(k)});
    state.stresses.push_back({1e6 * std::cos(k), 3e5 * std::sin(k), 3e5 / k, -1e6 / k});
  }
  for (std::size_t c = 0; c < state.assembly.contacts.size(); ++c) {
    const Contact& contact = state.assembly.contacts[c];
    const ContactDeformation d =
        deformation(frame_of(state.assembly, c), state.motions[contact.i], state.motions[contact.j]);
    state.forces.push_back(linear_spring_force({1e9, 3e8}, d));
  }
  return state;
}

inline MadeUpState stretched_block(int columns = 7, int rows = 6, bool periodic = false) {
  return made_up(hexagonal_lattice({.columns = columns, .rows = rows, .periodic = periodic}),
                 {1e-3, 2e-4, -1e-4, -3e-4});
}

using equidem::test::TemporaryFolder;

/// Run a script of this folder with Python; its error output appears in the log of the test.
/// \return its exit code
inline int run_python(const std::string& script, const std::vector<std::string>& arguments) {
  std::string command = fmt::format("'{}' '{}/tests/output/{}'", EQUIDEM_PYTHON, EQUIDEM_SOURCE_DIR, script);
  for (const std::string& argument : arguments) command += fmt::format(" '{}'", argument);
  const int status = std::system(fmt::format("{} 1>&2", command).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace equidem
