// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Spheres on a floor under a law of normal contact, and the law alone, without dimensions: the scenes and laws of
/// Fujioka & Ushijima (2005), which may let bodies pass through one another.
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "equidem/contact/laws/normal_law.hpp"
#include "equidem/core/names.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/material/inertia.hpp"

#include "module.hpp"

namespace equidem::python {
namespace {

/// Equal spheres of density 1 kg/m³ over a floor at y = 0.
class Spheres {
 public:
  Spheres(const Floats& centres, const Floats& velocities, double radius, const std::string& law, double stiffness,
          double restitution, bool pulls, double gravity, double time_step, bool refuse_crossing)
      : simulation_(scene_of(centres, velocities, radius, stiffness, restitution, pulls, gravity),
                    {.law = enum_from<NormalLaw>(law), .time_step = time_step, .refuse_crossing = refuse_crossing}) {}

  void advance(std::int64_t steps) { simulation_.advance(steps); }
  [[nodiscard]] std::int64_t step() const { return simulation_.step(); }
  /// [x, y, v_x, v_y] of a sphere.
  [[nodiscard]] std::array<double, 4> sphere(std::size_t k) const {
    const Grain grain = simulation_.grains().at(k);
    return {grain.position.x, grain.position.y, grain.velocity.x, grain.velocity.y};
  }
  /// (i, j) of the contacts of the last step; j < 0: the floor.
  [[nodiscard]] std::vector<std::pair<std::int32_t, std::int32_t>> contacts() const {
    std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
    for (const GrainContact& contact : simulation_.contacts()) pairs.emplace_back(contact.i, contact.j);
    return pairs;
  }
  [[nodiscard]] const GrainCounters& counters() const { return simulation_.counters(); }

 private:
  static GrainScene scene_of(const Floats& centres, const Floats& velocities, double radius, double stiffness,
                             double restitution, bool pulls, double gravity) {
    GrainScene scene;
    scene.walls.emplace_back();
    scene.gravity = {0, -gravity};
    scene.pairs = {PairProperties{.dimensionless = stiffness,
                                  .restitution = restitution,
                                  .end = pulls ? ContactEnd::at_zero_overlap : ContactEnd::at_zero_force}};
    for (py::ssize_t k = 0; k < centres.shape(0); ++k) {
      scene.grains.push_back({.position = {centres.at(k, 0), centres.at(k, 1)},
                              .radius = radius,
                              .inertia = inertia_of(radius, 1, Body::sphere),
                              .velocity = {velocities.at(k, 0), velocities.at(k, 1)}});
    }
    return scene;
  }

  GrainSimulation simulation_;
};

/// A law without dimensions: the change of the closing speed and the shift of the depth in a step.
class Law {
 public:
  Law(const std::string& name, double stiffness, double restitution)
      : law_(enum_from<NormalLaw>(name)), stiffness_(stiffness) {
    const LawDescription& law = describe(law_);
    if (law.kind == LawKind::simultaneous) return;
    const double c = law.dissipation(restitution, ContactEnd::at_zero_overlap);
    dissipation_ = law.kind == LawKind::map ? c : c * std::sqrt(stiffness);
  }

  /// (change, shift) \param first whether the contact begins
  [[nodiscard]] std::pair<double, double> step(double depth, double closing, bool first) const {
    return visit_law(law_, [&]<class Given>(std::type_identity<Given>) -> std::pair<double, double> {
      const ContactStep made = one<Given>(depth, closing, first);
      return {made.change, made.shift};
    });
  }
  /// Sum of the changes at all places, which takes as long as the law.
  [[nodiscard]] double sum(const Floats& depths, const Floats& closings, int repeats) const {
    return visit_law(law_, [&]<class Given>(std::type_identity<Given>) {
      const double *const depth = depths.data(), *const closing = closings.data();
      double sum = 0;
      for (int r = 0; r < repeats; ++r)
        for (py::ssize_t k = 0; k < depths.size(); ++k)
          sum += one<Given>(depth[k], closing[k], closing[k] >= depth[k]).change;
      return sum;
    });
  }

 private:
  template <class Given>
  [[nodiscard]] ContactStep one(double depth, double closing, bool first) const {
    if constexpr (Given::facts.kind == LawKind::force)
      return force_step<Given>(depth, closing, stiffness_, dissipation_, true);
    if constexpr (Given::facts.kind == LawKind::map)
      return Given::step(depth, closing, stiffness_, dissipation_, first);
    return {};
  }

  NormalLaw law_;
  double stiffness_, dissipation_ = 0;
};

}  // namespace

void bind_collisions(py::module_& module) {
  py::class_<GrainCounters>(module, "GrainCounters", made_here())
      .def_readonly("evaluations", &GrainCounters::evaluations)
      .def_readonly("contacts", &GrainCounters::contacts)
      .def_readonly("sweeps", &GrainCounters::sweeps);
  py::class_<Spheres>(module, "Spheres")
      .def(py::init<const Floats&, const Floats&, double, const std::string&, double, double, bool, double, double,
                    bool>(),
           py::arg("centres"), py::arg("velocities"), py::arg("radius"), py::arg("law"), py::arg("stiffness"),
           py::arg("restitution"), py::arg("pulls"), py::arg("gravity"), py::arg("time_step"),
           py::arg("refuse_crossing"))
      .def("advance", &Spheres::advance)
      .def("sphere", &Spheres::sphere)
      .def("contacts", &Spheres::contacts)
      .def_property_readonly("step", &Spheres::step)
      .def_property_readonly("counters", [](const Spheres& spheres) { return spheres.counters(); });
  py::class_<Law>(module, "Law")
      .def(py::init<const std::string&, double, double>(), py::arg("name"), py::arg("stiffness"),
           py::arg("restitution"))
      .def("step", &Law::step)
      .def("sum", &Law::sum);
}

}  // namespace equidem::python
