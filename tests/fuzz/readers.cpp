// SPDX-License-Identifier: GPL-3.0-or-later
#include "readers.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <utility>

#include "equidem/assembly/files.hpp"
#include "equidem/assembly/import/particle_table.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/casefile/assembly/case.hpp"
#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/casefile/packing/pack_case.hpp"
#include "equidem/casefile/study/study_case.hpp"
#include "equidem/core/file.hpp"
#include "equidem/grains/scene/grain_file.hpp"
#include "equidem/motion/schedule.hpp"
#include "equidem/output/files/checkpoint.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/frames.hpp"
#include "equidem/packing/size_distribution.hpp"

namespace equidem::fuzz {
namespace {

namespace fs = std::filesystem;

/// Without the temporary file and the rename of write_file, which cost most of the time here.
fs::path put(const fs::path& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
  return path;
}

void check_read_back(const std::string& echoed, const std::string& again) {
  if (echoed != again) throw std::logic_error("the accepted case does not read back");
}

const std::string springs = "schema = \"equidem-springs/1\"\ntitle = \"springs\"\n[springs]\nkN = 1.0e9\nkT = 0.5e9\n";
const std::string springs_of_material =
    "schema = \"equidem-springs/1\"\n[springs]\nkN = 8.9e8\nkT = 1.2e8\nweighting = \"contact_density\"\n";
const std::string case_of_springs =
    "schema = \"equidem/1\"\nsprings = \"springs.toml\"\n[assembly]\nkind = \"hexagonal\"\ncolumns = 3\nrows = 3\n"
    "radius = 0.005\n[test]\nkind = \"uniaxial_tension\"\nstress = 1.0e6\n";
const std::string strengths =
    "schema = \"equidem-strength/1\"\n[strength]\ntension = 4.0e6\nshear = 8.0e6\nbond_length = \"smaller_diameter\"\n";
const std::string case_of_bonds =
    "schema = \"equidem/1\"\nstrength = \"strength.toml\"\n[grains]\ndensity = 2000.0\npath = "
    "\"three.csv\"\n[bonds]\npath = "
    "\"bonds.csv\"\nnormal_spring = 1.0e6\n[collisions]\nlaw = \"linear_dashpot\"\nrestitution = 0.5\nstiffness = "
    "1.0e6\n[run]\nduration = 1.0e-3\n";
const std::string three_grains = "x,y,radius\n0,0,0.5\n1,0,0.5\n2,0,0.5\n";
const std::string case_of_frequencies =
    "schema = \"equidem/1\"\n[assembly]\nkind = \"hexagonal\"\ncolumns = 2\nrows = 2\nradius = 0.01\nperiodic = true\n"
    "[springs]\nkN = 1.0e9\nkT = 0.5e9\n[viscoelastic]\nnormal = \"table\"\npath = \"measured.csv\"\n";
const std::string frequencies =
    "frequency,kN_storage,kN_loss,kT_storage,kT_loss\n1,1.0e9,1.0e7,0.50e9,0.5e7\n10,1.1e9,4.0e7,0.55e9,2.0e7\n";
const std::string spreadsheet =
    "\"x [mm]\";\"y [mm]\";label;\"d [mm]\"\r\n0,5;0,5;\"a;b\";1\r\n1,5;0,5;\"c\"\"d\";1\r\n";
const std::string study =
    "schema = \"equidem/1\"\n[study]\nverb = \"solve\"\ncase = \"block.toml\"\nmeasure = \"poisson_ratio\"\n"
    "truth = \"known\"\nvalue = 0.125\n[[vary]]\nkey = \"assembly.rows, assembly.columns\"\nvalues = [9, 17, 33]\n"
    "[[vary]]\nkey = \"springs.kT\"\nvalues = [0.5, 1e8]\nrefines = \"not\"\n";
const std::string periodic_assembly =
    R"({"schema": "equidem-assembly/1", "cell": [1.0, 1.0], "discs": [[0, 0, 0.5]],)"
    R"( "contacts": [[0, 0, 1, 0], [0, 0, 0, 1]], "levers": [[0.5, 0.5], [0.5, 0.5]],)"
    R"( "springs": [[1e9, 3e8], [1e9, -1e8]]})";
const std::string free_assembly =
    R"({"schema": "equidem-assembly/1", "discs": [[0, 0, 1], [2, 0, 1], [1, 1.7320508, 1]],)"
    R"( "contacts": [[0, 1, 0, 0], [0, 2, 0, 0], [1, 2, 0, 0]], "groups": {"low": [0, 1], "up": [2]}})";
const std::string grains =
    "x_m,y_m,radius_m,vx_m_per_s,vy_m_per_s,spin_rad_per_s,angle_rad,density_kg_per_m3,group\n"
    "0.01,0.02,0.005,0,-1,0,0,2500,grains\n0.03,0.02,0.004,0.5,0,1,0.25,2600,others\n";
const std::string ellipses = "x,y,radius,short_half_axis,angle\n0.01,0.02,0.005,0.004,0.3\n0.05,0.02,0.005,0.0025,1\n";
const std::string clumps =
    "x,y,angle,discs\n0.01,0.02,0,-0.003 0 0.005; 0.003 0 0.005\n0.05,0.02,1,0 0 0.01; 0.01 0 0.004\n";
const std::string bonds = "i,j,normal_dashpot,tangential_dashpot\n0,1,100,50\n1,2,,\n4,3,1e3,0\n";
const std::string schedule = "# a pulse\ntime,value\n0,0\n1e-3,1\n2e-3,-1\n3e-3,0\n";
const std::string sieves = "# share of the mass\ndiameter_m,passing\n0.002,0\n0.004,0.25\n0.008,0.7\n0.016,1\n";

/// Contents of the case files and studies of the repository, apart by kind.
struct Cases {
  std::vector<std::string> bonded, grains, packing, study = {fuzz::study};

  explicit Cases(const fs::path& folder) {
    std::vector<fs::path> paths;
    for (const fs::path& each : {folder, folder.parent_path() / "studies"})
      for (const auto& entry : fs::directory_iterator(each))
        if (entry.path().extension() == ".toml") paths.push_back(entry.path());
    std::sort(paths.begin(), paths.end());
    for (const fs::path& path : paths) {
      const std::string text = read_file(path);
      const auto has = [&](const char* table) { return text.find(table) != std::string::npos; };
      (has("[study]") ? study : has("[packing]") ? packing : has("[assembly]") ? bonded : grains).push_back(text);
    }
  }
};

Reader reader_of_cases(const fs::path& folder, const std::vector<std::string>& seeds) {
  return {"cases of bonded discs (TOML)", seeds, [folder](const std::string& input) {
            const std::string echoed = to_toml(parse_case(input, "a.toml", folder), folder);
            check_read_back(echoed, to_toml(parse_case(echoed, "a.toml", folder), folder));
          }};
}

/// For kinds of cases that keep their document with the defaults filled in.
template <typename Parse>
Reader reader_of_documents(const std::string& name, const fs::path& folder, const std::vector<std::string>& seeds,
                           const Parse& parse) {
  return {name, seeds, [=](const std::string& input) {
            const std::string echoed = to_toml(parse(input, "a.toml", folder).document, folder);
            check_read_back(echoed, to_toml(parse(echoed, "a.toml", folder).document, folder));
          }};
}

template <typename Read>
Reader reader_of_file(const std::string& name, const fs::path& file, const std::vector<std::string>& seeds,
                      const Read& read) {
  return {name, seeds, [=](const std::string& input) { static_cast<void>(read(put(file, input))); }};
}

const std::string case_text = "title = \"fuzz\"\n[run]\nduration = 0.1\n";

Reader reader_of_checkpoints(const fs::path& scratch) {
  const fs::path path = scratch / "run.checkpoint.h5";
  Checkpoint checkpoint{{.step = 12, .arrays = {{"motions", 3, std::vector<double>(12, 0.25)}, {"sums", 1, {1, 2}}}}};
  checkpoint.record.energies.push_back({.step = 3, .time = 0.5, .ledger = {}});
  checkpoint.files.push_back({"history.csv", 100, 7});
  CheckpointWriter(path, case_text, true).write(checkpoint);
  return reader_of_file("checkpoints", path, {read_file(path)}, [](const fs::path& file) {
    static_cast<void>(case_of_checkpoint(file));
    return read_checkpoint(file, case_text);
  });
}

/// Packings of other programs, each with the options that make its seed an assembly.
Reader reader_of_packings(const std::string& name, const fs::path& scratch, const fs::path& seed,
                          const AssemblyFileOptions& options) {
  return {name, {read_file(seed)}, [=](const std::string& input) {
            static_cast<void>(read_assembly(put(scratch / "packing.txt", input), options));
          }};
}

Reader reader_of_hdf5_assemblies(const fs::path& scratch, const std::vector<std::string>& json_seeds) {
  const fs::path path = scratch / "assembly.h5";
  std::vector<std::string> seeds;
  for (const std::string& text : json_seeds) {
    write_assembly(path, read_assembly(put(scratch / "seed.json", text)), true);
    seeds.push_back(read_file(path));
  }
  return {"assemblies (HDF5)", seeds, [=](const std::string& input) {
            fs::remove(path);  // the HDF5 library may hold a damaged file open, and would take it for the next one
            static_cast<void>(read_assembly(put(path, input)));
          }};
}

Reader reader_of_frames(const fs::path& scratch) {
  const Assembly assembly = hexagonal_lattice({.columns = 2, .rows = 2});
  const std::vector<DiscMotion> still(assembly.size());
  FileMark mark;
  {
    FrameWriter writer(scratch, "frames", assembly, {.overwrite = true});
    for (const std::int64_t step : {0, 5}) writer.append(step, 0.1 * static_cast<double>(step), still, still, {});
    mark = writer.mark();
  }
  const auto copy = [=](const char* from, const char* to) {
    fs::copy(scratch / from, scratch / to, fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  };
  copy("frames", "frames_kept");
  return {"lists of frames (PVD)", {read_file(scratch / "frames.pvd")}, [=](const std::string& input) {
            copy("frames_kept", "frames");
            put(scratch / "frames.pvd", input);
            FrameWriter writer(scratch, "frames", assembly, {.continue_from = mark});
            writer.append(9, 1, still, still, {});
          }};
}

Reader reader_of_histories(const fs::path& scratch) {
  const fs::path path = scratch / "history.csv";
  const std::vector<std::string> columns{"step", "time_s", "value"};
  FileMark mark;
  {
    GrowingCsv table(path, columns, {.overwrite = true});
    for (const std::int64_t step : {0, 5}) table.add(step, {0.1 * static_cast<double>(step), -1e-300});
    table.sync();
    mark = table.mark();
  }
  return {"histories (CSV)", {read_file(path)}, [=](const std::string& input) {
            put(path, input);
            GrowingCsv table(path, columns, {.continue_from = mark});
            table.add(9, {1, 2});
          }};
}

Reader reader_of_samples(const fs::path& scratch) {
  const fs::path path = scratch / "samples.csv";
  const Table table = Table()
                          .add("seed", std::vector<std::int64_t>{1, 2})
                          .add("modulus_Pa", std::vector<double>{1.5, 2.5})
                          .add("refusal", std::vector<std::string>{"", "no, \"thanks\""});
  write_samples(path, table);
  return reader_of_file("samples (CSV)", path, {read_file(path)}, [table](const fs::path& file) {
    const StoredTable stored(file, table, "fuzzing", "Start afresh");
    double sum = 0;
    for (std::size_t row = 0; row < stored.rows(); ++row)
      sum += static_cast<double>(stored.integer(row, 0, 0)) + stored.number(row, 1) +
             static_cast<double>(stored.text(row, 2).size());
    return sum;
  });
}

}  // namespace

std::vector<Reader> make_readers(const fs::path& source, const fs::path& scratch) {
  const fs::path folder = source / "data" / "cases", packings = source / "data" / "packings";
  const Cases cases(folder);
  const auto assembly_seeds = std::vector{periodic_assembly, free_assembly, read_file(folder / "truss.json")};
  const auto text_reader = [](auto parse) {
    return [parse](const std::string& text, const char* name, const fs::path& at) { return parse(text, name, at); };
  };
  return {
      reader_of_cases(folder, cases.bonded),
      reader_of_documents("cases of colliding bodies (TOML)", folder, cases.grains,
                          text_reader([](auto&... given) { return parse_grain_case(given...); })),
      reader_of_documents("cases of packings (TOML)", folder, cases.packing,
                          text_reader([](auto&... given) { return parse_pack_case(given...); })),
      reader_of_documents("studies (TOML)", folder, cases.study,
                          text_reader([](auto&... given) { return parse_study_case(given...); })),
      {"springs (TOML)",
       {springs, springs_of_material},
       [=](const std::string& input) {
         put(scratch / "springs.toml", input);
         static_cast<void>(parse_case(case_of_springs, "a.toml", scratch));
       }},
      reader_of_file("assemblies (JSON)", scratch / "assembly.json", assembly_seeds,
                     [](const fs::path& file) { return read_assembly(file); }),
      reader_of_hdf5_assemblies(scratch, assembly_seeds),
      reader_of_packings("LAMMPS dumps", scratch, packings / "packing.dump", {}),
      reader_of_packings("LAMMPS data files", scratch, packings / "bonds.data", {.periodic_box = false}),
      reader_of_packings("YADE text exports", scratch, packings / "settled_ids.txt", {.unit_of_length = "m"}),
      {"contacts of packings",
       {read_file(packings / "settled_contacts.txt"), read_file(packings / "contacts.dump")},
       [](const std::string& input) { static_cast<void>(read_contact_rows(input)); }},
      reader_of_file("grains (CSV)", scratch / "grains.csv", {grains, ellipses, clumps},
                     [](const fs::path& file) {
                       GrainShapes shapes(Body::disc);
                       return read_grains(file, 2500.0, shapes);
                     }),
      reader_of_file("bonds (CSV)", scratch / "bonds.csv", {bonds},
                     [](const fs::path& file) { return read_bonds(file, {}); }),
      {"bonds with strengths (CSV)",
       {"i,j\n0,1\n2,1\n", "i,j,tension,shear\n0,1,5,6\n1,2,,\n"},
       [=](const std::string& input) {
         put(scratch / "bonds.csv", input);
         put(scratch / "three.csv", three_grains);
         put(scratch / "strength.toml", strengths);
         static_cast<void>(parse_grain_case(case_of_bonds, "a.toml", scratch));
       }},
      {"strengths (TOML)",
       {strengths},
       [=](const std::string& input) {
         put(scratch / "bonds.csv", "i,j\n0,1\n1,2\n");
         put(scratch / "three.csv", three_grains);
         put(scratch / "strength.toml", input);
         static_cast<void>(parse_grain_case(case_of_bonds, "a.toml", scratch));
       }},
      {"springs over frequency (CSV)",
       {frequencies},
       [=](const std::string& input) {
         put(scratch / "measured.csv", input);
         static_cast<void>(parse_case(case_of_frequencies, "a.toml", scratch));
       }},
      reader_of_file("tables of spreadsheets (CSV)", scratch / "spreadsheet.csv", {spreadsheet},
                     [](const fs::path& file) { return read_assembly(file, {.gap_tolerance = 1e-6}); }),
      reader_of_file("schedules (CSV)", scratch / "schedule.csv", {schedule},
                     [](const fs::path& file) {
                       Schedule table{.kind = Schedule::Kind::table};
                       read_points(file, table, "value");
                       check(table);
                       return table.at(1.5e-3);
                     }),
      reader_of_file("sieve curves (CSV)", scratch / "sieves.csv", {sieves, read_file(folder / "pack_graded.csv")},
                     [](const fs::path& file) {
                       const SizeDistribution sizes{.kind = SizeDistribution::Kind::sieve_curve,
                                                    .sieves = read_sieve_curve(file)};
                       check(sizes);
                       Random random(1);
                       return draw_radii(sizes, 20, random);
                     }),
      reader_of_checkpoints(scratch),
      reader_of_frames(scratch),
      reader_of_histories(scratch),
      reader_of_samples(scratch),
  };
}

}  // namespace equidem::fuzz
