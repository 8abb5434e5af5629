#!/usr/bin/env python3
"""Reads what `foldline export` writes as STEP, STL and NPZ with the packages gmsh, vtk and numpy from PyPI, and compares the deformed
surface with the program's own table (`--to csv`).

    python3 -m venv /tmp/readers && /tmp/readers/bin/pip install gmsh numpy vtk
    /tmp/readers/bin/python tests/cli/readers.py target/release/foldline
"""

import sys
import tempfile
from pathlib import Path

import gmsh
import numpy as np
import vtk
from paraview import SCENE, Check, foldline, table
from vtk.util.numpy_support import vtk_to_numpy

STEP = "7"


def check_step(check: Check, path: Path, values: dict[str, np.ndarray]) -> None:
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.occ.importShapes(str(path))
    gmsh.model.occ.synchronize()
    faces = gmsh.model.getEntities(2)
    check.within(f"STEP: faces beside one {faces}", abs(len(faces) - 1), 0)
    shown = gmsh.model.getValue(2, faces[0][1], np.column_stack([values["u"], values["v"]]).ravel())
    own = np.column_stack([values["x_mm"], values["y_mm"], values["z_mm"]])
    check.within(f"STEP: {len(own)} points, mm", np.abs(shown.reshape(-1, 3) - own).max(), 1e-9)
    gmsh.finalize()


def check_stl(check: Check, path: Path, values: dict[str, np.ndarray]) -> None:
    reader = vtk.vtkSTLReader()
    reader.SetFileName(str(path))
    reader.Update()
    shown = vtk_to_numpy(reader.GetOutput().GetPoints().GetData())
    own = np.column_stack([values["x_mm"], values["y_mm"], values["z_mm"]])
    # Every corner is a point of the table, in single precision, and every point of the table a corner.
    distance = np.abs(shown[:, None] - own[None]).max(axis=2)
    off = max(distance.min(axis=0).max(), distance.min(axis=1).max())
    check.within(f"STL: {len(shown)} corners, mm", off, np.spacing(np.float32(300.0)))


def b_splines(degree: int, knots: np.ndarray, at: float) -> np.ndarray:
    """B-splines at a parameter, by the recursion of Cox and de Boor."""
    last = len(knots) - degree - 2
    span = min(max(np.searchsorted(knots, at, side="right") - 1, degree), last)
    functions = np.zeros(len(knots) - 1)
    functions[span] = 1.0
    for p in range(1, degree + 1):
        share = lambda i: (at - knots[i]) / (knots[i + p] - knots[i]) if knots[i + p] > knots[i] else 0.0
        functions = np.array([share(i) * functions[i] + (1 - share(i + 1)) * functions[i + 1] if i + p + 1 < len(knots) else 0.0
                              for i in range(len(functions) - 1)])
    return functions


def check_npz(check: Check, path: Path, values: dict[str, np.ndarray]) -> None:
    arrays = np.load(path)
    at = list(arrays["step"]).index(float(STEP))
    weights = arrays["control_points"][..., 3]
    points = arrays["control_points"][..., :3] + arrays["displacement"][at]
    off = 0.0
    for k in range(0, len(values["u"]), 7):
        along, across = (b_splines(degree, arrays[name], values[parameter][k])
                         for degree, name, parameter in zip(arrays["degree"], ("knots_u", "knots_v"), "uv"))
        rational = np.outer(along, across) * weights
        shown = np.einsum("ij,ijc->c", rational, points) / rational.sum()
        off = max(off, np.abs(shown - [values[name][k] for name in ("x_mm", "y_mm", "z_mm")]).max())
    check.within("NPZ: points by B-splines of its arrays, mm", off, 1e-9)


def main(program: str) -> int:
    program = str(Path(program).resolve())
    check = Check()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        foldline(program, "run", str(SCENE), "-o", "run.mcap", folder=folder)
        for kind in ("csv", "step", "stl", "npz"):
            foldline(program, "export", "run.mcap", "--to", kind, "-o", f"shell.{kind}", "--steps", STEP, folder=folder)
        values = table(folder / "shell.csv")
        check_step(check, folder / "shell.step", values)
        check_stl(check, folder / "shell.stl", values)
        check_npz(check, folder / "shell.npz", values)
    print(*check.faults, f"{check.made} checks, {len(check.faults)} faults", sep="\n")
    return 1 if check.faults else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
