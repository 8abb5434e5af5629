#!/usr/bin/env python3
"""Checks with VTK what `foldline export` writes for ParaView, on the log of a small run that folds and refines, and on that of a structure of two shells that are glued: no error or warning
of VTK; cells that warp to the deformed surface; area and points of the surface, and every field at nodes, as the program has them
in its table (`--to csv`).

    python3 -m venv /tmp/paraview && /tmp/paraview/bin/pip install vtk
    /tmp/paraview/bin/python tests/cli/paraview.py target/release/foldline
"""

import csv
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as xml
from pathlib import Path

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "tests/restart/small.toml"
STRUCTURE = ROOT / "pipelines/structures/trac-boom.toml"
# Cells of a table along an element; uniform points of cells of degree 3 and 2 are among the points of the table.
TABLE_CELLS = 6
# Rounding of coefficients that are some times larger than the values.
SINGLE = 10 * 2.0**-24


def foldline(program: str, *arguments: str, folder: Path) -> None:
    subprocess.run([program, *arguments], cwd=folder, check=True, capture_output=True)


class Complaints:
    """What VTK says of a reader."""

    def __init__(self) -> None:
        self.said: list[str] = []

    def watch(self, algorithm: vtk.vtkAlgorithm) -> None:
        def hear(_caller, event, text="") -> None:
            self.said.append(f"{event}: {text}")

        hear.CallDataType = vtk.VTK_STRING
        for event in ("ErrorEvent", "WarningEvent"):
            algorithm.AddObserver(event, hear)


def read(path: Path, complaints: Complaints) -> vtk.vtkUnstructuredGrid:
    reader = vtk.vtkXMLUnstructuredGridReader()
    complaints.watch(reader)
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def warped(grid: vtk.vtkUnstructuredGrid) -> vtk.vtkUnstructuredGrid:
    warp = vtk.vtkWarpVector()
    warp.SetInputData(grid)
    warp.SetInputArrayToProcess(0, 0, 0, vtk.vtkDataObject.FIELD_ASSOCIATION_POINTS, "displacement")
    warp.SetScaleFactor(1.0)
    warp.Update()
    return warp.GetOutput()


class Cell:
    """A Bézier cell, evaluated by VTK."""

    def __init__(self, grid: vtk.vtkUnstructuredGrid, index: int) -> None:
        # Degrees and weights come with a generic cell.
        self.cell = vtk.vtkGenericCell()
        grid.GetCell(index, self.cell)
        ids = self.cell.GetPointIds()
        self.points = np.array([ids.GetId(k) for k in range(ids.GetNumberOfIds())])

    def weights(self, at: tuple[float, float]) -> np.ndarray:
        position, weights = [0.0] * 3, [0.0] * len(self.points)
        self.cell.EvaluateLocation(vtk.reference(0), [*at, 0.0], position, weights)
        return np.array(weights)


class Check:
    """Faults, with what they are of."""

    def __init__(self) -> None:
        self.faults: list[str] = []
        self.made = 0

    def within(self, what: str, off: float, most: float) -> None:
        self.made += 1
        print(f"{what}: {off:.1e}")
        if not off <= most:
            self.faults.append(f"{what}: off by {off:.3e}, {most:.0e} at most")


def table(path: Path) -> dict[str, np.ndarray]:
    with path.open() as lines:
        names, *rows = csv.reader(lines)
    columns = dict(zip(names, zip(*rows)))
    return {name: np.array(column, dtype=str if name == "shell" else float) for name, column in columns.items()}


def area(grid: vtk.vtkUnstructuredGrid) -> float:
    """Area of all cells by Gauss points, with tangents by differences that are exact for what they are small for."""
    points, weights = np.polynomial.legendre.leggauss(8)
    points, weights, step = 0.5 * (points + 1), 0.5 * weights, 1e-4
    positions = vtk_to_numpy(grid.GetPoints().GetData())
    total = 0.0
    for index in range(grid.GetNumberOfCells()):
        cell = Cell(grid, index)
        at = lambda u, v: cell.weights((u, v)) @ positions[cell.points]
        for u, of_u in zip(points, weights):
            for v, of_v in zip(points, weights):
                # Fourth order: the error is that of rounding.
                slope = lambda f: (8 * (f(step) - f(-step)) - (f(2 * step) - f(-2 * step))) / (12 * step)
                along, across = slope(lambda d: at(u + d, v)), slope(lambda d: at(u, v + d))
                total += of_u * of_v * np.linalg.norm(np.cross(along, across))
    return total


def check_step(check: Check, folder: Path, path: Path, undeformed_area: float) -> None:
    complaints = Complaints()
    grid = read(path, complaints)
    lines = read(path.with_name(path.name.replace("run-", "run-knots-")), complaints)
    values = table(folder / "table" / path.with_suffix(".csv").name)
    points = {array.GetName(): vtk_to_numpy(array) for array in (
        grid.GetPointData().GetArray(k) for k in range(grid.GetPointData().GetNumberOfArrays()))}
    check.within(f"{path.name}: complaints of VTK {complaints.said}", len(complaints.said), 0)
    kinds = {grid.GetCellType(k) for k in range(grid.GetNumberOfCells())}
    line_kinds = {lines.GetCellType(k) for k in range(lines.GetNumberOfCells())}
    known = (kinds, line_kinds) == ({vtk.VTK_BEZIER_QUADRILATERAL}, {vtk.VTK_BEZIER_CURVE})
    check.within(f"{path.name}: types of cells {kinds}, {line_kinds}", 0 if known else 1, 0)

    check.within(f"{path.name}: undeformed area", abs(area(grid) / undeformed_area - 1), 1e-9)

    # The table has the nodes of each cell, v fastest, cell by cell.
    undeformed = vtk_to_numpy(grid.GetPoints().GetData())
    deformed = vtk_to_numpy(warped(grid).GetPoints().GetData())
    size = np.ptp(undeformed, axis=0).max()
    per_cell = len(values["u"]) // grid.GetNumberOfCells()
    side = round(per_cell**0.5)
    names = {name: [column for column in values if column == name or column.startswith(name + "_")
                    and not any(other.startswith(name + "_") and column.startswith(other) for other in points if other != name)]
             for name in points if name != "RationalWeights"}
    off = {"undeformed": 0.0, "deformed": 0.0}
    for index in range(grid.GetNumberOfCells()):
        cell = Cell(grid, index)
        of_cell = slice(index * per_cell, (index + 1) * per_cell)
        rational = np.array([cell.weights((i / (side - 1), j / (side - 1))) for i in range(side) for j in range(side)])
        for what, positions, columns in (("undeformed", undeformed, "x0_mm y0_mm z0_mm"), ("deformed", deformed, "x_mm y_mm z_mm")):
            own = np.array([values[column][of_cell] for column in columns.split()]).T
            off[what] = max(off[what], np.abs(rational @ positions[cell.points] - own).max() / size)
        for name, columns in names.items():
            for component, column in enumerate(columns):
                coefficients = points[name].reshape(len(undeformed), -1)[cell.points, component]
                # By symmetry the glue of the boom is not sheared: what is left is rounding beside the peel.
                scale = np.nanmax(np.abs(values["bond_peel" if name == "bond_shear" else column])) or 1.0
                own = values[column][of_cell]
                # A cell in which a field has no value somewhere has none at all.
                if np.isnan(own).any():
                    error = 0.0 if np.isnan(coefficients).all() else np.inf
                else:
                    error = np.abs(rational @ coefficients - own).max() / scale
                off[name] = max(off.get(name, 0.0), error)
    for what, error in off.items():
        # Other fields than positions are of single precision.
        most = 1e-9 if what in ("undeformed", "deformed", "displacement") else SINGLE
        check.within(f"{path.name}: {what} at the nodes of {grid.GetNumberOfCells()} cells", error, most)
    for name, columns in names.items():
        if name == "displacement":
            continue
        shown = vtk_to_numpy(grid.GetFieldData().GetArray(f"{name}_range")).reshape(-1, 2)
        for (least, largest), column in zip(shown, columns, strict=True):
            own = values[column]
            off_range = max(abs(least - np.nanmin(own)), abs(largest - np.nanmax(own))) / (np.nanmax(np.abs(own)) or 1.0)
            check.within(f"{path.name}: range of {column}", off_range, 1e-9)


def check_shells(check: Check, folder: Path, path: Path) -> None:
    """Cells know their shell by its place in a list of names."""
    complaints = Complaints()
    grid = read(path, complaints)
    names = grid.GetFieldData().GetAbstractArray("shell_names")
    names = [names.GetValue(k) for k in range(names.GetNumberOfValues())]
    of_cells = vtk_to_numpy(grid.GetCellData().GetArray("shell"))
    values = table(folder / "table" / path.with_suffix(".csv").name)
    own = values["shell"].reshape(len(of_cells), -1)
    wrong = sum((own[cell] != names[shell]).any() for cell, shell in enumerate(of_cells))
    check.within(f"{path.name}: cells of {names} beside their shell {complaints.said}", wrong + len(complaints.said), 0)
    peel = values["bond_peel"]
    check.within(f"{path.name}: peel of {np.isfinite(peel).sum()} of {len(peel)} points", 0 if 0 < np.isfinite(peel).sum() < len(peel) else 1, 0)


def main(program: str) -> int:
    program = str(Path(program).resolve())
    check = Check()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        foldline(program, "run", str(SCENE), "-o", "run.mcap", folder=folder)
        chosen = ("--steps", "1,7")
        foldline(program, "export", "run.mcap", "--to", "vtu", "-o", "paraview", *chosen, folder=folder)
        foldline(program, "export", "run.mcap", "--to", "csv", "-o", "table", *chosen, folder=folder)
        series = xml.parse(folder / "paraview/run.pvd").getroot().iter("DataSet")
        files = [folder / "paraview" / entry.get("file") for entry in series]
        for path in files:
            # Undeformed, the shell is a cylinder.
            check_step(check, folder, path, 10.0 * 300.0 * np.radians(110.0))
        structure = folder / "structure"
        structure.mkdir()
        foldline(program, "run", str(STRUCTURE), "-o", "run.mcap", "--until", "0.1", folder=structure)
        foldline(program, "export", "run.mcap", "--to", "vtu", "-o", "paraview", folder=structure)
        foldline(program, "export", "run.mcap", "--to", "csv", "-o", "table", folder=structure)
        for path in structure.glob("paraview/run-0*.vtu"):
            files.append(path)
            check_step(check, structure, path, 2 * 300.0 * (8.0 + 10.6 * np.radians(105.0)))
            check_shells(check, structure, path)
    print(*check.faults, f"{len(files)} load steps, {check.made} checks, {len(check.faults)} faults", sep="\n")
    # A series without files would pass unseen.
    return 1 if check.faults or len(files) != 3 else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
