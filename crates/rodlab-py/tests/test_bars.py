"""Waves of a bar and stress-strain curves, compared with the files of the command."""

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rodlab
from conftest import copy_of
from numpy.typing import NDArray
from rodlab import bars, sheet
from same_as_command import command, expect_files


def test_waves_of_a_bar_are_those_of_the_command(tmp_path: Path) -> None:
    folder = copy_of("polymer_bar", tmp_path)
    assert command("bar", folder / "bar.ron").returncode == 0
    channels: dict[str, Any] = {"gauge 1": "strain", "gauge 2": {"unit": "strain", "sensitivity": "1 ± 3 %"}}
    shot = rodlab.read("shot-1.npy", sampling_rate_hz="200 kHz", channels=channels, folder=folder)
    waves = bars.propagation(
        shot,
        length="2500 mm",
        diameter="20 mm",
        density="1190 kg/m3 ± 1 kg/m3",
        poisson_ratio=0,
        gauges={"gauge 1": "600 mm", "gauge 2": "200 mm"},
        silent="3 ms",
        band=(1e3, 6e3),
        limits={"storage_modulus": "1 %", "loss_factor": "30 %"},
        laws=["constant q", "fractional zener", "generalised maxwell"],
        report_at=["2 kHz", "4 kHz"],
        out=folder / "made",
    )
    expect_files(waves.tables, folder / "bar-result")
    assert (folder / "made" / "material.json").is_file()
    # the simulated bar has c = 1420 m/s at 10 kHz and a loss factor of 0.02: alpha is k/2 times the loss factor
    at = waves.wave_number
    np.testing.assert_allclose(waves.phase_velocity, waves.frequency_hz * 2 * np.pi / at, rtol=1e-12)
    np.testing.assert_allclose(waves.damping_coefficient[waves.valid], 0.01 * at[waves.valid], rtol=0.1)
    assert pickle.loads(pickle.dumps(waves)).standing == waves.standing


LAW = sheet.Prony(
    equilibrium="2.6 GPa",
    branches=[{"modulus": "0.2 GPa", "relaxation_time": "8 us"}, {"modulus": "0.2 GPa", "relaxation_time": "60 us"}],
)


def nylon_shot(folder: Path) -> rodlab.Hits:
    return rodlab.read("shot-1.npy", sampling_rate_hz="500 kHz", channels={"incident": "strain", "transmitted": "strain"}, folder=folder)


def curve_of(shots: rodlab.Hits | list[rodlab.Hits]) -> bars.StressStrain:
    return bars.stress_strain(
        shots,
        incident=bars.bar(material="nylon", diameter=0.02, length=1.8, gauges={"incident": 0.9}),
        transmitted=bars.bar(material="nylon", diameter=0.02, length=1.6, gauges={"transmitted": 0.4}),
        specimen_length=0.006,
        specimen_diameter=0.014,
        materials={"nylon": {"density": "1150 kg/m3", "law": LAW}},
        silent="250 us",
    )


def test_several_shots_have_a_mean_curve(tmp_path: Path) -> None:
    folder = copy_of("shpb", tmp_path)
    other = rodlab.simulate(
        sheet.HopkinsonBars(
            striker={"length": "200 mm", "diameter": "20 mm", "density": "1150 kg/m3", "modulus": "2.9 GPa"},
            velocity="12 m/s",
            incident={"material": "nylon", "diameter": "20 mm", "length": "1800 mm", "gauges": ["900 mm"]},
            transmitted={"material": "nylon", "diameter": "20 mm", "length": "1600 mm", "gauges": ["400 mm"]},
            specimen={
                "length": "6 mm",
                "diameter": "14 mm",
                "density": "1100 kg/m3",
                "modulus": "1.2 GPa",
                "law": sheet.Norton(exponent="4", rate_at_10_mpa="8 1/s"),
                "hardening": "50 MPa",
            },
        ),
        instrument={"sampling_rate": "500 kHz", "length": "2.6 ms", "before": "0.3 ms", "noise": "0.1 %"},
        materials={"nylon": {"density": "1150 kg/m3", "law": LAW}},
        output="shot.npy",
        seed=7,
        out=tmp_path / "other",
    )
    assert other.standing == "answered"
    curve = curve_of([nylon_shot(folder), nylon_shot(tmp_path / "other")])
    assert len(curve.strain) == len(curve.stress) == len(curve.stress_half_width_95) == len(curve.strain_rate) > 10
    one = curve_of(nylon_shot(folder))
    assert abs(curve.stress.max() / one.stress.max() - 1) < 0.02


def test_a_bar_has_a_material_or_a_wave_speed() -> None:
    wrong: list[dict[str, Any]] = [{}, {"material": "steel", "wave_speed": 5e3}, {"wave_speed": 5e3}]
    for more in wrong:
        with pytest.raises(rodlab.SheetError, match="expected `material`, or `density` and `wave_speed`"):
            bars.bar(diameter=0.02, length=1, gauges={"a": 0.5}, **more)


def test_moduli_in_memory_are_fitted_as_those_of_a_file(tmp_path: Path) -> None:
    """Checks, for a Zener model with 1 % of noise, that arrays and a table in a file give the same numbers, and that the parameters are right within their errors."""
    chance = np.random.default_rng(3)
    frequency = np.geomspace(1, 1e3, 31)
    turn = 2j * np.pi * frequency * 2e-3
    exact = 1e9 + 5e8 * turn / (1 + turn)
    error = 0.002 * np.abs(exact) * (1 + 1j)
    measured = exact + error.real * chance.standard_normal(31) + 1j * error.imag * chance.standard_normal(31)
    found = rodlab.rheology.of_arrays(
        frequency, measured, temperature="23 degC", standard_error=error, laws=["zener", "generalised maxwell"], density=1180, causal=True
    )
    assert found.causal is not None
    storage = np.asarray(found.causal.columns()["storage_modulus_pa"], dtype=np.float64)
    np.testing.assert_allclose(storage, exact.real, rtol=0.003)  # tolerance: about three standard errors
    for name, true in {"relaxed modulus": 1e9, "modulus increment": 5e8, "relaxation time": 2e-3}.items():
        one = found.parameters("zener")[name]
        assert one.value is not None and one.standard_error is not None
        assert abs(one.value - true) < 3.5 * one.standard_error
    lines = (f"{f!r},{m.real!r},{m.imag!r},{e.real!r},{e.imag!r}" for f, m, e in zip(frequency.tolist(), measured.tolist(), error.tolist(), strict=True))
    (tmp_path / "table.csv").write_text("f (Hz),S (Pa),L (Pa),dS (Pa),dL (Pa)\n" + "\n".join(lines))
    parts = sheet.Parts(storage="S", loss="L")
    table = {"files": ["table.csv"], "frequency": "f", "modulus": parts, "temperature": sheet.Stated("23 degC")}
    errors = sheet.Columns(sheet.Parts(storage="dS", loss="dL"))
    same = rodlab.rheology.sweep([table | {"errors": errors}], laws=["zener", "generalised maxwell"], density=1180, causal=True, folder=tmp_path)
    assert same.quantities == found.quantities
    np.testing.assert_allclose(same.modulus, measured, rtol=3e-16)  # tolerance: rounding of the conversion to GPa and back
    # a card reads the arrays again, which therefore must exist as long as the result
    ours, of_file = (one.card("ansys", name="M", poisson_ratio=0.4).splitlines() for one in (found, same))
    assert [line for line in ours if line not in of_file] == [line for line in ours if "source:" in line or "SHA-256" in line]


@pytest.mark.parametrize("test", ["relaxation", "creep"])
def test_moduli_over_time_in_memory_are_fitted(test: str) -> None:
    """Compares with closed forms of a Zener model under a load that grows for 3 s, at two temperatures with relaxation times a decade apart."""
    chance = np.random.default_rng(4)
    ramp, soft, step = 3.0, 1e9, 5e8

    def decay(time: NDArray[np.float64], tau: float) -> NDArray[np.float64]:
        return np.asarray(tau / ramp * (np.exp(-(time - ramp) / tau) - np.exp(-time / tau)), dtype=np.float64)

    def modulus(time: NDArray[np.float64], tau: float) -> NDArray[np.float64]:
        if test == "relaxation":
            return soft + step * decay(time, tau)
        return 1 / (1 / soft - (1 / soft - 1 / (soft + step)) * decay(time, tau * (soft + step) / soft))

    time = np.geomspace(4, 400, 40)
    exact = np.concatenate([modulus(time, 100.0), modulus(time, 10.0)])
    found = rodlab.rheology.over_time(
        np.tile(time, 2),
        exact * (1 + 0.002 * chance.standard_normal(80)),
        test=test,
        ramp=ramp,
        temperature=np.repeat([20.0, 40.0], 40),
        standard_error=0.002 * exact,
        reference_temperature="20 degC",
        laws="zener",
    )
    for name, true in {"relaxed modulus": soft, "modulus increment": step, "relaxation time": 100.0}.items():
        one = found.parameters("zener")[name]
        assert one.value is not None and one.standard_error is not None
        assert abs(one.value - true) < 3.5 * one.standard_error < 0.1 * true
    shift = found.table("shifts").numbers("log10_shift")
    np.testing.assert_allclose(shift, [0, -1], atol=0.02)
    assert found.time.shape == found.modulus_over_time.shape == (80,)
    found.plot()
    with pytest.raises(rodlab.SheetError, match="expected 'relaxation' or 'creep'"):
        rodlab.rheology.over_time([1.0], [1e9], test="Creep", temperature="23 degC")


def test_arrays_of_other_lengths_are_refused() -> None:
    with pytest.raises(rodlab.SheetError, match="the same number of each"):
        rodlab.rheology.of_arrays([1.0, 2.0], [1e9 + 1e8j], temperature="23 degC")
    with pytest.raises(rodlab.SheetError, match="modulus is not a vector of finite numbers"):
        rodlab.rheology.of_arrays([1.0, 2.0], [1e9 + 1e8j, np.nan], temperature="23 degC")
