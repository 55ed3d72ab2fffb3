"""The estimator over arrays gives the program's numbers, bit for bit."""

import tomllib
from pathlib import Path

import numpy as np
import piezo_estimator as pz
import pytest
from conftest import LOG, TABLE, piezo, piezo_json


def told_the_first_reading(table: pz.Table) -> tuple[pz.Session, pz.Estimator]:
    session, estimator = table.prepare(pz.read_log(LOG)), pz.Estimator(table)
    # Beyond the table's limits, as one model's first reading is, it starts at the nearest, which the program does, too.
    low, high = table.displacement_limits_um
    assert estimator.start_at(session.displacement_um[0]) == (low <= session.displacement_um[0] <= high)
    return session, estimator


def test_errors_summed_from_the_arrays_are_those_of_validate(model: Path) -> None:
    session, estimator = told_the_first_reading(pz.Table.read(model))
    displacement = estimator.run(session.volts)[0]
    at = session.instants[1:] - 1
    error = displacement[at].astype(float) - session.displacement_um[1:]
    expected = piezo_json("validate", model, LOG)["all"]["told"]["first_reading"]
    # In the order in which the program adds them: one bit of one estimate would show.
    assert np.abs(error).cumsum()[-1] / len(error) == expected["mae_um"]
    assert np.sqrt((error * error).cumsum()[-1] / len(error)) == expected["rmse_um"]
    assert np.abs(error).max() == expected["max_um"]


def test_estimate_interval_and_status_are_the_rows_that_validate_writes(tmp_path: Path) -> None:
    rows = tmp_path / "estimates.csv"
    piezo("validate", TABLE, LOG, "--out", rows)
    session, estimator = told_the_first_reading(pz.Table.read(TABLE))
    displacement, half_width, status = estimator.run(session.volts)
    zero_um = zero_of(TABLE)
    written = [line.split(",") for line in rows.read_text().splitlines()[1:]]
    assert len(written) == len(session.instants) - 1
    widths = 0
    for row, tick, before in zip(written, session.instants[1:], session.instants):
        assert row[3] == f"{float(displacement[tick - 1]) + zero_um:.6f}"
        half = float(half_width[tick - 1])
        assert row[4] == ("" if np.isnan(half) else f"{half:.6f}")
        widths += not np.isnan(half)
        raised = int(np.bitwise_or.reduce(status[before:tick]))
        assert {name for name in row[5].split("|") if name} == {name for name in NAMES if raised & getattr(pz, name)}
    assert widths > 1000


def zero_of(table: Path) -> float:
    """What the recipe takes off the sensor's reading, in all the digits of table.toml, µm."""
    recipe: dict[str, float] = tomllib.loads(table.read_text())["recipe"]
    assert recipe["displacement_scale"] == 1.0
    return recipe["displacement_zero_um"]


NAMES = ("ADC_SATURATED", "VOLTAGE_OUT_OF_RANGE", "CLAMPED", "DAC_SATURATED", "NOT_SETTLED", "OUT_OF_REACH", "UNTRAINED", "SLEW_EXCEEDED")


def test_one_run_is_as_many_as_it_is_cut_into_and_a_restart_forgets() -> None:
    table = pz.Table.read(TABLE)
    volts = table.prepare(pz.read_log(LOG)).volts[:4000]
    whole, parts = pz.Estimator(table), pz.Estimator(table)
    expected = whole.run(volts)[0]
    cut = np.concatenate([parts.run(part)[0] for part in np.array_split(volts, 7)])
    assert expected.tobytes() == cut.tobytes()
    whole.restart()
    assert whole.run(volts)[0].tobytes() == expected.tobytes()


def test_codes_are_the_voltages_that_the_adc_stands_for() -> None:
    table = pz.Table.read(TABLE)
    codes = np.arange(0, 4096, 7, dtype=np.uint16)
    by_code, _, status = pz.Estimator(table).run_codes(codes)
    low, _ = table.voltage_range_v
    assert status[0] & pz.ADC_SATURATED and not status[1] & pz.ADC_SATURATED
    # The assumed calibration of the table's ADC reaches beyond the voltages at both ends.
    assert status[0] & pz.VOLTAGE_OUT_OF_RANGE and status[-1] & pz.VOLTAGE_OUT_OF_RANGE
    # Beyond them the nearest is taken.
    assert by_code[0] == pz.Estimator(table).run([low])[0][0]


def test_an_interval_begins_with_a_zero_that_may_be_told() -> None:
    table = pz.Table.read(TABLE)
    volts = table.prepare(pz.read_log(LOG)).volts[:8000]
    estimator = pz.Estimator(table)
    _, half_width, status = estimator.run(volts)
    assert np.isnan(half_width).all() and status[0] & pz.NOT_SETTLED
    estimator.set_zero(5.0)
    displacement, half_width, _ = estimator.run(volts[-1:])
    assert np.isfinite(half_width).all() and abs(displacement[0] - 5.0) < 0.5
    assert estimator.bias_um != 0.0


def test_arrays_of_any_stride_and_type_are_the_same_numbers() -> None:
    table = pz.Table.read(TABLE)
    volts = table.prepare(pz.read_log(LOG)).volts[:1000].astype(np.float32)
    packed = np.zeros(1000, dtype=[("at", np.uint8), ("volts", np.float32), ("code", np.uint16)])
    packed["volts"], packed["code"] = volts, 65 * np.arange(1000)
    expected = pz.Estimator(table).run(volts)[0].tobytes()
    for same in (
        np.repeat(volts, 2)[::2],
        volts[::-1].copy()[::-1],
        np.column_stack([volts, -volts])[:, 0],
        np.asfortranarray(np.stack([volts, -volts]))[0],
        packed["volts"],
        volts.astype(float),
        volts.astype(">f4"),
        volts.tolist(),
    ):
        assert pz.Estimator(table).run(same)[0].tobytes() == expected
    codes = packed["code"].copy()
    by_code = pz.Estimator(table).run_codes(codes)[0].tobytes()
    for same_codes in (np.repeat(codes, 2)[::2], codes[::-1].copy()[::-1], packed["code"]):
        assert pz.Estimator(table).run_codes(same_codes)[0].tobytes() == by_code


def test_a_zero_beyond_the_span_of_the_limits_is_refused_as_by_a_device() -> None:
    table = pz.Table.read(TABLE)
    estimator = pz.Estimator(table)
    estimator.run(np.zeros(8000))
    low, high = table.displacement_limits_um
    for beyond in (high - low + 1.0, low - high - 1.0):
        with pytest.raises(pz.PiezoError, match="the span of the table's displacement limits"):
            estimator.set_zero(beyond)
    assert estimator.bias_um == 0.0
    estimator.set_zero(high)
    assert estimator.bias_um != 0.0
