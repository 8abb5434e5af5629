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
    afterwards = Path(folder) / "afterwards.mcap"
    run("export", log, "--to", "mcap", "-o", afterwards)
    shown = {}
    for file in (history, afterwards):
        for topic, title, entry in (("/foldline/scene", "SceneUpdate", "triangles"), ("/foldline/log", "Log", "level")):
            messages = list(make_reader(open(file, "rb"), validate_crcs=True).iter_messages(topics=[topic]))
            assert messages, (file, topic)
            for schema, _, message in messages:
                schema = json.loads(schema.data)
                assert schema["title"] == f"foxglove.{title}" and f'"{entry}"' in json.dumps(schema), "no official schema"
                jsonschema.validate(json.loads(message.data), schema)
            shown[file.stem, topic] = [json.loads(message.data) for _, _, message in messages]
    lines = [[line["message"] for line in shown[name, "/foldline/log"]] for name in ("history", "afterwards")]
    assert lines[0] == lines[1] and len(lines[0]) >= len(stages)
    # The same pictures, where a run shows those on the way to a refined mesh, too.
    places = [[scene["entities"][0]["triangles"] for scene in shown[name, "/foldline/scene"]][-1][0]["points"] for name in ("history", "afterwards")]
    assert places[0] == places[1]

    # States as arrays.
    run("export", log, "--to", "npz", "-o", Path(folder) / "states")
    files = list((Path(folder) / "states").glob("*.npz"))
    arrays = numpy.load(sorted(files)[-1])
    shape = arrays["control_points"].shape
    assert arrays["displacement"].shape[1:] == (shape[0], shape[1], 3), arrays["displacement"].shape
    print(f"{len(table)} stages as a table; {sum(map(len, shown.values()))} messages fit their schemas; {len(files)} files of arrays, {sorted(arrays.files)}")
