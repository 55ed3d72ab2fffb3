"""What is refused says so in words, and nothing else happens."""

import shutil
from pathlib import Path

import numpy as np
import piezo_estimator as pz
import pytest
from conftest import DATA, LOG, TABLE


def test_a_table_that_admission_refuses(tmp_path: Path) -> None:
    edited = tmp_path / "table.toml"
    text = TABLE.read_text()
    line = next(line for line in text.splitlines() if line.startswith("sample_period_us"))
    edited.write_text(text.replace(line, "sample_period_us = 0"))
    with pytest.raises(pz.PiezoError, match="table.toml: is refused, for line .*sample_period_us"):
        pz.Table.read(edited)


def test_a_record_with_a_wrong_bit(tmp_path: Path) -> None:
    record = bytearray(TABLE.with_name("table.bin").read_bytes())
    assert pz.Table.read(TABLE.with_name("table.bin")).record() == record
    record[40] ^= 1
    damaged = tmp_path / "table.bin"
    damaged.write_bytes(record)
    with pytest.raises(pz.PiezoError, match="checksum"):
        pz.Table.read(damaged)
    damaged.write_bytes(b"")
    with pytest.raises(pz.PiezoError, match="is refused"):
        pz.Table.read(damaged)


def test_a_table_beside_the_face_of_another_is_read_with_a_warning(tmp_path: Path) -> None:
    shutil.copy(TABLE, tmp_path / "table.toml")
    shutil.copy(DATA / "table" / "table.bin", tmp_path / "table.bin")
    with pytest.warns(UserWarning, match="table.bin beside it"):
        pz.Table.read(tmp_path / "table.toml")


@pytest.mark.parametrize("face", ["table.toml", "table.rs", "table.bin"])
def test_a_table_is_not_written_over_a_stranger_s_file(face: str, tmp_path: Path) -> None:
    table, stranger = pz.Table.read(TABLE), tmp_path / face
    stranger.write_text("wages")
    with pytest.raises(pz.PiezoError, match=f"{face}: is there already, .* force=True"):
        table.write(tmp_path)
    assert [file.read_text() for file in tmp_path.iterdir()] == ["wages"]
    table.write(tmp_path, force=True)
    assert (tmp_path / "table.bin").read_bytes() == table.record()
    # A former face is.
    table.write(tmp_path)


def test_a_record_does_not_say_how_logs_are_prepared() -> None:
    table = pz.Table.read(TABLE.with_name("table.bin"))
    assert table.model == "generalised-prandtl-ishlinskii" and table.doubts == []
    with pytest.raises(pz.PiezoError, match="read the table.toml"):
        table.prepare(pz.read_log(LOG))


def test_logs_that_are_none(tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    with pytest.raises(pz.PiezoError, match="log.csv"):
        pz.read_log(log)
    rows = [f"{k / 200},{k % 7},{k % 5}" for k in range(40)]
    log.write_text("\n".join(["time_s,voltage_V,displacement_um", *rows[:20], "0.1,volts,3", *rows[20:]]))
    with pytest.raises(pz.PiezoError, match=r"log.csv:22: .*volts"):
        pz.read_log(log)
    log.write_text("\n".join(["time_s,voltage_V", *(row.rsplit(",", 1)[0] for row in rows)]))
    with pytest.raises(pz.PiezoError, match="displacement"):
        pz.read_log(log)
    assert pz.read_log(log, displacement_required=False).displacement_um is None
    with pytest.raises(pz.PiezoError, match="quantity"):
        pz.read_log(log, columns="colour=3")


def test_columns_and_units_are_what_is_said_of_them(tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    log.write_text("\n".join(f"{1000 * (k % 9)}\t{(k % 9) / 10}" for k in range(40)))
    read = pz.read_log(log, columns="voltage=1:mV,displacement=2", sensor="2.5um/V", fs=500.0)
    assert read.sample_period_s == 0.002 and read.time_s[-1] == pytest.approx(39 * 0.002)
    assert read.volts[:3].tolist() == [0.0, 1.0, 2.0]
    assert read.displacement_um is not None and read.displacement_um[4] == pytest.approx(1.0)


def test_arrays_that_are_none_change_nothing() -> None:
    table = pz.Table.read(TABLE)
    estimator, untouched = pz.Estimator(table), pz.Estimator(table)
    for wrong in (np.array([1.0, np.nan]), np.array([1.0, np.inf]), np.array([1.0, 1e300])):
        with pytest.raises(pz.PiezoError, match=r"volts\[1\] is not a finite number"), np.errstate(over="ignore"):
            estimator.run(wrong)
    with pytest.raises((TypeError, ValueError)):
        estimator.run(np.zeros((2, 2)))
    with pytest.raises((TypeError, ValueError)):
        estimator.run("volts")  # type: ignore[arg-type]
    with pytest.raises(pz.PiezoError, match="complex"):
        estimator.run(np.array([1.0 + 1.0j]))
    with pytest.raises(pz.PiezoError, match="complex"):
        estimator.run([1.0, 1.0j])  # type: ignore[list-item]
    with pytest.raises(TypeError):
        # As a uint16 it would be code 0.
        estimator.run_codes(np.array([65536], dtype=np.int32))
    with pytest.raises(pz.PiezoError, match="may not be told yet"):
        estimator.set_zero(0.0)
    with pytest.raises(pz.PiezoError, match="at_um"):
        estimator.set_zero(float("nan"))
    volts = np.linspace(0.0, 3.0, 100)
    assert estimator.run(volts)[0].tobytes() == untouched.run(volts)[0].tobytes()
    assert estimator.run([])[0].shape == (0,)
