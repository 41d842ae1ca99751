// SPDX-License-Identifier: GPL-3.0-or-later
#include <string>
#include <utility>
#include <variant>

#include <pybind11/stl.h>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/given.hpp"

#include "case_inputs.hpp"
#include "result.hpp"
#include "verb_run.hpp"

namespace equidem::python {
namespace {

/// A result as it was delivered, which a page can be made of.
struct Delivered {
  Delivery delivery;

  /// The page; its case and figures are written into the folder.
  [[nodiscard]] std::string page(const std::string& folder) const {
    const LongWork working;
    return delivery.page_drawn_in(folder);
  }
};

/// Carry out a verb. Returns (JSON of the result, arrays, assembly or None, Delivered).
py::tuple run_verb(const std::string& verb, const std::string& case_text, const std::string& case_file,
                   const std::shared_ptr<Assembly>& assembly, std::vector<std::string> overrides,
                   const std::vector<std::string>& options) {
  const CaseInputs inputs(case_text, case_file, assembly, std::move(overrides));
  Delivery delivery;
  std::string json;
  {
    const LongWork working;
    delivery = VerbRun(verb, inputs.case_file(), inputs.overrides(), options)(Arrays::wanted);
    json = delivery.json();
  }
  const py::dict arrays = arrays_of(delivery.arrays);
  const auto made = std::const_pointer_cast<Assembly>(delivery.assembly);
  return py::make_tuple(json, arrays, made, Delivered{std::move(delivery)});
}

}  // namespace

py::dict arrays_of(const std::vector<ResultArray>& arrays) {
  py::dict result;
  for (const ResultArray& array : arrays) {
    const auto rows = static_cast<py::ssize_t>(array.rows), columns = static_cast<py::ssize_t>(array.columns);
    const py::array made = std::visit(
        [&](const auto* first) {
          const auto size = static_cast<py::ssize_t>(sizeof(*first));
          const py::ssize_t stride = static_cast<py::ssize_t>(array.stride) * size;
          return columns == 1 ? view(array.owner, first, {rows}, {stride})
                              : view(array.owner, first, {rows, columns}, {stride, size});
        },
        array.numbers);
    result[py::str(array.name)] = py::make_tuple(made, array.unit);
  }
  return result;
}

void bind_verbs(py::module_& module) {
  py::class_<Delivered>(module, "Delivered").def("page", &Delivered::page);
  module.def("run_verb", run_verb);
  module.def("case_reference", case_file_page);
}

}  // namespace equidem::python
