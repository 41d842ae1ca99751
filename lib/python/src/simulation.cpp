// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include <pybind11/stl.h>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/motion/ledger.hpp"

#include "case_inputs.hpp"
#include "module.hpp"
#include "run/run_job.hpp"

namespace equidem::python {
namespace {

/// The run of a case, stepped by its user.
class Steps {
 public:
  Steps(const std::string& case_text, const std::string& case_file, const std::shared_ptr<Assembly>& assembly,
        std::vector<std::string> overrides)
      : inputs_(case_text, case_file, assembly, std::move(overrides)) {
    const LongWork working;
    const KeptSettings settings;
    CommonOptions options;
    options.quiet = !progress_wanted();
    options.case_file = inputs_.case_file();
    options.set = inputs_.overrides();
    job_ = make_run_job(options, false);
    if (job_->goes_to_rest())
      bad_input_at("run.until_rest", "a simulation of a case that goes to rest", "it has no steps in time",
                   "Use Case.run(), or give run.duration");
    plan_ = job_->plan();
  }

  void advance(std::int64_t steps) {
    const LongWork working;
    const std::lock_guard lock(mutex_);
    constexpr std::int64_t at_once = 100;
    AnySimulation& stepped = simulation();
    for (const std::int64_t end = stepped.step() + steps; stepped.step() < end && !stepped.over();) {
      stop_if_interrupted();
      stepped.advance(std::min(at_once, end - stepped.step()));
      if (plan_.watch) plan_.watch(stepped.energy());
    }
  }

  [[nodiscard]] AnySimulation& simulation() const { return job_->simulation(); }
  [[nodiscard]] bool bonded() const { return simulation().family() == BodyFamily::bonded; }
  [[nodiscard]] double time_step() const { return plan_.time_step; }
  [[nodiscard]] std::int64_t steps() const { return plan_.steps; }

  /// (n, 2) and (n): motions or velocities.
  [[nodiscard]] static py::tuple rows_of(std::vector<DiscMotion> motions) {
    const auto owner = std::make_shared<const std::vector<DiscMotion>>(std::move(motions));
    const double* first = owner->empty() ? nullptr : &owner->front().u.x;
    const auto rows = static_cast<py::ssize_t>(owner->size());
    constexpr py::ssize_t row = sizeof(DiscMotion), number = sizeof(double);
    return py::make_tuple(view(owner, first, {rows, 2}, {row, number}),
                          view(owner, first == nullptr ? nullptr : first + 2, {rows}, {row}));
  }
  [[nodiscard]] py::tuple motions() const { return rows_of(simulation().motions()); }
  [[nodiscard]] py::tuple velocities() const { return rows_of(simulation().velocities()); }

  [[nodiscard]] py::dict contacts() const {
    const auto owner = std::make_shared<const std::vector<BodyContact>>(simulation().body_contacts());
    static const BodyContact none;
    const BodyContact& front = owner->empty() ? none : owner->front();
    const auto rows = static_cast<py::ssize_t>(owner->size());
    constexpr py::ssize_t row = sizeof(BodyContact), number = sizeof(double);
    const auto pairs = [&](const auto& first, py::ssize_t size) { return view(owner, &first, {rows, 2}, {row, size}); };
    const auto numbers = [&](const double& first) { return view(owner, &first, {rows}, {row}); };
    py::dict result;
    result["bodies"] = pairs(front.i, sizeof(front.i));
    result["arms"] = pairs(front.arm.x, number);
    result["forces"] = pairs(front.force.x, number);
    result["normal_forces"] = numbers(front.normal_force);
    result["tangential_forces"] = numbers(front.tangential_force);
    return result;
  }
  [[nodiscard]] py::dict energy() const {
    const EnergyLedger ledger = simulation().energy();
    py::dict result;
    for (const EnergyTerm& term : energy_terms(simulation().family())) result[term.key] = ledger.*term.value;
    result["error"] = ledger.error();
    return result;
  }
  [[nodiscard]] std::shared_ptr<Assembly> bodies() const {
    return plan_.frame_discs == nullptr ? nullptr : std::make_shared<Assembly>(*plan_.frame_discs);
  }

 private:
  CaseInputs inputs_;
  std::unique_ptr<RunJob> job_;
  RunPlan plan_;
  std::mutex mutex_;
};

}  // namespace

void bind_simulation(py::module_& module) {
  module.def("steps", [](const std::string& case_text, const std::string& case_file,
                         const std::shared_ptr<Assembly>& assembly, std::vector<std::string> overrides) {
    return std::make_unique<Steps>(case_text, case_file, assembly, std::move(overrides));
  });
  py::class_<Steps>(module, "Steps", made_here())
      .def("advance", &Steps::advance)
      .def("motions", &Steps::motions)
      .def("velocities", &Steps::velocities)
      .def("contacts", &Steps::contacts)
      .def("energy", &Steps::energy)
      .def("bodies", &Steps::bodies)
      .def_property_readonly("bonded", &Steps::bonded)
      .def_property_readonly("time_step", &Steps::time_step)
      .def_property_readonly("steps", &Steps::steps)
      .def_property_readonly("step", [](const Steps& s) { return s.simulation().step(); })
      .def_property_readonly("time", [](const Steps& s) { return s.simulation().time(); });
}

}  // namespace equidem::python
