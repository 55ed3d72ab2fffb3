"""The inverse over arrays leads the model where it is wanted."""

import signal
import threading

import numpy as np
import numpy.typing as npt
import piezo_estimator as pz
import pytest
from conftest import TABLE


def wanted() -> npt.NDArray[np.float64]:
    """A sine about where the drive can hold the actuator, µm."""
    return np.asarray(15.0 + 5.0 * np.sin(2.0 * np.pi * np.arange(4000) / 2000.0))


def test_the_model_of_its_voltages_goes_where_it_is_wanted() -> None:
    inverse = pz.Inverse(pz.Table.read(TABLE))
    volts, displacement, reached = inverse.run(wanted())
    low, high = inverse.range_v
    assert ((low <= volts) & (volts <= high)).all()
    # In f32, in which the voltages are: a step may be a rounding longer.
    assert np.abs(np.diff(volts)).max() <= inverse.slew_v_per_s * 5e-4 * (1 + 1e-5)
    # From rest it takes a while; then it is there to a ten-thousandth of the limits.
    assert not reached[0] and reached[1000:].all()
    assert np.abs(displacement - wanted())[1000:].max() < 0.01


def test_it_goes_on_from_where_it_was_and_back_to_rest() -> None:
    table = pz.Table.read(TABLE)
    whole, parts = pz.Inverse(table), pz.Inverse(table)
    expected = whole.run(wanted())[0]
    cut = np.concatenate([parts.run(part)[0] for part in np.array_split(wanted(), 3)])
    assert expected.tobytes() == cut.tobytes()
    assert whole.release(4000)[0][-1] == np.float32(whole.rest_v)


def test_no_more_ticks_than_there_is_memory_for_are_asked_for() -> None:
    inverse = pz.Inverse(pz.Table.read(TABLE))
    for many in (100_000_001, 10**15):
        with pytest.raises(pz.PiezoError, match="at most 100000000"):
            inverse.release(many)


def test_control_c_ends_a_run_and_takes_it_back() -> None:
    table = pz.Table.read(TABLE)
    inverse, untouched = pz.Inverse(table), pz.Inverse(table)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    stop = threading.Timer(0.2, signal.raise_signal, [signal.SIGINT])
    try:
        with pytest.raises(KeyboardInterrupt):
            stop.start()
            inverse.release(100_000_000)
    finally:
        stop.cancel()
        signal.signal(signal.SIGINT, before)
    assert inverse.run(wanted())[0].tobytes() == untouched.run(wanted())[0].tobytes()


def test_without_a_drive_somebody_must_say_how_fast() -> None:
    table = pz.Table.read(TABLE.parents[1] / "table.toml")
    with pytest.raises(pz.PiezoError, match="slew_v_per_s"):
        pz.Inverse(table)
    low, high = pz.Inverse(table, slew_v_per_s=100).range_v
    # What the training went over, without the twentieth at either end that the estimate covers beside it.
    lowest, highest = table.voltage_range_v
    margin = (highest - lowest) * 0.05 / 1.1
    assert (low, high) == pytest.approx((lowest + margin, highest - margin), abs=1e-6)
    with pytest.raises(pz.PiezoError, match="range_v"):
        pz.Inverse(table, slew_v_per_s=100, range_v=(0.0, 500.0))
