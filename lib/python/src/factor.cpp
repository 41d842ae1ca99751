// SPDX-License-Identifier: GPL-3.0-or-later
#include <mutex>
#include <string>
#include <utility>

#include <pybind11/stl.h>

#include "equidem/assembly/assembly.hpp"
#include "equidem/core/names.hpp"
#include "equidem/statics/equilibrium.hpp"

#include "result.hpp"
#include "result_arrays.hpp"
#include "springs.hpp"

namespace equidem::python {
namespace {

/// The factorized stiffness matrix of an assembly with its supports.
class Factor {
 public:
  Factor(const Assembly& assembly, const Floats& springs, std::vector<Support> supports,
         const std::vector<std::pair<std::string, Integers>>& groups, const std::string& rotation,
         const std::string& method, bool error_bound)
      : assembly_(assembly), springs_(springs_of(springs)) {
    for (const auto& [name, discs] : groups) assembly_.groups[name] = {{discs.data(), discs.data() + discs.size()}, {}};
    EquilibriumOptions options;
    options.rotation = enum_from<Rotation>(rotation);
    options.solver.method = enum_from<SolverMethod>(method);
    options.error_bound = error_bound;
    const LongWork working;
    solver_.emplace(assembly_, springs_, supports, options);
  }

  [[nodiscard]] py::tuple solve(const Floats& loads) {
    std::vector<DiscForce> forces(assembly_.size());
    for (std::size_t d = 0; d < forces.size(); ++d) {
      const auto k = static_cast<py::ssize_t>(d);
      forces[d] = {{loads.at(k, 0), loads.at(k, 1)}, loads.at(k, 2)};
    }
    Equilibrium result = without_lock([&] {
      const std::lock_guard lock(mutex_);  // one thread at a time solves
      return solver_->solve(forces);
    });
    py::dict values;
    values["relative_residual"] = result.relative_residual;
    values["error_bound"] = result.error_bound;
    values["condition"] = result.condition;
    values["energy"] = result.energy;
    values["iterations"] = result.iterations;
    values["unstable_modes"] = result.unstable_modes;
    values["solver"] = result.solver;
    return py::make_tuple(values, arrays_of(state_arrays("", std::make_shared<const Equilibrium>(std::move(result)))));
  }
  [[nodiscard]] std::int64_t unknowns() const { return solver_->unknowns(); }

 private:
  Assembly assembly_;
  ContactSprings springs_;
  std::optional<EquilibriumSolver> solver_;
  std::mutex mutex_;
};

}  // namespace

void bind_factor(py::module_& module) {
  py::class_<Support>(module, "Support")
      .def(py::init(
          [](std::string group, std::optional<double> ux, std::optional<double> uy, std::optional<double> rotation) {
            return Support{std::move(group), ux, uy, rotation};
          }));
  py::class_<Factor>(module, "Factor")
      .def(py::init<const Assembly&, const Floats&, std::vector<Support>,
                    const std::vector<std::pair<std::string, Integers>>&, const std::string&, const std::string&,
                    bool>())
      .def("solve", &Factor::solve)
      .def_property_readonly("unknowns", &Factor::unknowns);
}

}  // namespace equidem::python
