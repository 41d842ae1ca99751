// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What is done with a case: verbs, the factorized stiffness matrix, a run that its user steps.
#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <pybind11/complex.h>
#include <pybind11/stl.h>

#include "equidem/assembly/assembly.hpp"
#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/given.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/grains/stages/staged_simulation.hpp"
#include "equidem/motion/ledger.hpp"
#include "equidem/statics/adjoint.hpp"
#include "equidem/statics/equilibrium.hpp"

#include "command.hpp"
#include "module.hpp"
#include "problem.hpp"
#include "run/run_job.hpp"
#include "state_files.hpp"
#include "verbs.hpp"

namespace equidem::python {
namespace {

/// A case from Python: a file or a text, with an assembly in memory.
class CaseInputs {
 public:
  /// \param case_text read in place of `case_file` where that is empty
  /// \param assembly null, or that of assembly.path
  CaseInputs(const std::string& case_text, std::string case_file, const std::shared_ptr<const Assembly>& assembly,
             std::vector<std::string> overrides)
      : case_file_(std::move(case_file)), overrides_(std::move(overrides)) {
    if (case_file_.empty()) case_file_ = text_.emplace("case", std::make_shared<const std::string>(case_text)).name();
    if (assembly == nullptr) return;
    overrides_.push_back("assembly.path=\"" + assembly_.emplace("assembly", assembly).name() + "\"");
  }

  [[nodiscard]] const std::string& case_file() const { return case_file_; }
  [[nodiscard]] const std::vector<std::string>& overrides() const { return overrides_; }

 private:
  std::optional<Given<std::string>> text_;
  std::optional<Given<Assembly>> assembly_;
  std::string case_file_;
  std::vector<std::string> overrides_;
};

/// {name: (array, unit)}, views of the memory that each array owns.
py::dict arrays_of(const std::vector<ResultArray>& arrays) {
  py::dict result;
  for (const ResultArray& array : arrays) {
    const auto rows = static_cast<py::ssize_t>(array.rows), columns = static_cast<py::ssize_t>(array.columns);
    const py::array made = std::visit(
        [&](const auto* first) {
          const auto size = static_cast<py::ssize_t>(sizeof(*first));
          const py::ssize_t stride = static_cast<py::ssize_t>(array.stride) * size;
          if (const auto inner = static_cast<py::ssize_t>(array.matrix_columns); inner > 0)
            return view(array.owner, first, {rows, columns / inner, inner}, {stride, inner * size, size});
          return columns == 1 ? view(array.owner, first, {rows}, {stride})
                              : view(array.owner, first, {rows, columns}, {stride, size});
        },
        array.numbers);
    result[py::str(array.name)] = py::make_tuple(made, array.unit);
  }
  return result;
}

/// A result as it was delivered, which its texts and a page can be made of.
struct Delivered {
  Delivery delivery;

  /// Report, units and labels, as JSON: made when they are asked for, since they take as long as the numbers.
  [[nodiscard]] std::string texts() const { return delivery.texts().json(); }
  /// The page; its case and figures are written into the folder.
  [[nodiscard]] std::string page(const std::string& folder) const {
    const LongWork working;
    return delivery.page_drawn_in(folder);
  }
};

/// What could not be delivered, a file or a figure, as warnings of Python: the numbers are there all the same.
void warn_of(const Results& results) {
  const Result* const found = find_result(results, "warnings");
  const auto* sentences = found != nullptr ? std::get_if<std::vector<std::string>>(&found->value.value) : nullptr;
  if (sentences == nullptr) return;
  const py::object in_python = py::module_::import("equidem.errors").attr("in_python");
  for (const std::string& sentence : *sentences) {
    const auto told = py::cast<std::string>(in_python(sentence));
    if (PyErr_WarnEx(PyExc_RuntimeWarning, told.c_str(), 1) != 0) throw py::error_already_set();
  }
}

/// Carry out a verb. Returns (JSON of the numbers, arrays, assembly or None where it is the given one, wall clock of
/// the verb in s, Delivered).
py::tuple run_verb(const std::string& verb, const std::string& case_text, const std::string& case_file,
                   const std::shared_ptr<Assembly>& assembly, std::vector<std::string> overrides,
                   std::vector<std::string> options) {
  if (!progress_wanted() && std::ranges::find(options, "--quiet") == options.end()) options.emplace_back("--quiet");
  const CaseInputs inputs(case_text, case_file, assembly, std::move(overrides));
  Delivery delivery;
  std::string json;
  double seconds = 0;
  {
    const LongWork working;
    const KeptSettings settings;
    const Stopwatch watch;
    delivery = VerbRun(verb, inputs.case_file(), inputs.overrides(), options)(Arrays::wanted);
    const bool is_given = assembly && delivery.assembly && delivery.assembly->size() == assembly->size();
    if (is_given) delivery.assembly.reset();
    seconds = watch.seconds();
    json = delivery.numbers().json();
  }
  warn_of(delivery.results);
  const py::dict arrays = arrays_of(std::exchange(delivery.arrays, {}));
  auto made = std::const_pointer_cast<Assembly>(std::exchange(delivery.assembly, nullptr));
  return py::make_tuple(json, arrays, std::move(made), seconds, Delivered{std::move(delivery)});
}

std::vector<DiscForce> disc_forces(const Floats& rows) {
  std::vector<DiscForce> forces;
  for (py::ssize_t d = 0; d < rows.shape(0); ++d) forces.push_back({{rows.at(d, 0), rows.at(d, 1)}, rows.at(d, 2)});
  return forces;
}

std::vector<DiscMotion> disc_motions(const Floats& rows) {
  std::vector<DiscMotion> motions;
  for (py::ssize_t d = 0; d < rows.shape(0); ++d) motions.push_back({{rows.at(d, 0), rows.at(d, 1)}, rows.at(d, 2)});
  return motions;
}

/// by_kN, by_kT, by_kM, by_position: those that there are.
std::vector<ResultArray> derivative_arrays(SpringAndPlaceDerivatives found) {
  std::vector<ResultArray> arrays{array_of("by_kN", "", std::move(found.by_kN), 1),
                                  array_of("by_kT", "", std::move(found.by_kT), 1)};
  if (!found.by_kM.empty()) arrays.push_back(array_of("by_kM", "", std::move(found.by_kM), 1));
  if (!found.by_position.empty()) arrays.push_back(array_of("by_position", "", std::move(found.by_position), 2));
  return arrays;
}

/// \param a, b motions (n, 3)
py::dict form_derivatives_of_case(const std::string& case_text, const std::string& case_file,
                                  const std::shared_ptr<Assembly>& assembly, std::vector<std::string> overrides,
                                  const Floats& a, const Floats& b) {
  const CaseInputs inputs(case_text, case_file, assembly, std::move(overrides));
  const std::vector<DiscMotion> of_a = disc_motions(a), of_b = disc_motions(b);
  return arrays_of(without_lock([&] {
    Case resolved = read_case(inputs.case_file(), inputs.overrides());
    check_taken(resolved, "form_derivatives", entry_named(verbs, "solve", "verb").takes);
    const Problem problem = prestressed(problem_of(std::move(resolved)));
    return derivative_arrays(form_derivatives(problem.assembly, problem.springs.springs, of_a, of_b));
  }));
}

/// The factorized stiffness matrix of the assembly of a case with its supports.
class Factor {
 public:
  Factor(const std::string& case_text, const std::string& case_file, const std::shared_ptr<Assembly>& assembly,
         std::vector<std::string> overrides, bool error_bound) {
    const CaseInputs inputs(case_text, case_file, assembly, std::move(overrides));
    const LongWork working;
    Case resolved = read_case(inputs.case_file(), inputs.overrides());
    check_taken(resolved, "factorize", entry_named(verbs, "solve", "verb").takes);
    problem_.emplace(prestressed(problem_of(std::move(resolved))));
    EquilibriumOptions options = problem_->options();
    options.error_bound = error_bound;
    solver_.emplace(problem_->assembly, problem_->springs.springs, problem_->resolved.supports, options);
  }

  [[nodiscard]] py::tuple solve(const Floats& loads) {
    const std::vector<DiscForce> forces = disc_forces(loads);
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
  /// \param loads (n, 3) \param motions weights (n, 3) \param forces weights (contacts, 2)
  [[nodiscard]] py::tuple derivatives(const Floats& loads, const Floats& motions, const Floats& forces) {
    const std::vector<DiscForce> acting = disc_forces(loads);
    Measure measure{.motions = disc_forces(motions), .forces = {}};
    for (py::ssize_t c = 0; c < forces.shape(0); ++c) measure.forces.push_back({forces.at(c, 0), forces.at(c, 1)});
    MeasureDerivatives found = without_lock([&] {
      const std::lock_guard lock(mutex_);
      return equidem::derivatives(*solver_, solver_->solve(acting), measure);
    });
    py::dict values;
    values["value"] = found.value;
    const auto by_load = std::make_shared<const std::vector<DiscMotion>>(std::move(found.by_load));
    std::vector<ResultArray> arrays = derivative_arrays(std::move(found));
    std::vector<ResultArray> loads_first = motion_arrays("", by_load);
    loads_first[0].name = "by_force", loads_first[1].name = "by_moment";
    for (ResultArray& array : loads_first) array.unit = "", arrays.push_back(std::move(array));
    return py::make_tuple(values, arrays_of(std::move(arrays)));
  }
  [[nodiscard]] std::int64_t unknowns() const { return solver_->unknowns(); }

 private:
  std::optional<Problem> problem_;  // the solver refers to it
  std::optional<EquilibriumSolver> solver_;
  std::mutex mutex_;
};

/// The run of a case, stepped by its user.
class Steps {
 public:
  Steps(const std::string& case_text, const std::string& case_file, const std::shared_ptr<Assembly>& assembly,
        std::vector<std::string> overrides)
      : inputs_(case_text, case_file, assembly, std::move(overrides)) {
    const LongWork working;
    const KeptSettings settings;
    CommonOptions options;
    options.verb = "run";
    options.quiet = !progress_wanted();
    options.case_file = inputs_.case_file();
    options.set = inputs_.overrides();
    job_ = make_run_job(options, false);
    if (job_->goes_to_rest())
      bad_input_at("run.until_rest", "a simulation of a case that goes to rest", "it has no steps in time",
                   "Use Case.run(), or give run.duration");
    plan_ = job_->plan();
  }

  /// \param of_stage stop where a stage ends
  void advance(std::int64_t steps, bool of_stage) {
    const LongWork working;
    const std::lock_guard lock(mutex_);
    constexpr std::int64_t at_once = 100;
    AnySimulation& stepped = simulation();
    const std::int64_t end = steps > INT64_MAX - stepped.step() ? INT64_MAX : stepped.step() + steps;
    while (stepped.step() < end && !stepped.over()) {
      stop_if_interrupted();
      stepped.advance(std::min(at_once, end - stepped.step()));
      if (plan_.watch) plan_.watch(stepped.energy());
      if (of_stage && stepped.milestone() == stepped.step()) break;
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
  [[nodiscard]] py::dict walls() const {
    py::dict result;
    for (const WallState& wall : simulation().walls()) {
      py::dict state;
      state["position"] = py::make_tuple(wall.place.x, wall.place.y);
      state["velocity"] = py::make_tuple(wall.velocity.x, wall.velocity.y);
      state["force"] = py::make_tuple(wall.force.x, wall.force.y);
      state["moment"] = wall.moment;
      if (!bonded()) {
        state["impulse"] = py::make_tuple(wall.impulse.x, wall.impulse.y);
        state["work"] = wall.work;
      }
      result[py::str(wall.name)] = state;
    }
    return result;
  }
  [[nodiscard]] py::object cell() const {
    const std::optional<CellState> cell = simulation().cell();
    if (!cell) return py::none();
    py::dict state;
    state["width"] = cell->width, state["height"] = cell->height, state["shift"] = cell->shift;
    state["strain"] = py::make_tuple(cell->strain.xx, cell->strain.yy, cell->strain.xy);
    const Voigt stress = voigt_stress(cell->stress);
    state["stress"] = py::make_tuple(stress.xx, stress.yy, stress.xy);
    state["void_ratio"] = cell->void_ratio, state["coordination_number"] = cell->coordination_number;
    return state;
  }
  /// \param wall empty: the cell. \param velocity (x, y), or none
  void steer(const std::string& wall, const std::optional<std::pair<double, double>>& velocity,
             const std::map<std::string, double>& numbers) {
    const std::lock_guard lock(mutex_);
    auto* staged = dynamic_cast<StagedSimulation*>(&simulation());
    if (staged == nullptr)
      bad_input("bonded discs are not steered", "their walls and supports follow the schedules of the case",
                "Give these in the case, or make a case of bodies that collide ([grains] with [bonds])");
    Steering how{.wall = wall};
    if (velocity) how.velocity = Vec2{velocity->first, velocity->second};
    const auto take = [&](const char* name, std::optional<double>& to) {
      if (const auto found = numbers.find(name); found != numbers.end()) to = found->second;
    };
    take("wanted", how.wanted);
    take("xx", how.rate_xx), take("yy", how.rate_yy), take("xy", how.rate_xy);
    take("stress_xx", how.stress_xx), take("stress_yy", how.stress_yy);
    staged->steer(how);
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

void bind_cases(py::module_& module) {
  py::class_<Delivered>(module, "Delivered", made_here()).def("texts", &Delivered::texts).def("page", &Delivered::page);
  module.def("run_verb", run_verb);
  module.def("flags_of_verbs", flags_of_verbs);
  module.def("factor",
             [](const std::string& case_text, const std::string& case_file, const std::shared_ptr<Assembly>& assembly,
                std::vector<std::string> overrides, bool error_bound) {
               return std::make_unique<Factor>(case_text, case_file, assembly, std::move(overrides), error_bound);
             });
  module.def("form_derivatives", form_derivatives_of_case);
  py::class_<Factor>(module, "Factor", made_here())
      .def("solve", &Factor::solve)
      .def("derivatives", &Factor::derivatives)
      .def_property_readonly("unknowns", &Factor::unknowns);
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
      .def("walls", &Steps::walls)
      .def("cell", &Steps::cell)
      .def("steer", &Steps::steer)
      .def_property_readonly("bonded", &Steps::bonded)
      .def_property_readonly("time_step", &Steps::time_step)
      .def_property_readonly("steps", &Steps::steps)
      .def_property_readonly("step", [](const Steps& s) { return s.simulation().step(); })
      .def_property_readonly("time", [](const Steps& s) { return s.simulation().time(); });
}

}  // namespace equidem::python
