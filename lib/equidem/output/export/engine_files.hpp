// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Numbers and schedules as text that other engines read.
/// Files that other engines run.
#pragma once

#include <string>
#include <vector>

#include "equidem/motion/schedule.hpp"
#include "equidem/output/export/engine_model.hpp"

namespace equidem {

/// A number in the shortest form that reads back to the same bits.
std::string exact(double value);

/// A schedule as a formula that LAMMPS and Python read, with abs, sin and cos.
/// \param time the name of the time in it, s
std::string formula_of(const Schedule& schedule, const std::string& time);

struct EngineFile {
  std::string name;
  std::string text;
};

/// LAMMPS: in.equidem, assembly.data, and the loads where bodies have some. Bonds: BPM's bpm/rotational with a bond
/// type for each pair of kN and kT. Grains: gran/hooke/history, or, where dashpots or groups differ, the style granular
/// (LAMMPS of 2023 or later).
/// \param model carried by LAMMPS (require_carried)
std::vector<EngineFile> lammps_files(const EngineModel& model);

/// YADE: run_equidem.py. Bonds: CohFrictMat with kn and ks of each, bodies of the radii that place the contact points.
/// Grains: FrictMat, Cundall and Strack's law; ViscElMat where bodies of one mass have dashpots.
/// \param model carried by YADE
std::vector<EngineFile> yade_files(const EngineModel& model);

/// README: model, units and depth, how to start.
EngineFile readme_of(const EngineModel& model, Engine engine);

/// The steps of a run: of its duration; to rest at most so many, after about fifty periods of the longest wave.
std::int64_t steps_of(const EngineModel& model);

/// N/m: the largest load, weight, or force of a bond that is stretched by a prescribed displacement; the measure of the
/// unbalanced force at rest.
double force_scale(const EngineModel& model);

}  // namespace equidem
