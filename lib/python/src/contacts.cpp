// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts: their springs, stiffness and strengths; collisions of two bodies.
#include <array>
#include <cstdint>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "equidem/assembly/assembly.hpp"
#include "equidem/breakage/calibrate/strength_test.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/random.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/stiffness_matrix.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/statics/number_unknowns.hpp"

#include "module.hpp"

namespace equidem::python {
namespace {

/// \param springs (2): kN and kT of all contacts; (contacts, 2): of each; Pa
ContactSprings springs_of(const Floats& springs) {
  if (springs.ndim() == 1) return ContactSprings(SpringConstants{springs.at(0), springs.at(1)});
  std::vector<SpringConstants> all;
  for (py::ssize_t c = 0; c < springs.shape(0); ++c) all.push_back({springs.at(c, 0), springs.at(c, 1)});
  return ContactSprings(std::move(all));
}

/// kN and kT of every contact, (contacts, 2), Pa.
py::array springs_at_contacts(const Assembly& assembly, double kN, double kT, const std::string& weighting) {
  const ContactSprings springs = contact_springs(assembly, {kN, kT}, enum_from<SpringWeighting>(weighting));
  std::vector<double> numbers;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    numbers.push_back(springs[c].kN);
    numbers.push_back(springs[c].kT);
  }
  return owned(std::move(numbers), {py::ssize_t(assembly.contacts.size()), 2});
}

/// K without supports as blocks in compressed rows: data (blocks, b, b), column of each block, first block of each row.
/// Rotations in rad: rows and columns of a theta times a.
py::tuple stiffness_matrix(const Assembly& assembly, const Floats& springs, const std::string& rotation) {
  StiffnessMatrix matrix;
  DegreesOfFreedom unknowns;
  std::vector<double> data;
  std::vector<std::int32_t> columns, first;
  {
    const LongWork working;
    check(assembly);
    ContactSprings k = springs_of(springs);
    if (const auto prestress = choose_prestress(assembly, k, PrestressChoice::automatic)) k = prestress->springs;
    const ContactGraph graph(assembly);
    unknowns = number_unknowns(assembly, k, derive_effects(assembly, k, enum_from<Rotation>(rotation)), {});
    // rotations that nothing resists have rows of zeros, not of a unit matrix
    unknowns.held.assign(unknowns.held.size(), DegreesOfFreedom::free);
    matrix = assemble_stiffness(assembly, graph, k, unknowns);
    const std::size_t b = static_cast<std::size_t>(matrix.block);
    const auto add = [&](std::size_t column, const double* block, bool transposed) {
      columns.push_back(static_cast<std::int32_t>(column));
      for (std::size_t r = 0; r < b; ++r) {
        for (std::size_t c = 0; c < b; ++c) {
          const double scale = (r == 2 ? unknowns.rotation_scale : 1) * (c == 2 ? unknowns.rotation_scale : 1);
          data.push_back(scale * block[transposed ? c * b + r : r * b + c]);
        }
      }
    };
    for (std::size_t d = 0; d < assembly.size(); ++d) {
      first.push_back(static_cast<std::int32_t>(columns.size()));
      add(d, matrix.diagonal_block(d), false);
      for (const auto& [other, contact] : graph.of(d)) {
        const Contact& joined = assembly.contacts[static_cast<std::size_t>(contact)];
        if (joined.i == joined.j) continue;  // with its own image: in the diagonal block
        add(static_cast<std::size_t>(other), matrix.coupling_block(static_cast<std::size_t>(contact)),
            joined.j == static_cast<std::int32_t>(d));
      }
    }
    first.push_back(static_cast<std::int32_t>(columns.size()));
  }
  const auto blocks = static_cast<py::ssize_t>(columns.size());
  const auto rows = static_cast<py::ssize_t>(first.size());
  return py::make_tuple(owned(std::move(data), {blocks, matrix.block, matrix.block}),
                        owned(std::move(columns), {blocks}), owned(std::move(first), {rows}));
}

/// A free sample between two ends, with the springs of its contacts.
std::unique_ptr<StrengthSample> strength_sample(const std::shared_ptr<Assembly>& assembly, const Floats& springs,
                                                const std::string& axis, double fallen_to,
                                                const std::string& rotation) {
  const LongWork working;
  const StrengthTestOptions options{
      .axis = enum_from<LoadAxis>(axis), .fallen_to = fallen_to, .rotation = enum_from<Rotation>(rotation)};
  return std::make_unique<StrengthSample>(*assembly, springs_of(springs), options);
}

/// (stress, contacts that broke, energy error) of a test.
py::tuple strength_of(const StrengthSample& sample, const std::string& kind, double tension, double shear,
                      double friction, std::optional<double> weibull_modulus, std::uint64_t seed,
                      std::optional<double> notch) {
  const SampleStrength found = without_lock([&] {
    const ContactStrengths strengths = contact_strengths(
        sample.assembly(),
        {.tension = tension, .shear = shear, .friction = friction, .weibull_modulus = weibull_modulus, .seed = seed});
    return sample.strength(enum_from<StrengthTestKind>(kind), strengths, notch);
  });
  return py::make_tuple(found.stress, found.events, found.energy_error);
}

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

}  // namespace

void bind_contacts(py::module_& module) {
  py::class_<StrengthSample>(module, "StrengthSample", made_here())
      .def("strength", strength_of)
      .def_property_readonly("width", &StrengthSample::width);
  module.def("strength_sample", strength_sample);
  module.def("springs_at_contacts", springs_at_contacts);
  module.def("stiffness_matrix", stiffness_matrix);
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
  py::class_<Random>(module, "Random")
      .def(py::init<std::uint64_t>(), py::arg("seed"))
      .def("uniforms",
           [](Random& random, std::size_t count) {
             std::vector<double> numbers(count);
             for (double& number : numbers) number = random.uniform();
             return numbers;
           })
      .def("order", [](Random& random, std::size_t count) {
        std::vector<std::size_t> order(count);
        std::iota(order.begin(), order.end(), 0);
        for (std::size_t k = count; k > 1; --k) std::swap(order[k - 1], order[random.below(k)]);
        return order;
      });
}

}  // namespace equidem::python
