// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/body_tables.hpp"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "equidem/core/text.hpp"
#include "equidem/grains/scene/grain_file.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/histories.hpp"

namespace equidem {
namespace {

std::string discs_in_a_cell(const Clump& clump) {
  const auto numbers = [](const Clump::Disc& d) { return fmt::format("{} {} {}", d.offset.x, d.offset.y, d.radius); };
  return joined(clump.discs, numbers, "; ");
}

}  // namespace

void write_disc_csv(const std::filesystem::path& path, const AssemblyState& state, bool overwrite) {
  assert_consistent(state);
  const Assembly& a = state.assembly;
  Table table;
  table.view("disc", a.centres, [&](const Vec2& centre) { return &centre - a.centres.data(); });
  table.view("x_m", a.centres, &Vec2::x).view("y_m", a.centres, &Vec2::y).view("radius_m", a.radii, std::identity());
  if (!state.motions.empty()) {
    table.view("ux_m", state.motions, [](const DiscMotion& m) { return m.u.x; });
    table.view("uy_m", state.motions, [](const DiscMotion& m) { return m.u.y; });
    table.view("rotation_rad", state.motions, &DiscMotion::theta);
  }
  if (!state.stresses.empty()) {
    table.view("stress_xx_Pa", state.stresses, &Tensor2::xx).view("stress_yy_Pa", state.stresses, &Tensor2::yy);
    table.view("stress_xy_Pa", state.stresses, &Tensor2::xy).view("stress_yx_Pa", state.stresses, &Tensor2::yx);
  }
  if (!a.cell_areas.empty()) table.view("cell_area_m2", a.cell_areas, std::identity());
  write_csv(path, table, overwrite);
}

void write_contact_csv(const std::filesystem::path& path, const AssemblyState& state, bool overwrite) {
  assert_consistent(state);
  const Assembly& a = state.assembly;
  const auto& contacts = a.contacts;
  Table table;
  table.view("i", contacts, &Contact::i).view("j", contacts, &Contact::j);
  table.view("shift_x", contacts, &Contact::shift_x).view("shift_y", contacts, &Contact::shift_y);
  table.view("branch_x_m", contacts, [&](const Contact& c) { return a.branch(c).x; });
  table.view("branch_y_m", contacts, [&](const Contact& c) { return a.branch(c).y; });
  table.view("lever_i_m", contacts, &Contact::lever_i).view("lever_j_m", contacts, &Contact::lever_j);
  if (const auto& arms = a.contact_arms; !arms.empty()) {
    table.view("normal_x", arms, [](const ContactArms& arm) { return arm.normal.x; });
    table.view("normal_y", arms, [](const ContactArms& arm) { return arm.normal.y; });
    table.view("offset_i_m", arms, &ContactArms::offset_i).view("offset_j_m", arms, &ContactArms::offset_j);
  }
  const auto& forces = state.contact_forces;
  const auto on_i = [&](const ContactForce& force) {
    return force_on_i(frame_of(a, static_cast<std::size_t>(&force - forces.data())), force);
  };
  if (!forces.empty()) {
    table.view("normal_force_N_per_m", forces, &ContactForce::normal);
    table.view("tangential_force_N_per_m", forces, &ContactForce::tangential);
    table.view("force_x_N_per_m", forces, [&](const ContactForce& force) { return on_i(force).x; });
    table.view("force_y_N_per_m", forces, [&](const ContactForce& force) { return on_i(force).y; });
  }
  if (!state.bending_moments.empty()) table.view("bending_moment_N", state.bending_moments, std::identity());
  write_csv(path, table, overwrite);
}

void write_grain_csv(const std::filesystem::path& path, const WrittenGrains& rows, bool overwrite) {
  const std::span<const Grain> grains = rows.grains;
  assert(rows.groups.size() == grains.size());
  assert(rows.densities.empty() || rows.densities.size() == grains.size());
  const auto any = [&](GrainShape shape) { return std::ranges::find(grains, shape, &Grain::shape) != grains.end(); };
  Table table;
  table.view("grain", grains, [&](const Grain& grain) { return &grain - grains.data(); });
  if (!rows.numbers.empty()) table.view("number", rows.numbers, std::identity());
  table.view("group", rows.groups, std::identity());
  table.view("x_m", grains, [](const Grain& g) { return g.position.x; });
  table.view("y_m", grains, [](const Grain& g) { return g.position.y; });
  table.view("radius_m", grains, &Grain::radius);
  if (any(GrainShape::ellipse)) {
    table.view("short_half_axis_m", grains, [](const Grain& g) {
      return g.shape() == GrainShape::ellipse ? std::optional(g.short_half_axis) : std::nullopt;
    });
  }
  table.view("vx_m_per_s", grains, [](const Grain& g) { return g.velocity.x; });
  table.view("vy_m_per_s", grains, [](const Grain& g) { return g.velocity.y; });
  table.view("spin_rad_per_s", grains, &Grain::spin).view("angle_rad", grains, &Grain::angle);
  if (!rows.densities.empty()) table.view("density_kg_per_m3", rows.densities, std::identity());
  if (rows.period) {
    table.view("period_x_m", grains, [&](const Grain&) { return rows.period->x; });
    table.view("period_y_m", grains, [&](const Grain&) { return rows.period->y; });
  }
  if (any(GrainShape::clump)) {
    table.view("discs_m", grains, [&](const Grain& g) {
      return g.clump >= 0 ? discs_in_a_cell(rows.clumps[static_cast<std::size_t>(g.clump)]) : std::string();
    });
  }
  write_csv(path, table, overwrite);
}

void write_grain_contact_csv(const std::filesystem::path& path, std::span<const GrainContact> contacts,
                             std::span<const Wall> walls, Body body, bool overwrite) {
  const std::string force_unit = std::string("_N") + per_depth(body);
  Table table;
  table.view("i", contacts, &GrainContact::i);
  table.view("j", contacts,
             [](const GrainContact& c) { return c.j >= 0 ? std::optional<std::int64_t>(c.j) : std::nullopt; });
  table.view("wall", contacts, [&](const GrainContact& c) {
    return c.j >= 0 ? std::string() : walls[static_cast<std::size_t>(~c.j)].name;
  });
  table.view("overlap_m", contacts, &GrainContact::overlap).view("closing_m_per_s", contacts, &GrainContact::closing);
  table.view("normal_x", contacts, [](const GrainContact& c) { return c.normal.x; });
  table.view("normal_y", contacts, [](const GrainContact& c) { return c.normal.y; });
  table.view("normal_force" + force_unit, contacts, &GrainContact::normal_force);
  table.view("tangential_force" + force_unit, contacts, &GrainContact::tangential_force);
  if (std::ranges::any_of(contacts, [](const GrainContact& c) { return c.moment != 0; }))
    table.view(body == Body::disc ? "rolling_moment_N" : "rolling_moment_N_m", contacts, &GrainContact::moment);
  table.view("mode", contacts, &GrainContact::mode).view("steps", contacts, &GrainContact::steps);
  write_csv(path, table, overwrite);
}

void write_bond_csv(const std::filesystem::path& path, std::span<const GrainBond> bonds,
                    const ContactStrengths& strengths, bool overwrite) {
  Table table;
  table.view("i", bonds, &GrainBond::i).view("j", bonds, &GrainBond::j);
  for (const BondProperty& property : bond_properties()) table.view(property.name, bonds, property.value);
  if (!strengths.tension.empty())
    table.view("tension", strengths.tension, std::identity()).view("shear", strengths.shear, std::identity());
  write_csv(path, table, overwrite);
}

}  // namespace equidem
