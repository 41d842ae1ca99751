// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibrate/engine_table.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "equidem/core/text.hpp"
#include "equidem/material/engine_springs.hpp"

namespace equidem {
namespace {

/// One value, or the two ends of a range.
std::string range_text(double first, double last) {
  return first == last ? fmt::format("{:.9g}", first) : fmt::format("{:.6g} .. {:.6g}", first, last);
}

Results engine_row(const std::string& engine, const std::string& normal, const std::string& tangential,
                   const std::string& unit, const std::string& note) {
  Results row;
  row.add("", "other programs, per metre of depth", "  " + engine).add("", "normal", normal);
  return row.add("", "tangential", tangential).add("", "unit", unit).note(note);
}

}  // namespace

Results engine_springs_results(const Assembly& assembly, const ContactSprings& springs, const SpringConstants& k,
                               std::optional<double> bond_width) {
  Results out;
  if (!springs.uniform() || k.kT < 0) {
    out.line("other programs", k.kT < 0 ? "kT < 0: they have no such springs"
                                        : "springs differ from contact to contact: equidem export writes each");
    return out;
  }
  const auto [least, most] = std::ranges::minmax(assembly.radii);
  const double force = engine_depth;  // N/m of a spring of 1 Pa
  const YadeMaterial small = yade_material(k, least), large = yade_material(k, most);
  const bool bends = springs.bends() && bond_width.value_or(0) > 0;
  const double width = bends ? *bond_width : 1;  // of the bonds, over the diameter of the smaller disc
  const SpringConstants per_area{k.kN / width, k.kT / width};
  const SpringConstants of_small = pfc_parallel_bond(per_area, least, least),
                        of_large = pfc_parallel_bond(per_area, most, most);
  const std::string left_out = bends ? "; without the bending springs" : "";
  const auto pair = [&](const char* normal, const char* tangential) {
    return std::pair(fmt::format("{} = {:.9g}", normal, force * k.kN),
                     fmt::format("{} = {:.9g}", tangential, force * k.kT));
  };
  const auto [k_r, k_s] = pair("k_r", "k_s");
  const auto [kn, kt] = pair("kn", "kt");
  const auto [pfc_kn, pfc_ks] = pair("kn", "ks");
  const bool alike = least == most;
  std::vector<Results> rows;
  rows.push_back(engine_row("LAMMPS bond_coeff, bpm/rotational", k_r, k_s, "N/m",
                            "k_t = k_b = 0; contact points in the middle of the branch" + left_out));
  rows.push_back(engine_row("LAMMPS gran/hooke/history", kn, kt, "N/m", "contacts that may open" + left_out));
  rows.push_back(engine_row("YADE CohFrictMat, FrictMat",
                            fmt::format("young = {}", range_text(large.young, small.young)),
                            fmt::format("poisson = {:.9g}", small.poisson), "Pa, 1",
                            (alike ? "of both bodies"
                                   : fmt::format("young = {:.9g}/r of each body of radius r (m): one material for each "
                                                 "radius",
                                                 force * k.kN)) +
                                left_out));
  rows.push_back(engine_row("PFC linear, linearcbond", pfc_kn, pfc_ks, "N/m", "per bond" + left_out));
  rows.push_back(engine_row(
      "PFC linearpbond", fmt::format("pb_kn = {}", range_text(of_large.kN, of_small.kN)),
      fmt::format("pb_ks = {}", range_text(of_large.kT, of_small.kT)), "Pa/m",
      fmt::format(
          "per area of bond{}{}",
          alike ? ""
                : fmt::format(", kN/({0:.6g} r) and kT/({0:.6g} r) with the smaller radius r of each pair", 2 * width),
          bends ? fmt::format("; pb_rmul = {:.6g}: it resists bending as these do", width)
                : "; it also resists bending, which these springs do not")));
  out.table("", rows);
  out.set("engines/depth", engine_depth);
  out.set("engines/lammps/k_r", force * k.kN).set("engines/lammps/k_s", force * k.kT);
  out.set("engines/lammps/kn", force * k.kN).set("engines/lammps/kt", force * k.kT);
  out.set("engines/yade/young", std::vector<double>{large.young, small.young});
  out.set("engines/yade/young_times_radius", force * k.kN).set("engines/yade/poisson", small.poisson);
  out.set("engines/pfc/kn", force * k.kN).set("engines/pfc/ks", force * k.kT);
  out.set("engines/pfc/pb_kn", std::vector<double>{of_large.kN, of_small.kN});
  out.set("engines/pfc/pb_ks", std::vector<double>{of_large.kT, of_small.kT});
  if (bends) out.set("engines/pfc/pb_rmul", width);
  out.set("engines/radii", std::vector<double>{most, least});
  return out;
}

}  // namespace equidem
