"""What the tests have in common: logs, tables, and the program whose numbers the wheel's must be."""

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import pytest

PYTHON = Path(__file__).parents[1]
DATA = PYTHON.parent / "tests" / "data"
LOG = DATA / "picma-p885-1hz.csv"
# It has an interval and a drive.
TABLE = DATA / "table" / "generalised-prandtl-ishlinskii" / "table.toml"


def piezo(*arguments: str | Path) -> str:
    """Runs the program and returns what it prints."""
    ran = subprocess.run([os.environ["PIEZO"], *map(str, arguments)], capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


def piezo_json(*arguments: str | Path) -> Any:
    return json.loads(piezo(*arguments, "--json"))


@pytest.fixture(params=sorted((DATA / "table" / "models").glob("*.toml")), ids=lambda path: path.stem)
def model(request: pytest.FixtureRequest) -> Path:
    """A table of each model."""
    path: Path = request.param
    return path
