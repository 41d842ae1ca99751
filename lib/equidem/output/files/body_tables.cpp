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
  table.add("disc", a.centres, [&](const Vec2& centre) { return &centre - a.centres.data(); });
  table.add("x_m", a.centres, &Vec2::x).add("y_m", a.centres, &Vec2::y).add("radius_m", a.radii);
  if (!state.motions.empty()) {
    table.add("ux_m", state.motions, [](const DiscMotion& m) { return m.u.x; });
    table.add("uy_m", state.motions, [](const DiscMotion& m) { return m.u.y; });
    table.add("rotation_rad", state.motions, &DiscMotion::theta);
  }
  if (!state.stresses.empty()) {
    table.add("stress_xx_Pa", state.stresses, &Tensor2::xx).add("stress_yy_Pa", state.stresses, &Tensor2::yy);
    table.add("stress_xy_Pa", state.stresses, &Tensor2::xy).add("stress_yx_Pa", state.stresses, &Tensor2::yx);
  }
  if (!a.cell_areas.empty()) table.add("cell_area_m2", a.cell_areas);
  write_csv(path, table, overwrite);
}

void write_contact_csv(const std::filesystem::path& path, const AssemblyState& state, bool overwrite) {
  assert_consistent(state);
  const Assembly& a = state.assembly;
  const auto& contacts = a.contacts;
  Table table;
  table.add("i", contacts, &Contact::i).add("j", contacts, &Contact::j);
  table.add("shift_x", contacts, &Contact::shift_x).add("shift_y", contacts, &Contact::shift_y);
  table.add("branch_x_m", contacts, [&](const Contact& c) { return a.branch(c).x; });
  table.add("branch_y_m", contacts, [&](const Contact& c) { return a.branch(c).y; });
  table.add("lever_i_m", contacts, &Contact::lever_i).add("lever_j_m", contacts, &Contact::lever_j);
  if (const auto& arms = a.contact_arms; !arms.empty()) {
    table.add("normal_x", arms, [](const ContactArms& arm) { return arm.normal.x; });
    table.add("normal_y", arms, [](const ContactArms& arm) { return arm.normal.y; });
    table.add("offset_i_m", arms, &ContactArms::offset_i).add("offset_j_m", arms, &ContactArms::offset_j);
  }
  if (const auto& forces = state.contact_forces; !forces.empty()) {
    std::vector<Vec2> on_i;
    for (std::size_t c = 0; c < contacts.size(); ++c) on_i.push_back(force_on_i(frame_of(a, c), forces[c]));
    table.add("normal_force_N_per_m", forces, &ContactForce::normal);
    table.add("tangential_force_N_per_m", forces, &ContactForce::tangential);
    table.add("force_x_N_per_m", on_i, &Vec2::x).add("force_y_N_per_m", on_i, &Vec2::y);
  }
  if (!state.bending_moments.empty()) table.add("bending_moment_N", state.bending_moments, std::identity());
  write_csv(path, table, overwrite);
}

void write_grain_csv(const std::filesystem::path& path, const WrittenGrains& rows, bool overwrite) {
  const std::span<const Grain> grains = rows.grains;
  assert(rows.groups.size() == grains.size());
  assert(rows.densities.empty() || rows.densities.size() == grains.size());
  const auto any = [&](GrainShape shape) { return std::ranges::find(grains, shape, &Grain::shape) != grains.end(); };
  Table table;
  table.add("grain", grains, [&](const Grain& grain) { return &grain - grains.data(); });
  if (!rows.numbers.empty()) table.add("number", rows.numbers, std::identity());
  table.add("group", rows.groups, std::identity());
  table.add("x_m", grains, [](const Grain& g) { return g.position.x; });
  table.add("y_m", grains, [](const Grain& g) { return g.position.y; });
  table.add("radius_m", grains, &Grain::radius);
  if (any(GrainShape::ellipse)) {
    table.add("short_half_axis_m", grains, [](const Grain& g) {
      return g.shape() == GrainShape::ellipse ? std::optional(g.short_half_axis) : std::nullopt;
    });
  }
  table.add("vx_m_per_s", grains, [](const Grain& g) { return g.velocity.x; });
  table.add("vy_m_per_s", grains, [](const Grain& g) { return g.velocity.y; });
  table.add("spin_rad_per_s", grains, &Grain::spin).add("angle_rad", grains, &Grain::angle);
  if (!rows.densities.empty()) table.add("density_kg_per_m3", rows.densities, std::identity());
  if (rows.period) {
    table.add("period_x_m", grains, [&](const Grain&) { return rows.period->x; });
    table.add("period_y_m", grains, [&](const Grain&) { return rows.period->y; });
  }
  if (any(GrainShape::clump)) {
    table.add("discs_m", grains, [&](const Grain& g) {
      return g.clump >= 0 ? discs_in_a_cell(rows.clumps[static_cast<std::size_t>(g.clump)]) : std::string();
    });
  }
  write_csv(path, table, overwrite);
}

void write_grain_contact_csv(const std::filesystem::path& path, std::span<const GrainContact> contacts,
                             std::span<const Wall> walls, Body body, bool overwrite) {
  const std::string force_unit = std::string("_N") + per_depth(body);
  Table table;
  table.add("i", contacts, &GrainContact::i);
  table.add("j", contacts,
            [](const GrainContact& c) { return c.j >= 0 ? std::optional<std::int64_t>(c.j) : std::nullopt; });
  table.add("wall", contacts, [&](const GrainContact& c) {
    return c.j >= 0 ? std::string() : walls[static_cast<std::size_t>(~c.j)].name;
  });
  table.add("overlap_m", contacts, &GrainContact::overlap).add("closing_m_per_s", contacts, &GrainContact::closing);
  table.add("normal_x", contacts, [](const GrainContact& c) { return c.normal.x; });
  table.add("normal_y", contacts, [](const GrainContact& c) { return c.normal.y; });
  table.add("normal_force" + force_unit, contacts, &GrainContact::normal_force);
  table.add("tangential_force" + force_unit, contacts, &GrainContact::tangential_force);
  table.add("mode", contacts, &GrainContact::mode).add("steps", contacts, &GrainContact::steps);
  write_csv(path, table, overwrite);
}

void write_bond_csv(const std::filesystem::path& path, std::span<const GrainBond> bonds,
                    const ContactStrengths& strengths, bool overwrite) {
  Table table;
  table.add("i", bonds, &GrainBond::i).add("j", bonds, &GrainBond::j);
  table.add("normal_dashpot", bonds, &GrainBond::normal_dashpot);
  table.add("tangential_dashpot", bonds, &GrainBond::tangential_dashpot);
  table.add("rolling_dashpot", bonds, &GrainBond::rolling_dashpot);
  table.add("normal_spring", bonds, &GrainBond::normal_spring);
  table.add("tangential_spring", bonds, &GrainBond::tangential_spring);
  table.add("bending_spring", bonds, &GrainBond::bending_spring);
  if (!strengths.tension.empty())
    table.add("tension", strengths.tension, std::identity()).add("shear", strengths.shear, std::identity());
  write_csv(path, table, overwrite);
}

}  // namespace equidem
