// SPDX-License-Identifier: GPL-3.0-or-later
#include <new>

#include "equidem/core/error.hpp"

#include "module.hpp"

namespace equidem::python {
namespace {

const char* class_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::computation_failed:
      return "ComputationFailed";
    case ErrorKind::bad_input:
      return "BadInput";
    case ErrorKind::interrupted:
      return "Interrupted";
  }
  return "";
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const Error& error) {
    const py::object type = py::module_::import("equidem.errors").attr(class_of(error.kind()));
    const py::object made = type(error.problem(), error.why(), error.remedy(), error.where());
    PyErr_SetObject(type.ptr(), made.ptr());
  }
}

}  // namespace

void translate_errors() {
  py::register_exception_translator(translate);
}

}  // namespace equidem::python
