#!/usr/bin/env python3
"""Checks the JSON Schema of scenes with the package `jsonschema` from PyPI: it accepts every scene of the project, and refuses
every scene of `wrong_scenes.toml`, which the parser refuses as well (`tests/cli/scenes.rs`).

    python3 -m venv /tmp/schema && /tmp/schema/bin/pip install jsonschema
    /tmp/schema/bin/python tests/cli/schema.py target/release/foldline
"""

import json
import subprocess
import sys
import tomllib
from pathlib import Path

from jsonschema import Draft7Validator

ROOT = Path(__file__).parents[2]
FOLDERS = ["pipelines", "checkpoints", "src/scene", "tests/restart", "tests/verification/scenes"]


def main(program: str) -> int:
    shown = subprocess.run([program, "help", "scene", "--json-schema"], capture_output=True, text=True, check=True)
    schema = json.loads(shown.stdout)
    Draft7Validator.check_schema(schema)
    validator = Draft7Validator(schema)
    faults = []

    found = (path for folder in FOLDERS for path in (ROOT / folder).rglob("*.toml"))
    right = sorted(path for path in found if path.parent.name not in ("studies", "sweeps"))
    for path in right:
        errors = list(validator.iter_errors(tomllib.loads(path.read_text())))
        faults += [f"{path.relative_to(ROOT)} is a scene: {error.json_path}: {error.message}" for error in errors]

    wrong = 0
    for base in tomllib.loads((ROOT / "tests/cli/wrong_scenes.toml").read_text()).values():
        faults += [f"a scene that is right: {error.message}" for error in validator.iter_errors(tomllib.loads(base["scene"]))]
        for before, after in base["slips"]:
            wrong += 1
            if validator.is_valid(tomllib.loads(base["scene"].replace(before, after))):
                faults.append(f"`{after}` in place of `{before}` is accepted")

    print(*faults, f"{len(right)} scenes, {wrong} wrong ones, {len(faults)} faults", sep="\n")
    # A tree without its scenes would pass unseen.
    return 1 if faults or len(right) < 50 or wrong < 50 else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
