# SPDX-License-Identifier: GPL-3.0-or-later
"""What the histories of the laboratory's cases say: each function takes the folder that `equidem run` wrote."""

import csv
import json
import math
from pathlib import Path

import numpy


def columns(path):
    """The columns of a table as arrays by their names."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    values = numpy.array([[float(cell) if cell else math.nan for cell in row] for row in rows[1:]])
    return dict(zip(rows[0], values.T))


def history(folder, stage=None):
    """The columns of history.csv, of one stage alone where its name is given."""
    folder = Path(folder)
    read = columns(folder / "history.csv")
    if stage is None:
        return read
    times = next(one for one in json.loads((folder / "result.json").read_text())["stages"] if one["name"] == stage)
    kept = (read["time_s"] >= times["start"]) & (read["time_s"] <= times["end"])
    return {name: values[kept] for name, values in read.items()}


def mean_force(read, wall, axis):
    """Mean force on a wall from each row to the next, N/m, by its impulse: without the noise of single steps."""
    return numpy.diff(read[f"wall_{wall}_impulse_{axis}_N_s_per_m"]) / numpy.diff(read["time_s"])


def middle(values):
    return (values[1:] + values[:-1]) / 2


def smooth(values, rows):
    """Means over a number of neighbouring rows; shorter by that number less one."""
    return numpy.convolve(values, numpy.full(rows, 1 / rows), "valid")


def plates(folder, stage="shear"):
    """Of a biaxial test, between the rows: axial and side stress, logarithmic strain along and volume strain, compression positive."""
    read = history(folder, stage)
    width = read["wall_right_x_m"] - read["wall_left_x_m"]
    height = read["wall_top_y_m"] - read["wall_bottom_y_m"]
    side = (mean_force(read, "right", "x") - mean_force(read, "left", "x")) / 2 / middle(height)
    axial = (mean_force(read, "top", "y") - mean_force(read, "bottom", "y")) / 2 / middle(width)
    return axial, side, numpy.log(height[0] / middle(height)), numpy.log(width[0] * height[0] / middle(width) / middle(height))


def biaxial(folder):
    """Angles of friction (degrees) at the peak and beyond 8 per cent of strain, and that which Rowe's relation gives at the peak: s1/s2 = K
    (1 + D), D = -(volume strain rate)/(axial strain rate), compression positive, with the K of the end."""
    rows = 15
    axial, side, strain, volume = (smooth(values, rows) for values in plates(folder))
    sine = (axial - side) / (axial + side)
    peak = int(numpy.argmax(sine[rows:-rows])) + rows
    late = float(numpy.mean(sine[strain > 0.08]))
    near = slice(peak - rows, peak + rows + 1)
    dilation, end = (-numpy.polyfit(strain[part], volume[part], 1)[0] for part in (near, strain > 0.08))
    factor = (1 + late) / (1 - late) / (1 + end)
    return {"peak": math.degrees(math.asin(sine[peak])), "late": math.degrees(math.asin(late)), "strain": float(strain[peak]),
            "dilation": float(dilation), "factor": float(factor), "rowe": angle_of(factor * (1 + dilation)),
            "volume": float(-volume[-1]), "side": (float(side.min()), float(side.max()))}


def stress_dilatancy(folders, window=0.005):
    """Of the mean curves of several biaxial tests: the angle at their peak, its strain and dilation D, the angle by Rowe's relation with
    K = R/(1 + D) beyond 8 per cent of strain, and the line R = a + b D through all windows beyond 0.3 per cent with its correlation."""
    grid = numpy.linspace(5e-4, 0.099, 395)
    curves = [plates(folder) for folder in folders]
    ratio = numpy.mean([numpy.interp(grid, strain, axial / side) for axial, side, strain, _ in curves], axis=0)
    volume = numpy.mean([numpy.interp(grid, strain, volume) for _, _, strain, volume in curves], axis=0)
    rows = round(window / (grid[1] - grid[0]))
    parts = [slice(k, k + rows) for k in range(len(grid) - rows + 1)]
    strain, ratio = smooth(grid, rows), smooth(ratio, rows)
    dilation = numpy.array([-numpy.polyfit(grid[part], volume[part], 1)[0] for part in parts])
    peak, late, flowing = int(numpy.argmax(ratio)), strain > 0.08, strain > 0.003
    factor = float(numpy.mean(ratio[late] / (1 + dilation[late])))
    slope_of, offset = numpy.polyfit(dilation[flowing], ratio[flowing], 1)
    return {"peak": angle_of(ratio[peak]), "strain": float(strain[peak]), "dilation": float(dilation[peak]), "factor": factor,
            "late": angle_of(float(numpy.mean(ratio[late]))), "rowe": angle_of(factor * (1 + dilation[peak])), "slope": float(slope_of),
            "offset": float(offset), "correlation": float(numpy.corrcoef(dilation[flowing], ratio[flowing])[0, 1])}


def angle_of(ratio):
    """Angle of friction (degrees) of a ratio of the principal stresses."""
    return math.degrees(math.asin((ratio - 1) / (ratio + 1)))


def small_strain(folder, low, high):
    """Slopes of the axial stress over the strain and of the strain across over that along, between two strains, while the sides keep
    their stress, E and nu; with the plates slow enough that waves have died out below `low`."""
    axial, side, strain, volume = plates(folder)
    chosen = (strain > low) & (strain < high)
    return [float(numpy.polyfit(strain[chosen], values[chosen], 1)[0]) for values in (axial - side, strain - volume)]


def shear_box(folder):
    """Angles of friction in the plane of shear (degrees), at the peak and over the last quarter, and that which Taylor's relation gives at
    the peak: T/N - dy/dx is what it is over the last quarter."""
    read = history(folder, "shear")
    moved = read["wall_floor_x_m"] - read["wall_floor_x_m"][0]
    lid = read["wall_lid_y_m"] - read["wall_lid_y_m"][0]
    pushed = sum(mean_force(read, wall, "x") for wall in ("floor", "lower_left", "lower_right", "shelf"))
    rows = 25
    ratio = smooth(-pushed, rows) / smooth(mean_force(read, "lid", "y"), rows)
    at, rise = smooth(middle(moved), rows), smooth(middle(lid), rows)
    peak = int(numpy.argmax(ratio[rows:-rows])) + rows
    end = at > 0.75 * at[-1]
    late = float(numpy.mean(ratio[end]))
    near = slice(peak - rows, peak + rows + 1)
    dilation, last = (float(numpy.polyfit(at[part], rise[part], 1)[0]) for part in (near, end))
    return {"peak": math.degrees(math.atan(ratio[peak])), "late": math.degrees(math.atan(late)), "moved": float(at[peak]),
            "dilation": dilation, "dilation_at_the_end": last, "taylor": math.degrees(math.atan(late - last + dilation)), "rise": float(rise[-1])}


def taylor(folder, parts=((0, 5e-3), (8e-3, 16e-3))):
    """T/N and dy/dx of the shear box, means over two parts of its way (m): [[T/N, dy/dx], ...]; by Taylor their difference is one number."""
    read = history(folder, "shear")
    moved, lid = read["wall_floor_x_m"] - read["wall_floor_x_m"][0], read["wall_lid_y_m"]
    pushed = -sum(mean_force(read, wall, "x") for wall in ("floor", "lower_left", "lower_right", "shelf"))
    pressed, at = mean_force(read, "lid", "y"), middle(moved)
    found = []
    for start, end in parts:
        chosen = (at > start) & (at < end)
        found.append([float(pushed[chosen].mean() / pressed[chosen].mean()), float(numpy.diff(numpy.interp((start, end), moved, lid))[0] / (end - start))])
    return found


def unconfined(folder, width):
    """Strength, and from the stresses between a tenth and four tenths of it Young's modulus and Poisson's ratio of the sheet (the
    uniaxial stress over its strain, and the share across): those of the reading 'plane stress' of homogenize."""
    read = history(folder)
    stress = smooth((mean_force(read, "top", "y") - mean_force(read, "bottom", "y")) / 2 / width, 5)
    along, across = read["upper_y_m"] - read["lower_y_m"], read["right_x_m"] - read["left_x_m"]
    shorter, wider = smooth(middle(1 - along / along[0]), 5), smooth(middle(across / across[0] - 1), 5)
    peak = int(numpy.argmax(stress))
    if stress[-1] > 0.9 * stress[peak]:
        raise SystemExit(f"{folder}: the run ends before the load falls, so that its largest stress is no strength")
    before = numpy.arange(len(stress)) < peak
    chosen = before & (stress > 0.1 * stress[peak]) & (stress < 0.4 * stress[peak])
    return {"strength": float(stress[peak]), "strain": float(shorter[peak]), **elastic(stress[chosen], shorter[chosen], wider[chosen])}


def elastic_gauges(folder, width):
    """Young's modulus and Poisson's ratio by the gauges of a run that ends before bonds break, from a third of its stress on."""
    read = history(folder)
    stress = (mean_force(read, "top", "y") - mean_force(read, "bottom", "y")) / 2 / width
    along, across = read["upper_y_m"] - read["lower_y_m"], read["right_x_m"] - read["left_x_m"]
    late = stress > 0.3 * stress.max()
    return elastic(stress[late], middle(1 - along / along[0])[late], middle(across / across[0] - 1)[late])


def elastic(stress, shorter, wider):
    return {"young_modulus": float(numpy.polyfit(shorter, stress, 1)[0]), "poisson_ratio": float(numpy.polyfit(shorter, wider, 1)[0])}


def brazilian(folder, diameter):
    """2 P/(pi D) at the peak of the force on the plates, Pa."""
    read = history(folder)
    force = smooth((mean_force(read, "top", "y") - mean_force(read, "bottom", "y")) / 2, 5)
    peak = int(numpy.argmax(force))
    return {"strength": 2 * float(force[peak]) / (math.pi * diameter), "time": float(read["time_s"][peak + 2])}


def stress_at_the_centre(folder, diameter, until=math.inf):
    """Stresses across and along the loaded diameter in the box of the probe, over 2 P/(pi D), by their slopes against the force up to a
    time; the force on plates is the mean between rows and the stress that of a step, so that both are taken at the rows."""
    read = history(folder)
    force = (mean_force(read, "top", "y") - mean_force(read, "bottom", "y")) / 2
    unit = middle(force) * 2 / (math.pi * diameter)
    chosen = (unit > 0.1 * unit.max()) & (read["time_s"][1:-1] < until)
    return [float(numpy.polyfit(unit[chosen], read[f"centre_stress_{axes}_Pa"][1:-1][chosen], 1)[0]) for axes in ("xx", "yy")]


def hondros(half_angle, half_side, rigid=False):
    """Mean stresses across and along the loaded diameter of a disc under radial pressure on two opposite arcs of 2 half_angle (rad), in a
    square of 2 half_side about its centre (in radii), over 2 P/(pi D). Of the pressure q0 + q2 cos 2 theta + ... the first two terms count
    (Hondros 1959): s_xx = -q0 + q2 (1 - r^2/R^2), s_yy = -q0 - q2 (1 - r^2/R^2) in the mean over the directions, where r^2 has the mean
    2/3 half_side^2; the next term adds 0.3 q4 half_side^4 at most. The pressure is uniform, or that under rigid jaws, as 1/sqrt(half_angle^2 -
    theta^2), whose terms are Bessel functions J0."""
    if rigid:
        q0, q2 = 1 / bessel(half_angle), 2 * bessel(2 * half_angle) / bessel(half_angle)
    else:
        q0, q2 = half_angle / math.sin(half_angle), math.sin(2 * half_angle) / math.sin(half_angle)
    share = 1 - 2 / 3 * half_side**2
    return -q0 + q2 * share, -q0 - q2 * share


def bessel(x):
    """J0."""
    return sum((-1) ** k * (x / 2) ** (2 * k) / math.factorial(k) ** 2 for k in range(20))


def breaks_near_the_diameter(folder, until):
    """Share of the breaks up to a time within 5 mm of the loaded diameter x = 0, and their number."""
    read = rows_of_breaks(folder)
    x = numpy.array([float(row["x_m"]) for row in read if float(row["time_s"]) <= until])
    return {"near": float(numpy.mean(abs(x) < 0.005)) if len(x) else math.nan, "breaks": len(x)}


def rows_of_breaks(folder):
    with open(Path(folder) / "breaks.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def beam(folder, start, cycles, frequency):
    """Stiffness of the row (N/m per m) and what it dissipates in a cycle, by its loop and by the ledger."""
    read = history(folder)
    time, end = read["time_s"], start + cycles / frequency
    # The loop is closed only where it ends at the moment at which it began.
    moments = numpy.concatenate([[start], time[(time > start) & (time < end)], [end]])
    load = numpy.interp(moments, time, read["wall_load_force_y_N_per_m"])
    bent = numpy.interp(moments, time, read["ends_y_m"] - read["middle_y_m"])
    lost = numpy.interp([start, end], time, read["lost_bond_J_per_m"])
    return {"stiffness": float(numpy.polyfit(bent, load, 1)[0]), "amplitude": float(bent.max() - bent.min()) / 2,
            "loop": float(numpy.trapz(load, bent)) / cycles, "lost": float(lost[1] - lost[0]) / cycles}


def row_of_discs(bonds, spacing, bending, tangential, loss):
    """The same of a row of bonds on supports at its ends, by statics: the bond k from an end carries P (k + 1/2) l/2 and P/2."""
    arms = (numpy.arange(bonds // 2) + 0.5) * spacing
    bent = (arms**2).sum() / (2 * bending)
    stiffness = 1 / (bent + bonds / (4 * tangential))
    return {"stiffness": stiffness, "loss_over_square": math.pi * loss * stiffness**2 * bent}


def slope(folder, start=0.02, end=0.13, width=0.01):
    """Angle of the surface (degrees) and its standard error: a line through the highest points in columns of one width, least squares."""
    return slope_of(*columns_without_text(Path(folder) / "grains.csv", ("x_m", "y_m", "radius_m")).values(), start, end, width)


def slope_of(x, y, radius, start=0.02, end=0.13, width=0.01):
    """The same of discs at these places."""
    top = y + radius
    places, heights = [], []
    for left in numpy.arange(start, end - width / 2, width):
        inside = numpy.flatnonzero((x >= left) & (x < left + width) & (y > 0))
        if len(inside):
            highest = inside[numpy.argmax(top[inside])]
            places.append(x[highest]), heights.append(top[highest])
    line, covariance = numpy.polyfit(places, heights, 1, cov=True)
    angle = math.atan(-line[0])
    return {"angle": math.degrees(angle), "error": math.degrees(math.sqrt(covariance[0, 0]) * math.cos(angle) ** 2)}


def columns_without_text(path, names):
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {name: numpy.array([float(row[name]) for row in rows]) for name in names}


def discharge(folder, first=100, last=900):
    """Bodies that leave in a second, and the standard error of that from four parts of the time."""
    read = history(folder)
    time, out = read["time_s"], read["out_inside"]
    chosen = numpy.flatnonzero((out > first) & (out < last))
    parts = [numpy.polyfit(time[part], out[part], 1)[0] for part in numpy.array_split(chosen, 4)]
    return {"rate": float(numpy.polyfit(time[chosen], out[chosen], 1)[0]), "error": float(numpy.std(parts, ddof=1) / 2)}


def power_law(openings, rates, errors, power=1.5):
    """C and the closed width W0 of rates = C (W - W0)^power by weighted least squares of rates^(1/power), and chi squared over the
    openings beyond two."""
    openings, rates, errors = map(numpy.asarray, (openings, rates, errors))
    root, weight = rates ** (1 / power), power * rates ** (1 - 1 / power) / errors
    slope_of, offset = numpy.polyfit(openings, root, 1, w=weight)
    misfit = float((((root - slope_of * openings - offset) * weight) ** 2).sum()) / max(1, len(rates) - 2)
    return {"factor": float(slope_of**power), "closed": float(-offset / slope_of), "misfit": misfit}
