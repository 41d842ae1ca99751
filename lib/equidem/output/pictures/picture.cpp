// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/pictures/picture.hpp"

#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
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
  draw_supports_and_loads(canvas, scene);
  draw_legends(canvas, scene);
  return canvas.finish();
}

}  // namespace

PictureResult write_picture(const std::filesystem::path& folder, const std::string& name, const AssemblyState& state,
                            const PictureOptions& options, bool overwrite) {
  const PictureScene scene = plan_scene(state, options);
  const auto svg = folder / (name + ".svg");
  const auto png = folder / (name + ".png");
  check_writable(svg, overwrite);
  check_writable(png, overwrite);
  write_file(svg, draw(scene, PageFormat::svg), overwrite);
  write_file(png, draw(scene, PageFormat::png), overwrite);
  return {.width = options.width,
          .height = pixel_height(scene),
          .displacement_scale = scene.displacement_scale,
          .caption = scene.caption,
          .files = {svg, png}};
}

}  // namespace equidem
