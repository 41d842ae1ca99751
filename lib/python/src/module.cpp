// SPDX-License-Identifier: GPL-3.0-or-later
#include "module.hpp"

#include <atomic>
#include <string>

#include "equidem/core/error.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/output/results.hpp"

namespace equidem::python {
namespace {

bool on_main_thread() {
  const py::module_ threading = py::module_::import("threading");
  return threading.attr("current_thread")().is(threading.attr("main_thread")());
}

const char* class_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::computation_failed:
    case ErrorKind::out_of_memory:
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

std::atomic<bool> progress_is_wanted{true};

void show_progress(bool shown) {
  progress_is_wanted = shown;
  set_progress_shown(shown);
}

}  // namespace

bool progress_wanted() {
  return progress_is_wanted;
}

KeptSettings::KeptSettings() : threads_(thread_count()) {}

KeptSettings::~KeptSettings() {
  if (thread_count() != threads_) set_thread_count(threads_);
  set_progress_shown(progress_wanted());
}

LongWork::LongWork() : catcher_(on_main_thread() ? std::make_unique<InterruptCatcher>() : nullptr) {}

}  // namespace equidem::python

PYBIND11_MODULE(_core, module) {
  using namespace equidem::python;
  module.doc() = "The compiled part of equidem.";
  module.attr("version") = equidem::library_version();
  module.def("set_threads", &equidem::set_thread_count);
  module.def("threads", &equidem::thread_count);
  module.def("show_progress", &show_progress);
  module.def("display_progress_by", [](const py::object& display) {
    if (display.is_none()) return equidem::set_progress_display({});
    // never destroyed: the interpreter may be gone by then
    auto* kept = new py::object(display);
    equidem::set_progress_display([kept](const std::string& line) {
      const py::gil_scoped_acquire locked;
      try {
        (*kept)(line);
      } catch (py::error_already_set& error) {
        error.discard_as_unraisable("progress");
      }
    });
  });
  py::register_exception_translator(translate);
  bind_assembly(module);
  bind_contacts(module);
  bind_cases(module);
}
