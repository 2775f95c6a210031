"""Moduli, laws and cards from arguments, compared with the files of the command."""

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rodlab
from rodlab import modulus, rheology
from same_as_command import command, expect_file

ROD: dict[str, Any] = {"length": "799 mm ± 0.3 mm", "diameter": "15.8 mm ± 0.03 mm", "density": "912 kg/m3 ± 0.3 kg/m3"}


def hits_of(folder: Path) -> rodlab.Hits:
    channels = {"struck end": "m/s2", "free end": "m/s2"}
    return rodlab.read("hits-*.npy", channels=channels, sampling_rate_hz=65_536, folder=folder)


def of(folder: Path) -> modulus.Modulus:
    return modulus.two_point(
        hits_of(folder),
        **ROD,
        accelerometer_mass="2.9 gram ± 0.03 gram",
        silent="1.6 ms",
        band=("100 Hz", 15_000),
        poisson_ratio=0,
        report_at=["2 kHz", "5 kHz", "10 kHz"],
    )


def test_two_points_laws_and_card_are_those_of_the_command(polypropylene: Path) -> None:
    assert command("modulus", polypropylene / "modulus.ron").returncode == 0
    files = polypropylene / "modulus-result"
    found = of(polypropylene)
    expect_file(found.lines, files / "modulus.csv")
    assert found.budget is not None
    expect_file(found.budget, files / "budget.csv")
    fit = rheology.fit(found, ["zener", "fractional zener", "generalised maxwell"])
    expect_file(fit.table("laws"), files / "laws.csv")
    card = fit.card("abaqus", name="PP", poisson_ratio="0.40")
    assert card == (files / "PP.inp").read_text()
    draws = fit.card_draws("abaqus", draws=3, name="PP", poisson_ratio="0.40 ± 0.02")
    assert len(set(draws)) == 3 and all("*VISCOELASTIC" in draw for draw in draws)
    parameters = fit.parameters("fractional zener")
    assert all(parameter.value is not None for parameter in parameters.values())
    assert len(parameters) == 4


def test_the_causal_modulus_of_all_lines_has_the_smaller_errors(polypropylene: Path) -> None:
    found = modulus.two_point(hits_of(polypropylene), **ROD, silent="1.6 ms", band=("100 Hz", 15_000), causal=True, accelerometer_mass="2.9 gram")
    assert of(polypropylene).causal is None
    assert found.causal is not None
    causal, lines = found.causal.columns(), found.lines.columns()
    assert np.all(np.diff(np.asarray(causal["frequency_hz"], dtype=np.float64)) > 0)
    column = "standard_error_loss_factor"
    own = np.asarray(causal[column], dtype=np.float64)
    of_lines = np.asarray(lines[column], dtype=np.float64)[found.valid]
    assert float(np.median(own)) < 0.3 * float(np.median(of_lines))


def test_three_and_more_points_are_those_of_the_command(frame: Path) -> None:
    assert command("modulus", frame / "modulus.ron").returncode == 0
    channels = {f"gauge {number}": "strain" for number in (1, 2, 3)}
    hits = rodlab.read("strains-*.npy", channels=channels, sampling_rate_hz="32.768 kHz", folder=frame)
    positions: dict[str, float | str] = {"gauge 1": "250 mm", "gauge 2": 0.4, "gauge 3": "550 mm"}
    options: dict[str, Any] = {"diameter": "16 mm", "density": "912 kg/m3 ± 0.3 kg/m3"}
    found = modulus.three_point(
        hits,
        gauges=positions,
        **options,
        silent=1.2e-3,
        band=(1_000, "7.5 kHz"),
        limits={"storage_modulus": "2 %", "loss_factor": "10 %"},
        poisson_ratio="0",
        report_at=["2 kHz", "4 kHz"],
    )
    expect_file(found.lines, frame / "modulus-result" / "modulus.csv")
    # for three gauges, the closed form and least squares solve the same equations
    squares = modulus.multi_point(hits, gauges=positions, **options, silent="1.2 ms", band=(1_000, 7_500), poisson_ratio=0)
    both = np.isin(squares.frequency_hz, found.frequency_hz[found.valid]) & squares.valid
    same = np.isin(found.frequency_hz, squares.frequency_hz[both])
    assert both.sum() > 50
    np.testing.assert_allclose(squares.modulus[both], found.modulus[same], rtol=2e-2)


def test_a_modulus_has_arrays_frames_and_figures(polypropylene: Path) -> None:
    found = of(polypropylene)
    lines = found.columns()
    assert found.valid.sum() > 100
    # true modulus of the virtual test in closed form, |E| = 2.6 GPa at 1.6 kHz with constant loss factor 0.07; tolerance: 1 % for a valid line
    exponent = 2 * np.arctan(0.07) / np.pi
    truth = 2.6e9 * (1j * found.frequency_hz[found.valid] / 1600) ** exponent
    np.testing.assert_allclose(found.modulus[found.valid], truth, rtol=0.01)
    np.testing.assert_allclose(found.modulus.imag / found.modulus.real, found.loss_factor, rtol=1e-12)
    np.testing.assert_allclose(found.standard_error.real, lines["standard_error_storage_modulus_pa"].astype(float), rtol=1e-12)
    frame = found.to_pandas()
    assert frame.attrs["units"]["storage_modulus_pa"] == "Pa"
    assert found.to_xarray()["storage_modulus_pa"].attrs["units"] == "Pa"
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(found)).valid, found.valid)
    import matplotlib

    matplotlib.use("Agg")
    axes = found.plot()
    assert [ax.get_ylabel() for ax in axes] == ["E' (GPa)", "loss factor"]
    drawn = axes[0].lines[1].get_ydata()
    np.testing.assert_array_equal(np.asarray(drawn)[found.valid], 1e-9 * found.lines.numbers("storage_modulus_pa")[found.valid])


def test_arguments_are_read_by_the_grammar_of_sheets(polypropylene: Path) -> None:
    hits = hits_of(polypropylene)
    rest: dict[str, Any] = {"diameter": 0.0158, "density": 912.0}
    cases: dict[Any, str] = {
        "799 kg": "specimen.length: `799 kg` has the dimension of a mass (kg), expected a length",
        "799": "specimen.length: `799` has no unit",
        -0.799: "specimen.length: `-0.799 m` is not above 0",
        float("nan"): "length is nan, expected a finite number",
        None: "length is None, expected a number in m",
        True: "length is True, expected a number in m",
    }
    for length, words in cases.items():
        with pytest.raises(rodlab.Error) as caught:
            modulus.two_point(hits, length=length, **rest)
        assert words in str(caught.value)
    with pytest.raises(rodlab.SheetError, match="found `Newten`, expected one of .* did you mean `Newton`"):
        modulus.two_point(hits, length=0.8, solver="Newten", **rest)
    with pytest.raises(rodlab.SheetError, match="`free`.*expected one of"):
        modulus.two_point(hits, length=0.8, free_end="free", silent=1e-3, **rest)
    with pytest.raises(rodlab.SheetError, match="did you mean `FractionalZener`"):
        rheology.fit(of(polypropylene), "fractional zenner")
    misspelt: dict[str, Any] = {"poison_ratio": 0.4}
    with pytest.raises(TypeError, match="unexpected keyword argument 'poison_ratio'; did you mean 'poisson_ratio'"):
        modulus.two_point(hits, length=0.8, **rest, **misspelt)


def test_a_modulus_that_the_data_do_not_allow_is_an_exception(polypropylene: Path) -> None:
    channels = {"struck end": "m/s2", "free end": "m/s2"}
    reject = {hit: "by eye" for hit in range(1, 6)}
    hits = rodlab.read("hits-*.npy", channels=channels, sampling_rate_hz=65_536, reject=reject, folder=polypropylene)
    assert [hit.accepted for hit in hits.hits] == 5 * [False]
    assert "by eye" in hits.hits[0].reasons[0]
    with pytest.raises(rodlab.NotAllowed) as caught:
        modulus.two_point(hits, length=0.799, diameter=0.0158, density="912 kg/m3 ± 0.1 %")
    assert caught.value.outcome.standing == "not allowed"
    assert len([entry for entry in caught.value.outcome.log if not entry["accepted"]]) >= 5
