// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include <pybind11/stl.h>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/statics/equilibrium.hpp"

#include "case_inputs.hpp"
#include "problem.hpp"
#include "result.hpp"
#include "state_files.hpp"

namespace equidem::python {
namespace {

/// The factorized stiffness matrix of the assembly of a case with its supports.
class Factor {
 public:
  Factor(const std::string& case_text, const std::string& case_file, const std::shared_ptr<Assembly>& assembly,
         std::vector<std::string> overrides, bool error_bound) {
    const CaseInputs inputs(case_text, case_file, assembly, std::move(overrides));
    const LongWork working;
    Case resolved = read_case(inputs.case_file(), inputs.overrides());
    check_viscoelastic(resolved, "solve");
    problem_.emplace(prestressed(problem_of(std::move(resolved))));
    EquilibriumOptions options = problem_->options();
    options.error_bound = error_bound;
    solver_.emplace(problem_->assembly, problem_->springs.springs, problem_->resolved.supports, options);
  }

  [[nodiscard]] py::tuple solve(const Floats& loads) {
    std::vector<DiscForce> forces(problem_->assembly.size());
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
    if (result.error_bound > 0) values["error_bound"] = result.error_bound;
    if (result.condition > 0) values["condition"] = result.condition;
    values["energy"] = result.energy;
    values["iterations"] = result.iterations;
    values["unstable_modes"] = result.unstable_modes;
    values["solver"] = result.solver;
    return py::make_tuple(values, arrays_of(state_arrays("", std::make_shared<const Equilibrium>(std::move(result)))));
  }
  [[nodiscard]] std::int64_t unknowns() const { return solver_->unknowns(); }

 private:
  std::optional<Problem> problem_;  // the solver refers to it
  std::optional<EquilibriumSolver> solver_;
  std::mutex mutex_;
};

}  // namespace

void bind_factor(py::module_& module) {
  module.def("factor",
             [](const std::string& case_text, const std::string& case_file, const std::shared_ptr<Assembly>& assembly,
                std::vector<std::string> overrides, bool error_bound) {
               return std::make_unique<Factor>(case_text, case_file, assembly, std::move(overrides), error_bound);
             });
  py::class_<Factor>(module, "Factor", made_here())
      .def("solve", &Factor::solve)
      .def_property_readonly("unknowns", &Factor::unknowns);
}

}  // namespace equidem::python
