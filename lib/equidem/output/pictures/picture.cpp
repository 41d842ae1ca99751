// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/pictures/picture.hpp"

#include <cmath>
#include <map>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/page/drawn_figures.hpp"
#include "equidem/output/pictures/canvas.hpp"
#include "equidem/output/pictures/scene.hpp"

namespace equidem {
namespace {

int pixel_height(const PictureScene& scene) {
  return static_cast<int>(std::ceil(scene.frame.height * scene.frame.pixels));
}

std::string draw(const PictureScene& scene, PageFormat page) {
  Canvas canvas(page, scene.options.width, pixel_height(scene), scene.frame.pixels);
  draw_discs(canvas, scene);
  draw_force_chains(canvas, scene);
  draw_cracks(canvas, scene);
  draw_supports_and_loads(canvas, scene);
  draw_gauges(canvas, scene);
  draw_legends(canvas, scene);
  return canvas.finish();
}

}  // namespace

std::vector<DrawnLoad> drawn_loads(const Assembly& assembly, const LoadCase& loads) {
  std::map<std::int32_t, Vec2> forces;
  for (const Load& load : loads) {
    const DiscGroup& pulled = group(assembly, load.group);
    for (std::size_t k = 0; k < pulled.discs.size(); ++k) {
      double share = 1;
      if (load.kind == LoadKind::total) share = 1 / static_cast<double>(pulled.discs.size());
      if (load.kind == LoadKind::traction) share = pulled.tributary_lengths.at(k);
      forces[pulled.discs[k]] += share * load.force;
    }
  }
  std::vector<DrawnLoad> drawn;
  for (const auto& [disc, force] : forces) drawn.push_back({disc, force});
  return drawn;
}

std::vector<DrawnSupport> drawn_supports(const Assembly& assembly, std::span<const Support> supports) {
  std::map<std::int32_t, DrawnSupport> held;
  for (const Support& support : supports) {
    for (const std::int32_t disc : group(assembly, support.group).discs) {
      DrawnSupport& drawn = held[disc];
      drawn.disc = disc;
      drawn.x = drawn.x || support.ux.has_value();
      drawn.y = drawn.y || support.uy.has_value();
    }
  }
  std::vector<DrawnSupport> all;
  for (const auto& [disc, drawn] : held)
    if (drawn.x || drawn.y) all.push_back(drawn);
  return all;
}

PictureResult write_picture(const std::filesystem::path& folder, const std::string& name, const AssemblyState& state,
                            const PictureOptions& options, bool overwrite) {
  const PictureScene scene = plan_scene(state, options);
  const auto svg = folder / (name + ".svg");
  const auto png = folder / (name + ".png");
  check_writable(svg, overwrite);
  check_writable(png, overwrite);
  write_file(svg, draw(scene, PageFormat::svg), overwrite);
  write_file(png, draw(scene, PageFormat::png), overwrite);
  DrawnFigures::add({.name = name,
                     .title = fmt::format("{}{}{}", options.title, options.title.empty() ? "" : ": ", scene.caption),
                     .file = png});
  return {.width = options.width,
          .height = pixel_height(scene),
          .displacement_scale = scene.displacement_scale,
          .caption = scene.caption,
          .files = {svg, png}};
}

}  // namespace equidem
