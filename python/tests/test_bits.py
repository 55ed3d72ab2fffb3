"""Estimator and inverse give the bits that a program of the core gives, with every model."""

import os
import subprocess
from pathlib import Path

import numpy as np
import numpy.typing as npt
import piezo_estimator as pz
import pytest

Words = npt.NDArray[np.uint32]


def vectors(table: pz.Table, folder: Path) -> dict[str, Words]:
    """What `estimator-core/examples/bits.rs` prints, by its lines' letters: a row for each line, in words of 32 bits."""
    record = folder / "table.bin"
    record.write_bytes(table.record())
    # Cargo lays it there beside the program.
    bits = Path(os.environ["PIEZO"]).parent / "examples" / "bits"
    ran = subprocess.run([bits, record], capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    rows: dict[str, list[list[int]]] = {letter: [] for letter in "LEZC"}
    for line in ran.stdout.splitlines():
        letter, *words = line.split()
        rows[letter].append([int(word, 16) for word in words])
    return {letter: np.array(row, dtype=np.uint32).reshape(-1, 4) for letter, row in rows.items()}


def numbers(words: Words) -> npt.NDArray[np.float32]:
    """The numbers that have these bits."""
    return words.copy().view(np.float32)


def same(given: npt.NDArray[np.float32], words: Words) -> bool:
    """Bit for bit, but that one NaN is as good as another."""
    expected = numbers(words)
    both_none = np.isnan(given) & np.isnan(expected)
    return bool(((given.view(np.uint32) == words) | both_none).all())


def test_the_estimator_gives_the_bits_of_the_core(model: Path, tmp_path: Path) -> None:
    table = pz.Table.read(model)
    words = vectors(table, tmp_path)
    codes, displacements, half_widths, statuses = words["E"].T
    assert len(codes) == 12000
    estimator, told_at = pz.Estimator(table), 8001
    before = estimator.run_codes(codes[:told_at].astype(np.uint16))
    (at_um, told, _, _), = words["Z"]
    assert told == 1
    estimator.set_zero(float(numbers(np.array([at_um]))[0]))
    after = estimator.run_codes(codes[told_at:].astype(np.uint16))
    displacement, half_width, status = (np.concatenate([one, other]) for one, other in zip(before, after))
    assert same(displacement, displacements) and same(half_width, half_widths) and (status == statuses).all()
    # One of the tables has an interval: from when the displacement was told on, but where the voltage is beyond its range.
    stated = np.isfinite(half_width)
    assert not stated[:told_at].any() and stated.any() == table.has_interval
    if table.has_interval:
        within = (status[told_at:] & (pz.VOLTAGE_OUT_OF_RANGE | pz.ADC_SATURATED)) == 0
        assert stated[told_at:][within].all() and not stated[told_at:].all()


def test_the_inverse_gives_the_bits_of_the_core(model: Path, tmp_path: Path) -> None:
    table = pz.Table.read(model)
    words = vectors(table, tmp_path)
    if not len(words["L"]):
        with pytest.raises(pz.PiezoError, match="this model has no inverse"):
            pz.Inverse(table, slew_v_per_s=100.0)
        return
    low, high, rest, slew = (float(number) for number in numbers(words["L"])[0])
    inverse = pz.Inverse(table, range_v=(low, high), rest_v=rest, slew_v_per_s=slew)
    wanted, voltages, displacements, reached_there = words["C"].T
    volts, displacement, reached = inverse.run(numbers(wanted))
    assert same(volts, voltages) and same(displacement, displacements) and (reached == reached_there).all()
    assert reached.any() and not reached.all()
