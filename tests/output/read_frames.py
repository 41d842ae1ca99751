# SPDX-License-Identifier: GPL-3.0-or-later
"""read_frames.py FOLDER NAME: read the frames that NAME.pvd lists with VTK's own reader and compare every number with
motion_STEP.csv, velocity_STEP.csv and contacts_STEP.csv, written by another writer from the same states. Exit 0: equal bit
for bit; 77: the Python module of VTK is missing."""
import csv
import glob
import re
import xml.etree.ElementTree as xml

from vtk_check import compare, end, faults, name, np, path_of, poly_data, vtk_to_numpy


def table(file_name):
    with open(path_of(file_name), newline="") as file:
        rows = list(csv.reader(file))
    return {key: np.array([float(row[c]) for row in rows[1:]]) for c, key in enumerate(rows[0])}


def columns(data, *keys):
    return np.column_stack([data[key] for key in keys])


def vectors(data, x, y):
    return np.column_stack([data[x], data[y], np.zeros(len(data[x]))])


def arrays_of(attributes):
    return {attributes.GetArrayName(k): vtk_to_numpy(attributes.GetArray(k)) for k in range(attributes.GetNumberOfArrays())}


entries = xml.parse(path_of(f"{name}.pvd")).getroot().findall("Collection/DataSet")
parts = [[entry for entry in entries if entry.get("part") == part] for part in "01"]
steps = sorted(int(re.search(r"motion_(\d+)", path).group(1)) for path in glob.glob(path_of("motion_*.csv")))
compare("steps", [int(entry.get("file")[-13:-4]) for entry in parts[0]], steps)
compare("frames with contacts", len(parts[1]), len(steps))
for discs, network, step in zip(*parts, steps):
    motion, velocity, contacts = (table(f"{what}_{step}.csv") for what in ("motion", "velocity", "contacts"))
    n, m = len(motion["disc"]), len(contacts["i"])
    time = float(discs.get("timestep"))
    compare("time of the contacts", float(network.get("timestep")), time)

    data = poly_data(discs.get("file"))
    compare("TimeValue", vtk_to_numpy(data.GetFieldData().GetArray("TimeValue")), [time])
    found = arrays_of(data.GetPointData())
    wanted = {"radius": motion["radius_m"], "displacement": vectors(motion, "ux_m", "uy_m"),
              "rotation": motion["rotation_rad"], "velocity": vectors(velocity, "ux_m", "uy_m"),
              "spin": velocity["rotation_rad"]}
    compare("arrays of discs", sorted(found), sorted(wanted))
    for key, values in wanted.items():
        compare(f"{key} {step}", found[key], values)
    centre = vectors(motion, "x_m", "y_m")
    compare("points", vtk_to_numpy(data.GetPoints().GetData()), centre)
    compare("vertices", vtk_to_numpy(data.GetVerts().GetConnectivityArray()), np.arange(n))

    data = poly_data(network.get("file"))
    compare("number of lines", data.GetNumberOfLines(), m)
    if m == 0:
        continue
    found = arrays_of(data.GetCellData())
    for key, values in {"i": contacts["i"], "j": contacts["j"], "normal_force": contacts["normal_force_N_per_m"],
                        "tangential_force": contacts["tangential_force_N_per_m"],
                        "force": vectors(contacts, "force_x_N_per_m", "force_y_N_per_m")}.items():
        compare(f"{key} {step}", found[key], values)
    branch = columns(contacts, "branch_x_m", "branch_y_m")
    normal = branch / np.hypot(*branch.T)[:, None]
    start = centre[contacts["i"].astype(int), :2]
    if np.abs(found["contact_point"][:, :2] - start - contacts["lever_i_m"][:, None] * normal).max() > 1e-15:
        faults.append("contact_point is not at the lever of i")
    ends = vtk_to_numpy(data.GetPoints().GetData())[vtk_to_numpy(data.GetLines().GetConnectivityArray())]
    compare("starts", ends[0::2, :2], start)
    if np.abs(ends[1::2, :2] - start - branch).max() > 1e-12 * np.abs(centre).max():
        faults.append("lines do not end where the branches do")
    bodies = columns(contacts, "i", "j").astype(int).ravel()
    compare("displacement of the ends", arrays_of(data.GetPointData())["displacement"][
        vtk_to_numpy(data.GetLines().GetConnectivityArray())], vectors(motion, "ux_m", "uy_m")[bodies])

end(f"{len(steps)} frames")
