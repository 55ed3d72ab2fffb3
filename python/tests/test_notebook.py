"""The notebook runs from its first cell to its last, and its code and the stubs agree."""

import subprocess
import sys
from pathlib import Path

import nbformat
from conftest import PYTHON
from nbclient import NotebookClient

NOTEBOOK = PYTHON / "notebook.ipynb"


def test_it_runs_and_its_numbers_are_those_of_validate() -> None:
    notebook = nbformat.read(NOTEBOOK, as_version=4)  # type: ignore[no-untyped-call]
    assert all(cell.cell_type != "code" or not cell.outputs for cell in notebook.cells), "commit it without outputs"
    NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(PYTHON)}}).execute()
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert "µm" in code[-1].outputs[0].text
    assert any("image/png" in output.get("data", {}) for cell in code for output in cell.outputs)


def test_its_code_and_these_tests_are_typed_as_the_stubs_say(tmp_path: Path) -> None:
    cells = nbformat.read(NOTEBOOK, as_version=4).cells  # type: ignore[no-untyped-call]
    code = tmp_path / "notebook.py"
    code.write_text("\n".join(cell.source for cell in cells if cell.cell_type == "code"))
    tests = sorted((PYTHON / "tests").glob("test_*.py"))
    checked = subprocess.run(
        [sys.executable, "-m", "mypy", "--config-file", PYTHON / "pyproject.toml", "--cache-dir", tmp_path, code, *tests],
        capture_output=True,
        text=True,
        cwd=PYTHON / "tests",
    )
    assert checked.returncode == 0, checked.stdout
    # A stub that were not found would leave everything untyped.
    wrong = tmp_path / "wrong.py"
    wrong.write_text("import piezo_estimator\npiezo_estimator.Table.read(3)\n")
    checked = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--cache-dir", tmp_path, wrong], capture_output=True, text=True
    )
    assert 'Argument 1 to "read" of "Table" has incompatible type "int"' in checked.stdout, checked.stdout
