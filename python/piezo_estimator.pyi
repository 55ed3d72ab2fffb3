"""Displacement of piezo actuators without a sensor: tables, estimator, inverse, logs, identification.

Volts are the amplifier's, micrometres (um) are relative to the model's zero, seconds are since a log's first sample. What is
refused raises PiezoError, in words.
"""

from collections.abc import Sequence
from os import PathLike
from typing import Final, Literal, final

import numpy as np
import numpy.typing as npt

__version__: Final[str]

ADC_SATURATED: Final[int]
"""The ADC stands at an end of its range."""
VOLTAGE_OUT_OF_RANGE: Final[int]
"""The voltage is beyond those the model was identified on; the nearest was taken."""
CLAMPED: Final[int]
"""The displacement was clamped to the table's limits."""
DAC_SATURATED: Final[int]
"""The DAC's code stands at an end of its range."""
NOT_SETTLED: Final[int]
"""The estimate still depends on where it was assumed to start."""
OUT_OF_REACH: Final[int]
"""What is wanted cannot be had at this tick."""
UNTRAINED: Final[int]
"""The voltage has gone as it never went in the training."""
SLEW_EXCEEDED: Final[int]
"""The voltage has leapt as the amplifier cannot; the last one before was taken. A device says so."""

_Numbers = npt.NDArray[np.floating] | npt.NDArray[np.integer] | Sequence[float]
_Path = str | PathLike[str]

class PiezoError(ValueError):
    """What a file, a table, a log or a request is refused for, in words."""

@final
class Table:
    """A parameter table that was admitted: stable, and proven to stay within its limits."""

    @staticmethod
    def read(path: _Path) -> Table:
        """Reads and admits a table.toml, or the record in a table.bin. Warns where it lies beside a face of another table."""
    def write(self, folder: _Path, *, force: bool = False) -> None:
        """Writes table.toml, table.rs and table.bin into a folder, all or none; the folder is made where there is none.

        A file of such a name that is no former face of a table is refused, or lost with force.
        """
    def record(self) -> bytes:
        """The record, as table.bin and the board's flash hold it."""
    def prepare(self, log: Log) -> Session:
        """A log at the table's tick, prepared by its recipe."""
    @property
    def model(self) -> str:
        """Name of the model."""
    @property
    def checksum(self) -> str:
        """Checksum of the record, by which programs and boards name the table."""
    @property
    def sample_period_s(self) -> float:
        """Time between two ticks, s."""
    @property
    def voltage_range_v(self) -> tuple[float, float]:
        """Amplifier voltages that the model was identified on, V."""
    @property
    def displacement_limits_um(self) -> tuple[float, float]:
        """The estimate never leaves these but by what it was told, um relative to the model's zero."""
    @property
    def displacement_zero_um(self) -> float:
        """Reading of the sensor that the model calls 0, um."""
    @property
    def has_interval(self) -> bool:
        """Whether it states how far the estimate may be off."""
    @property
    def has_drive(self) -> bool:
        """Whether it states limits within which an amplifier may be driven."""
    @property
    def doubts(self) -> list[str]:
        """Reasons not to trust it, in words; none are known of a record."""
    @property
    def determined(self) -> list[str]:
        """What the training determined of the actuator, in words; nothing is known of a record."""

@final
class Estimator:
    """A running estimator in f32, as the board has it. What it has seen stays from one run to the next."""

    def __new__(cls, table: Table) -> Estimator: ...
    def run(
        self, volts: _Numbers
    ) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32], npt.NDArray[np.uint8]]:
        """One tick for each amplifier voltage, V, rounded to f32.

        Displacement at the tick after it (um relative to the model's zero, plus the bias), half the width of its 95 % interval
        (um; NaN where there is none), and the status, of each tick.
        """
    def run_codes(
        self, codes: npt.NDArray[np.uint16]
    ) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32], npt.NDArray[np.uint8]]:
        """The same for the codes of an ADC with the table's calibration."""
    def set_zero(self, at_um: float = 0.0) -> None:
        """Calls the displacement of now at_um, where a stop, a gauge or rest tells it; the interval is relative to it.

        Refused as a device does: beyond the span of the table's limits, before the first tick, and while an actuator that moved
        then is on its way.
        """
    def start_at(self, displacement_um: float) -> bool:
        """Starts anew from a known displacement, um; whether it lay within the table's limits, the nearest of which it becomes."""
    def restart(self) -> None:
        """Starts anew, from rest at the next tick's voltage; what was told is forgotten."""
    @property
    def bias_um(self) -> float:
        """What is added to the model's displacement, as it was told, um."""

@final
class Inverse:
    """A running inverse in f32, as the board has it: from rest at the rest voltage. What it has given stays from run to run."""

    def __new__(
        cls,
        table: Table,
        *,
        range_v: tuple[float, float] | None = None,
        rest_v: float | None = None,
        slew_v_per_s: float | None = None,
    ) -> Inverse:
        """Limits that are not stated are the table's drive's; else all voltages of the model, and rest at 0 V or next to it."""
    def run(
        self, displacement_um: _Numbers
    ) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32], npt.NDArray[np.bool_]]:
        """One tick for each displacement (um) that is wanted a tick after the voltage stands.

        Amplifier voltage from the next tick on (V), displacement that the model gives for it (um), and whether that is what was
        wanted, of each tick.
        """
    def release(
        self, ticks: int
    ) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32], npt.NDArray[np.bool_]]:
        """So many ticks, at most 100 000 000, towards the rest voltage, as fast as the limits allow."""
    def restart(self) -> None:
        """Starts anew, long at rest at the rest voltage."""
    @property
    def range_v(self) -> tuple[float, float]:
        """Amplifier voltages within which it stays, V."""
    @property
    def rest_v(self) -> float:
        """Amplifier voltage at which it rests, V."""
    @property
    def slew_v_per_s(self) -> float:
        """Fastest change of the voltage, V/s."""

@final
class Log:
    """One recorded session, as its file has it, in s, V and um."""

    @property
    def name(self) -> str:
        """File name without its extension."""
    @property
    def sha256(self) -> str:
        """SHA-256 of the file's bytes, in hexadecimal."""
    @property
    def sample_period_s(self) -> float:
        """Sample period, s."""
    @property
    def time_s(self) -> npt.NDArray[np.float64]:
        """Time of each sample since the first, s."""
    @property
    def volts(self) -> npt.NDArray[np.float64]:
        """Voltage of each sample, V; empty where the log has none."""
    @property
    def displacement_um(self) -> npt.NDArray[np.float64] | None:
        """Displacement of each sample, um; None where the log has none."""
    @property
    def displacement_estimated(self) -> bool:
        """Whether the displacement is a device's estimate, and no sensor's."""

@final
class Session:
    """A log at the tick: a voltage at every tick, a displacement at the instants where it was measured."""

    @property
    def name(self) -> str:
        """Name of the log it comes from."""
    @property
    def time_s(self) -> npt.NDArray[np.float64]:
        """Time of each tick since the log's first sample, s."""
    @property
    def volts(self) -> npt.NDArray[np.float64]:
        """Amplifier voltage at each tick, V."""
    @property
    def instants(self) -> npt.NDArray[np.int64]:
        """Ticks at which the displacement was measured, counted from 0."""
    @property
    def displacement_um(self) -> npt.NDArray[np.float64]:
        """Measured displacement at the instants, um relative to the model's zero."""

@final
class Figures:
    """Errors of an estimate, um or % of the measured stroke, at the measured instants that are scored."""

    @property
    def mae_um(self) -> float:
        """Mean absolute error, um."""
    @property
    def max_um(self) -> float:
        """Largest absolute error, um."""
    @property
    def rmse_um(self) -> float:
        """Root mean square error, um."""
    @property
    def stroke_um(self) -> float:
        """Measured displacement, peak to peak without spikes, um."""
    @property
    def offset_um(self) -> float:
        """Median of estimate - measurement, um."""
    @property
    def mae_without_offset_um(self) -> float:
        """Mean absolute error without that offset, um."""
    @property
    def rmse_without_offset_um(self) -> float:
        """Root mean square error without the mean of estimate - measurement, um."""
    @property
    def mae_percent(self) -> float:
        """Mean absolute error in % of the stroke."""
    @property
    def max_percent(self) -> float:
        """Largest absolute error in % of the stroke."""

@final
class Identified:
    """What an identification found."""

    @property
    def table(self) -> Table:
        """The table of the chosen model."""
    @property
    def reason(self) -> str:
        """Why that model was chosen."""
    @property
    def training(self) -> Figures | None:
        """Errors of the f64 reference on what the table was fitted to."""
    @property
    def held_out(self) -> Figures | None:
        """The same of the model before it was fitted to what had been held out, on that; None where nothing was."""
    @property
    def candidates(self) -> list[tuple[str, Figures | None]]:
        """Every model that was identified, simplest first, with its errors on what was held out, else in training."""
    @property
    def doubts(self) -> list[str]:
        """Reasons not to trust it."""
    @property
    def determined(self) -> list[tuple[str, str]]:
        """What the training determined of the actuator: what, and what was found."""

def read_log(
    path: _Path,
    *,
    columns: str | None = None,
    sensor: str | None = None,
    fs: float | None = None,
    displacement_required: bool = True,
    voltage_required: bool = True,
    holes: bool = False,
) -> Log:
    """Reads a log of any of the formats that `piezo look` reads.

    columns says which column holds what ("time=1,voltage=2:mV,displacement=5:um"), sensor how far a volt of the sensor is
    ("2.5um/V"), and fs the sample rate in Hz, where the file does not.
    With holes, a voltage or displacement that is no number, and samples that the time stamps leave out, are left out by
    identify(..., repair=True) instead of refused.
    """

def validate(
    table: Table,
    log: Log,
    *,
    told: Literal["nothing", "first-reading", "one-cycle", "offset"] = "first-reading",
    from_s: float | None = None,
    to_s: float | None = None,
    zero_at_s: float | None = None,
) -> Figures:
    """Errors of a table's estimate on a log, as `piezo validate` has them, over the part of the log that is scored."""

def identify(
    logs: Sequence[Log],
    *,
    validate_on: Sequence[Log] = (),
    hold_out: float | None = None,
    as_judged: bool = False,
    model: str = "auto",
    lag_ms: float | None = None,
    delay_ms: float | Literal["auto"] = 0.0,
    repair: bool = False,
    tick_us: int = 500,
    voltage_scale: float = 1.0,
    displacement_scale: float = 1.0,
    skip_start_s: float = 0.0,
    skip_end_s: float = 0.0,
    adc_span: tuple[float, float] | None = None,
    adc_full_scale: int | None = None,
    amplifier_slew: float | None = None,
    dac_span: tuple[float, float] | None = None,
    dac_full_scale: int | None = None,
    devices: int = 12,
    evaluations: int = 250,
    seed: int = 1,
) -> Identified:
    """Identifies a table from logs, as `piezo identify` does with the options of the same names, and says of them.

    Of each of `logs` the fraction `hold_out` is held out, its end or, where the ends go beyond what is before, stretches;
    it is learnt from in the end, unless `as_judged`.

    Ctrl-C ends it between two generations of a search.
    """
