# SPDX-License-Identifier: GPL-3.0-or-later
"""read_frames.py FOLDER NAME: read NAME.h5 with h5py, and through the index NAME.xdmf2, and compare every number with
motion_STEP.csv, velocity_STEP.csv and contacts.csv, written by another writer from the same states. Exit 0: equal bit for
bit; 77: the Python module h5py is missing."""
import csv
import glob
import os
import re
import sys
import xml.etree.ElementTree as xml

try:
    import h5py
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

folder, name = sys.argv[1:]
faults = []


def table(file_name):
    with open(os.path.join(folder, file_name), newline="") as file:
        rows = list(csv.reader(file))
    return {key: np.array([float(row[c]) for row in rows[1:]]) for c, key in enumerate(rows[0])}


def compare(what, found, wanted):
    if np.shape(found) != np.shape(wanted) or not np.array_equal(found, wanted):
        faults.append(f"{what}: {found} is not {wanted}")


def columns(data, *keys):
    return np.column_stack([data[key] for key in keys])


steps = sorted(int(re.search(r"motion_(\d+)", path).group(1)) for path in glob.glob(os.path.join(folder, "motion_*.csv")))
motions = [table(f"motion_{step}.csv") for step in steps]
velocities = [table(f"velocity_{step}.csv") for step in steps]
contacts = table("contacts.csv")
centre, radius = columns(motions[0], "x_m", "y_m"), motions[0]["radius_m"]
n = len(radius)


def vectors(data):
    return np.column_stack([data["ux_m"], data["uy_m"], np.zeros(n)])


def compare_frame(what, read, k):
    compare(f"{what}displacement {k}", read("displacement"), vectors(motions[k]))
    compare(f"{what}rotation {k}", read("rotation"), motions[k]["rotation_rad"])
    compare(f"{what}velocity {k}", read("velocity"), vectors(velocities[k]))
    compare(f"{what}spin {k}", read("spin"), velocities[k]["rotation_rad"])


# By itself.
file = h5py.File(os.path.join(folder, f"{name}.h5"), "r")
compare("schema", file.attrs["schema"].decode(), "equidem-frames/1")
compare("centres", file["discs/centre"][:], centre)
compare("radii", file["discs/radius"][:], radius)
compare("numbers", file["discs/number"][:], np.arange(n))
compare("contacts", file["contacts/discs"][:], columns(contacts, "i", "j"))
compare("shifts", file["contacts/shift"][:], columns(contacts, "shift_x", "shift_y"))
compare("levers", file["contacts/lever"][:], columns(contacts, "lever_i_m", "lever_j_m"))
count = int(file["frames"][0])
compare("frames", count, len(steps))
compare("steps", file["step"][:count], steps)
compare("frames that are not there", np.isnan(file["time"][count:]).all(), True)
compare("unit of displacement", file["displacement"].attrs["unit"].decode(), "m")
for k in range(count):
    compare_frame("", lambda key: file[key][k], k)
periodic = "period" in file
compare("period", periodic, bool(np.any(contacts["shift_x"]) or np.any(contacts["shift_y"])))
if periodic:
    i, j = (contacts[key].astype(int) for key in "ij")
    branch = centre[j] + columns(contacts, "shift_x", "shift_y") * file["period"][:] - centre[i]
    error = np.abs(branch - columns(contacts, "branch_x_m", "branch_y_m")).max()
    if error > 1e-12 * np.abs(centre).max():
        faults.append(f"the period leads {error} m past the branches")



# Through the index: every array it names must be there, in the shape it says.
def numbers(item):
    shape = tuple(int(extent) for extent in item.get("Dimensions").split())
    if item.get("ItemType") == "HyperSlab":
        start, stride, size = (numbers(item[0])[row] for row in range(3))
        source = numbers(item[1])
        if np.any(stride != 1) or np.any(start + size > source.shape):
            faults.append(f"a slab {start} {stride} {size} reaches out of {source.shape}")
            return np.zeros(shape)
        return source[tuple(slice(a, a + b) for a, b in zip(start, size))].reshape(shape)
    if item.get("Format") == "XML":
        return np.array([int(number) for number in item.text.split()]).reshape(shape)
    file_name, path = item.text.strip().split(":")
    compare("name of the file", file_name, f"{name}.h5")
    data = file[path]
    if item.get("NumberType") != {"f": "Float", "i": "Int"}[data.dtype.kind] or int(
            item.get("Precision")) != data.dtype.itemsize:
        faults.append(f"{path}: {data.dtype} is declared {item.get('NumberType')} {item.get('Precision')}")
    if np.prod(shape) != data.size or (len(shape) == data.ndim and shape != data.shape):
        faults.append(f"{path}: {data.shape} is declared {shape}")
    return data[:].reshape(shape)


collection = xml.parse(os.path.join(folder, f"{name}.xdmf2")).getroot().find("Domain/Grid")
compare("kind of collection", collection.get("CollectionType"), "Temporal")
grids = collection.findall("Grid")
compare("frames of the index", len(grids), count)
for k, grid in enumerate(grids):
    compare(f"time {k}", float(grid.find("Time").get("Value")), file["time"][k])
    compare(f"points {k}", numbers(grid.find("Geometry/DataItem")), centre)
    compare(f"vertices {k}", numbers(grid.find("Topology/DataItem")), np.arange(n).reshape(n, 1))
    compare(f"count {k}", int(grid.find("Topology").get("NumberOfElements")), n)
    items = {a.get("Name"): numbers(a.find("DataItem")) for a in grid.findall("Attribute")}
    compare(f"radii {k}", items["radius"], radius)
    compare_frame("index: ", items.get, k)

for fault in faults:
    print(fault)
print(f"{n} discs, {count} frames: {len(faults)} faults")
sys.exit(1 if faults else 0)
