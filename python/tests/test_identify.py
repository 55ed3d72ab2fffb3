"""What is identified is what the program identifies."""

import ast
import inspect
import re
import signal
import threading
from pathlib import Path

import piezo_estimator as pz
import pytest
from conftest import LOG, PYTHON, TABLE, piezo, piezo_json


def test_the_table_is_the_program_s_to_the_last_byte(tmp_path: Path) -> None:
    found = pz.identify([pz.read_log(LOG)], model="prandtl-ishlinskii", devices=2, evaluations=40)
    theirs = tmp_path / "program"
    said = piezo_json(
        *("identify", LOG, "--model", "prandtl-ishlinskii", "--devices", "2", "--evaluations", "40", "--out", theirs)
    )
    ours = tmp_path / "python"
    found.table.write(ours)
    for face in ("table.toml", "table.rs", "table.bin"):
        assert (ours / face).read_bytes() == (theirs / face).read_bytes(), face
    assert found.table.record() == (ours / "table.bin").read_bytes()
    assert found.reason == said["reason"] and found.held_out is not None
    assert found.held_out.mae_um == said["candidates"][-1]["held_out"]["mae_um"]
    assert found.candidates[-1][0] == found.table.model == "prandtl-ishlinskii"
    assert found.doubts == found.table.doubts and any("single frequency" in doubt for doubt in found.doubts)
    assert found.determined[0][0] == "The training" and found.table.has_interval
    assert repr(found).startswith(f"<Identified prandtl-ishlinskii, {found.table.checksum}, ")
    assert repr(found.table.prepare(pz.read_log(LOG))).startswith("<Session picma-p885-1hz, ")


@pytest.mark.parametrize("told", ["nothing", "first-reading", "one-cycle", "offset"])
def test_validate_has_the_program_s_figures(told: str) -> None:
    figures = pz.validate(pz.Table.read(TABLE), pz.read_log(LOG), told=told, from_s=10.0)  # type: ignore[arg-type]
    expected = piezo_json("validate", TABLE, LOG, "--from", "10")["all"]["told"][told.replace("-", "_")]
    names = [name for name in dir(figures) if not name.startswith("_")]
    assert len(names) == 9 and {name: getattr(figures, name) for name in names}.items() <= expected.items()


def test_before_a_zero_a_device_is_told_nothing() -> None:
    zeroed = pz.validate(pz.Table.read(TABLE), pz.read_log(LOG), zero_at_s=20.0)
    report = piezo_json("validate", TABLE, LOG, "--zero-at", "20")
    assert zeroed.mae_um == report["judged"]["mae_um"] == report["all"]["told"]["nothing"]["mae_um"]


def test_control_c_ends_a_search() -> None:
    log = pz.read_log(LOG)
    # A shell has what it starts in the background ignore it, and Python leaves that so.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    stop = threading.Timer(0.5, signal.raise_signal, [signal.SIGINT])
    try:
        with pytest.raises(KeyboardInterrupt):
            stop.start()
            # Hours, if nothing ended it.
            pz.identify([log], model="enhanced", devices=0, evaluations=1_000_000)
    finally:
        stop.cancel()
        signal.signal(signal.SIGINT, before)


def test_a_request_that_makes_no_sense_is_refused_in_words() -> None:
    log = pz.read_log(LOG)
    for wrong, words in [
        ({"hold_out": 1.5}, "between 0 and 1"),
        ({"model": "magic"}, "not \"magic\""),
        ({"delay_ms": -1.0}, "0 or positive"),
        ({"tick_us": 1}, "tick_us must lie between"),
        ({"voltage_scale": 0.0}, "voltage_scale"),
        ({"adc_span": (1.0, 1.0)}, "adc_span"),
        ({"amplifier_slew": 0.0}, "amplifier_slew"),
        ({"displacement_scale": -1.0}, "falls while the voltage rises"),
        ({"validate_on": [log]}, "same bytes"),
    ]:
        with pytest.raises(pz.PiezoError, match=words):
            pz.identify([log], **wrong)  # type: ignore[arg-type]
    with pytest.raises(pz.PiezoError, match="name each log once"):
        pz.identify([log, log])
    with pytest.raises(pz.PiezoError):
        pz.identify([])


@pytest.mark.parametrize("missing", ["displacement", "voltage"])
def test_a_log_without_a_quantity_tells_its_length_and_is_not_learnt_from(missing: str, tmp_path: Path) -> None:
    half = tmp_path / "half.csv"
    name = {"displacement": "voltage_V", "voltage": "displacement_um"}[missing]
    half.write_text("\n".join([f"time_s,{name}", *(f"{k / 200},{k % 7}" for k in range(40))]))
    log = pz.read_log(half, displacement_required=False, voltage_required=False)
    assert repr(log) == "<Log half, 0.200 s>"
    with pytest.raises(pz.PiezoError, match=f"half.csv: holds no {missing}"):
        pz.identify([log])


def test_defaults_are_those_of_the_program_and_of_the_stubs() -> None:
    said = {name: of.default for name, of in inspect.signature(pz.identify).parameters.items()}
    assert len(said) == 21 and said.pop("logs") is inspect.Parameter.empty
    (stub,) = [
        node
        for node in ast.parse((PYTHON / "piezo_estimator.pyi").read_text()).body
        if isinstance(node, ast.FunctionDef) and node.name == "identify"
    ]
    defaults = [ast.literal_eval(default) for default in stub.args.kw_defaults if default is not None]
    assert said == dict(zip((keyword.arg for keyword in stub.args.kwonlyargs), defaults, strict=True))
    options = re.split(r"^ +(?:-\w, )?--", piezo("identify", "--help"), flags=re.MULTILINE)
    program = {option.split()[0].replace("-", "_"): re.search(r"\[default: (.*)\]", option) for option in options[1:]}
    of_python = {"delay": "delay_ms", "skip_start": "skip_start_s", "skip_end": "skip_end_s"}
    compared = 0
    for option, default in program.items():
        name = of_python.get(option, option)
        if default is not None and name in said:
            assert default[1] == (said[name] if isinstance(said[name], str) else f"{said[name]:g}"), option
            compared += 1
    assert compared == 9
