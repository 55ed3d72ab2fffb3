"""The chapter's code runs."""

import re
import shutil
from pathlib import Path

import pytest
from conftest import DATA, PYTHON

CHAPTER = PYTHON.parent / "book" / "src" / "python.md"


def test_the_chapter_s_code_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (code,) = re.findall(r"^```python\n(.*?)^```$", CHAPTER.read_text(), flags=re.DOTALL | re.MULTILINE)
    shutil.copy(DATA / "picma-p885-1hz.csv", tmp_path / "day1.csv")
    shutil.copy(DATA / "picma-p885-session2.csv", tmp_path / "day2.csv")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    exec(compile(code, CHAPTER, "exec"), names)
    reached, half_width = names["reached"], names["half_width_um"]
    assert reached[-1] and half_width[-1] > 0.0  # type: ignore[index]
