# SPDX-License-Identifier: GPL-3.0-or-later
"""read_with_vtk.py FOLDER NAME: read NAME.vtm, NAME_discs.vtp and NAME_contacts.vtp with VTK's own readers and compare every
number with discs.csv and contacts.csv, written by another writer from the same state. Exit 0: equal bit for bit; 77: the
Python module of VTK is missing."""
import csv

from vtk_check import compare, end, faults, name, np, path_of, poly_data, vtk_to_numpy, vtkXMLMultiBlockDataReader


def table(file_name):
    with open(path_of(file_name), newline="") as file:
        rows = list(csv.DictReader(file))
    return {key: np.array([float(row[key]) for row in rows]) for key in rows[0]} if rows else {}


def array(data, key):
    found = data.GetArray(key)
    if found is None:
        faults.append(f"no array {key}")
        return None
    return vtk_to_numpy(found)


discs, contacts = table("discs.csv"), table("contacts.csv")
n, m = len(discs["disc"]), len(contacts.get("i", []))

data = poly_data(f"{name}_discs.vtp")
compare("disc points", vtk_to_numpy(data.GetPoints().GetData()),
        np.column_stack([discs["x_m"], discs["y_m"], np.zeros(n)]))
compare("vertices", vtk_to_numpy(data.GetVerts().GetConnectivityArray()), np.arange(n))
compare("vertex offsets", vtk_to_numpy(data.GetVerts().GetOffsetsArray()), np.arange(n + 1))
point = data.GetPointData()
scalars = {"radius": "radius_m", "cell_area": "cell_area_m2", "rotation": "rotation_rad", "stress_xx": "stress_xx_Pa",
           "stress_yy": "stress_yy_Pa", "stress_xy": "stress_xy_Pa", "stress_yx": "stress_yx_Pa"}
for key, column in scalars.items():
    compare(key, array(point, key), discs[column])
compare("mean stress", array(point, "mean_stress"), 0.5 * (discs["stress_xx_Pa"] + discs["stress_yy_Pa"]))
displacement = np.column_stack([discs["ux_m"], discs["uy_m"], np.zeros(n)])
compare("displacement", array(point, "displacement"), displacement)

data = poly_data(f"{name}_contacts.vtp")
compare("number of lines", data.GetNumberOfLines(), m)
if m:
    i, j = contacts["i"].astype(int), contacts["j"].astype(int)
    ends = vtk_to_numpy(data.GetLines().GetConnectivityArray())
    compare("line offsets", vtk_to_numpy(data.GetLines().GetOffsetsArray()), 2 * np.arange(m + 1))
    place = vtk_to_numpy(data.GetPoints().GetData())[ends][:, :2]
    start = np.column_stack([discs["x_m"][i], discs["y_m"][i]])
    compare("starts", place[0::2], start)
    branch = np.column_stack([contacts["branch_x_m"], contacts["branch_y_m"]])
    if np.abs(place[1::2] - start - branch).max() > 1e-15 * np.abs(place).max():
        faults.append("a line does not end where its branch does")
    cell = data.GetCellData()
    for key, column in {"i": "i", "j": "j", "normal_force": "normal_force_N_per_m",
                        "tangential_force": "tangential_force_N_per_m"}.items():
        compare(key, array(cell, key), contacts[column])
    compare("force", array(cell, "force")[:, :2],
            np.column_stack([contacts["force_x_N_per_m"], contacts["force_y_N_per_m"]]))
    lever = array(cell, "contact_point")[:, :2] - start
    if not np.allclose(np.hypot(*lever.T), contacts["lever_i_m"], rtol=1e-12, atol=0):
        faults.append("contact_point does not lie at the lever of i")
    compare("displacement of the ends", array(data.GetPointData(), "displacement")[ends],
            displacement[np.column_stack([i, j]).ravel()])
    compare("radius of the ends", array(data.GetPointData(), "radius")[ends], np.zeros(2 * m))

reader = vtkXMLMultiBlockDataReader()
reader.SetFileName(path_of(f"{name}.vtm"))
reader.Update()
blocks = reader.GetOutput()
compare("blocks", blocks.GetNumberOfBlocks(), 2)
compare("points of the disc block", blocks.GetBlock(0).GetNumberOfPoints(), n)
compare("lines of the contact block", blocks.GetBlock(1).GetNumberOfLines() if m else 0, m)

end(f"{n} discs, {m} contacts")
