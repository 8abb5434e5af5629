#!/usr/bin/env python3
"""The lines of Python in the README read a log: as many rows as the log has stages, with the numbers that the program prints.
Messages for viewers fit
the official schema that the log holds. Usage: python.py FOLDLINE (needs the packages `jsonschema`, `mcap`, `numpy` and `pandas`)."""

import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import jsonschema
import numpy
from mcap.reader import make_reader

foldline = sys.argv[1]
root = Path(__file__).parents[2]
snippet = re.search(r"```python\n(.*?)```", (root / "README.md").read_text(), re.S).group(1)


def run(*arguments):
    return subprocess.run([foldline, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


with tempfile.TemporaryDirectory() as folder:
    log = Path(folder) / "run.mcap"
    run("run", "-q", root / "tests/restart/small.toml", "-o", log)
    names = {}
    exec(snippet.replace('"run.mcap"', repr(str(log))), names)
    table = names["table"]
    stages = [json.loads(line) for line in run("inspect", log, "--json").splitlines()]
    assert len(table) == len(stages), (len(table), len(stages))
    for column in ("step", "stage", "rotation_deg", "moment_n_mm"):
        assert list(table[column]) == [stage[column] for stage in stages], column

    # The mesh history.
    scene = Path(folder) / "history.toml"
    scene.write_text((root / "tests/restart/small.toml").read_text() + "\n[output]\nmesh_history = true\n")
    history = Path(folder) / "history.mcap"
    run("run", "-q", scene, "-o", history)
    shown = list(make_reader(open(history, "rb")).iter_messages(topics=["/foldline/scene"]))
    assert shown
    for schema, _, message in shown:
        schema = json.loads(schema.data)
        assert schema["title"] == "foxglove.SceneUpdate" and "triangles" in json.dumps(schema), "no official schema"
        jsonschema.validate(json.loads(message.data), schema)

    # States as arrays.
    run("export", log, "--to", "npz", "-o", Path(folder) / "states")
    files = list((Path(folder) / "states").glob("*.npz"))
    arrays = numpy.load(sorted(files)[-1])
    shape = arrays["control_points"].shape
    assert arrays["displacement"].shape[1:] == (shape[0], shape[1], 3), arrays["displacement"].shape
    print(f"{len(table)} stages as a table; {len(shown)} messages fit their schema; {len(files)} files of arrays, {sorted(arrays.files)}")
