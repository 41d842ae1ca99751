// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// PFC 2D: the linear contact bond model acts in the middle of the gap, as the radii place it; lin_mode 1 takes normal
/// forces from increments, so that bonds carry none at the start.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "equidem/core/text.hpp"
#include "equidem/grains/scene/pair_options.hpp"
#include "equidem/output/export/engine_files.hpp"
#include "equidem/output/export/engine_formulas.hpp"

namespace equidem {
namespace {

class PfcWriter {
 public:
  explicit PfcWriter(const EngineModel& model) : model_(model) {}

  [[nodiscard]] std::string commands() const {
    std::string text = "; Written by equidem. SI units, masses and forces per metre of depth. PFC 2D, 6 or later.\n";
    text += "model new\nmodel large-strain on\n";
    text += domain();
    text += model_.bonded ? "" : properties();
    text += balls() + walls();
    if (model_.bonded) text += bonds();
    line(text, "model gravity {} {}", exact(model_.gravity.x), exact(model_.gravity.y));
    line(text, "model mechanical timestep fix {}", exact(model_.time_step));
    text += "; Motion\n";
    text += model_.to_rest ? to_rest() : fmt::format("model cycle {}\n", steps_of(model_));
    return text + "model save 'equidem'\n";
  }

 private:
  template <typename... Values>
  static void line(std::string& text, fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(text), format, std::forward<Values>(values)...);
    text += '\n';
  }

  [[nodiscard]] double radius(std::size_t body) const {
    return model_.bonded ? model_.lever_radii[body] : model_.bodies[body].radius;
  }

  /// The extent with a tenth, at least four diameters, around.
  [[nodiscard]] std::pair<Vec2, Vec2> extent() const {
    Vec2 low = model_.bodies.front().position, high = low;
    double around = 0;
    for (std::size_t k = 0; k < model_.bodies.size(); ++k) {
      const Vec2 at = model_.bodies[k].position;
      low = {std::min(low.x, at.x), std::min(low.y, at.y)}, high = {std::max(high.x, at.x), std::max(high.y, at.y)};
      around = std::max(around, 8 * radius(k));
    }
    around = std::max(around, 0.1 * std::max(high.x - low.x, high.y - low.y));
    return {low - Vec2{around, around}, high + Vec2{around, around}};
  }

  [[nodiscard]] std::string domain() const {
    const auto [low, high] = extent();
    return fmt::format("model domain extent {} {} {} {} condition stop\n", exact(low.x), exact(high.x), exact(low.y),
                       exact(high.y));
  }

  /// The linear model: its dashpots are 2 beta sqrt(m k), m the reduced mass along the normal and across it.
  [[nodiscard]] std::string properties() const {
    const EngineBody& body = model_.bodies.front();
    const PairProperties& pair = model_.between(body.kind, body.kind);
    const double zeta = damping_ratio(NormalLaw::linear_dashpot, pair);
    const double ratio = pair.friction > 0 ? pair.tangential_ratio : 0;
    const double along = pair.tangential_damping * std::sqrt(tangential_mass_share(model_.body));
    return fmt::format(
        "contact cmat default model linear property kn {} ks {} fric {} dp_nratio {} dp_sratio {} dp_mode {}\n",
        exact(pair.stiffness), exact(ratio * pair.stiffness), exact(pair.friction), exact(zeta), exact(along),
        pair.end == ContactEnd::at_zero_force ? 3 : 2);
  }

  [[nodiscard]] std::string balls() const {
    std::string text;
    for (std::size_t k = 0; k < model_.bodies.size(); ++k) {
      const EngineBody& body = model_.bodies[k];
      line(text, "ball create id {} position {} {} radius {}", k + 1, exact(body.position.x), exact(body.position.y),
           exact(radius(k)));
    }
    for (std::size_t k = 0; k < model_.bodies.size(); ++k) {
      const EngineBody& body = model_.bodies[k];
      const double area = std::numbers::pi * radius(k) * radius(k);
      text += fmt::format("ball attribute density {}", exact(body.inertia.mass / area));
      if (body.velocity != Vec2{} || body.spin != 0)
        text +=
            fmt::format(" velocity {} {} spin {}", exact(body.velocity.x), exact(body.velocity.y), exact(body.spin));
      if (body.load.force != Vec2{})
        text += fmt::format(" force-applied {} {}", exact(body.load.force.x), exact(body.load.force.y));
      if (body.load.moment != 0) text += fmt::format(" moment-applied {}", exact(body.load.moment));
      line(text, " range id {}", k + 1);
      std::string fixed;
      if (body.held[0]) fixed += " velocity-x";
      if (body.held[1]) fixed += " velocity-y";
      if (body.held[2]) fixed += " spin";
      if (!fixed.empty()) line(text, "ball fix{} range id {}", fixed, k + 1);
    }
    line(text, "ball attribute damp {}", exact(model_.local_damping));
    return text;
  }

  /// Lines across the whole domain.
  [[nodiscard]] std::string walls() const {
    const auto [low, high] = extent();
    const double reach = norm(high - low);
    std::string text;
    for (const Wall& wall : model_.walls) {
      const Vec2 along = perpendicular(wall.normal);
      const Vec2 from = wall.point - reach * along, to = wall.point + reach * along;
      line(text, "wall create vertices {} {} {} {}", exact(from.x), exact(from.y), exact(to.x), exact(to.y));
    }
    return text;
  }

  [[nodiscard]] std::string bonds() const {
    if (model_.bonds.empty()) return "";
    const SpringConstants springs = model_.bonds.front().springs;
    const std::string gap = exact(std::max(0.0, model_.largest_gap));
    std::string text =
        fmt::format("contact cmat default model linearcbond property kn {} ks {} lin_mode 1 proximity {}\n",
                    exact(springs.kN), exact(springs.kT), gap);
    text += "model clean all\n";
    line(text, "contact method bond gap {}", gap);
    return text + "contact property cb_tenf 1e300 cb_shearf 1e300\n";
  }

  /// Prescribed displacements as velocities over the first steps.
  [[nodiscard]] std::string to_rest() const {
    constexpr int ramp = 1000;
    const double time = ramp * model_.time_step;
    std::string given, released;
    for (std::size_t k = 0; k < model_.bodies.size(); ++k) {
      const auto& held = model_.bodies[k].held;
      if (held[0].value_or(0) == 0 && held[1].value_or(0) == 0 && held[2].value_or(0) == 0) continue;
      for (const auto& [component, name] :
           {std::pair(0, "velocity-x"), std::pair(1, "velocity-y"), std::pair(2, "spin")}) {
        if (held[static_cast<std::size_t>(component)].value_or(0) == 0) continue;
        line(given, "ball attribute {} {} range id {}", name, exact(*held[static_cast<std::size_t>(component)] / time),
             k + 1);
        line(released, "ball attribute {} 0 range id {}", name, k + 1);
      }
    }
    if (!given.empty()) given += fmt::format("model cycle {}\n{}", ramp, released);
    return given + "model solve ratio-maximum 1e-10\n";
  }

  const EngineModel& model_;
};

}  // namespace

std::vector<EngineFile> pfc_files(const EngineModel& model) {
  return {{"equidem.dat", PfcWriter(model).commands()}, readme_of(model, Engine::pfc)};
}

}  // namespace equidem
