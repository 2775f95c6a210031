"""Mobilities, forces between measured bodies and creep recovery from arguments, compared with the files of the command."""

from pathlib import Path

import numpy as np
import pytest
import rodlab
from conftest import EXAMPLES
from rodlab import force, mobility, sheet
from same_as_command import command, expect_files

NYLON = {"nylon": {"density": "1150 kg/m3", "law": sheet.ConstantQ(modulus="2.6 GPa", loss_factor="0.094", at="3 kHz")}}
BODY = sheet.Chain(elements=[sheet.Rod(material="nylon", diameter="60 mm", length="300 mm")])
TEXT = 'Chain(elements: [Rod(material: "nylon", diameter: "60 mm", length: "300 mm")])'
LAW = '{"nylon": (density: "1150 kg/m3", law: ConstantQ(modulus: "2.6 GPa", loss_factor: "0.094", at: "3 kHz"))}'
TEMPLATES = EXAMPLES.parent / "templates"


@pytest.fixture
def struck(tmp_path: Path) -> Path:
    """Virtual hammer hits on a nylon rod of 0.975 kg."""
    made = rodlab.simulate(
        sheet.HammerOnBody(body=BODY, blows={"hits": 5, "peak": "500 N", "duration": "200 us"}),
        instrument={"sampling_rate": "51.2 kHz", "length": "80 ms", "before": "5 ms", "noise": "0.02 %"},
        materials=NYLON,
        output="hit.csv",
    )
    for name, content in made.attachments.items():
        (tmp_path / name).write_bytes(content)
    return tmp_path


CHANNELS = {"hammer": "N", "face": "m/s2"}
FREE = 'support: Free(mass: "0.975 kg ± 1 gram"), up_to: "6 kHz", complete: (below: "100 Hz", fitted_to: "300 Hz")'


def test_a_measured_mobility_and_its_force_are_those_of_the_command(struck: Path) -> None:
    channels = ", ".join(f'(name: "{name}", from: {at}, unit: "{unit}")' for at, (name, unit) in enumerate(CHANNELS.items(), 1))
    hits = f'records: (files: ["hit-*.csv"], channels: [{channels}]), force: "hammer", response: "face", silent: "4 ms"'
    (struck / "body.ron").write_text(f'Mobility(title: "Nylon rod", source: Hits({hits}), {FREE})')
    assert command("mobility", struck / "body.ron").returncode in (0, 3)
    read = rodlab.read("hit-*.csv", channels=CHANNELS, folder=struck)
    found = mobility.of_hits(
        read,
        silent=4e-3,
        support=sheet.Free(mass="0.975 kg ± 1 gram"),
        up_to=6e3,
        complete=(100, 300),
        title="Nylon rod",
    )
    expect_files(found.tables, struck / "body-result")
    assert found.attachments["mobility.uff"] == (struck / "body-result" / "mobility.uff").read_bytes()
    assert found.standard_error is not None and found.valid.sum() > 300
    # tolerance: five standard errors of noise, and 2 % for the filter of the recorder
    exact = rodlab.rods.mobility(BODY, found.frequency_hz[1:], materials=NYLON)
    apart = np.abs(found.mobility[1:] - exact)[found.valid[1:]]
    error = (5 * found.standard_error[1:] + 0.02 * np.abs(exact))[found.valid[1:]]
    assert np.mean(apart < error) > 0.95

    first = 'Measured(file: "body-result/mobility.uff", support: Free(mass: "0.975 kg ± 1 gram"), front_impedance: "4.9e3 kg/s")'
    problem = f'first: {first}, second: Impedance("1000 kg/s"), velocity: "2 m/s ± 0.5 %", duration: "3 ms", band: "3 kHz"'
    (struck / "force.ron").write_text(f'Force(title: "Measured", problem: Impact({problem}))')
    assert command("force", struck / "force.ron").returncode in (0, 3)
    hammer = found.body(struck / "hammer.uff", support=sheet.Free(mass="0.975 kg ± 1 gram"), front_impedance="4.9e3 kg/s")
    met = force.predict(
        hammer, sheet.Impedance("1000 kg/s"), velocity="2 m/s ± 0.5 %", duration=3e-3, band=3e3, title="Measured"
    )
    expect_files(met.tables, struck / "force-result")
    with pytest.raises(FileExistsError):
        found.body(struck / "hammer.uff")


def test_files_and_two_tests_have_the_mobility_of_the_command(struck: Path) -> None:
    read = rodlab.read("hit-[1-5].csv", channels=CHANNELS, folder=struck)
    low = rodlab.read(["hit-1.csv", "hit-2.csv"], channels=CHANNELS, folder=struck)
    high = rodlab.read(["hit-3.csv", "hit-4.csv", "hit-5.csv"], channels=CHANNELS, folder=struck)

    def source(*numbers: int) -> str:
        files = ", ".join(f'"hit-{number}.csv"' for number in numbers)
        channels = '(name: "hammer", from: 1, unit: "N"), (name: "face", from: 2, unit: "m/s2")'
        return f'(records: (files: [{files}], channels: [{channels}]), force: "hammer", response: "face")'

    (struck / "merged.ron").write_text(
        f'Mobility(title: "Two hammers", source: TwoHammers(low: {source(1, 2)}, high: {source(3, 4, 5)}, merge: LargerInput))'
    )
    assert command("mobility", struck / "merged.ron").returncode in (0, 3)
    merged = mobility.of_two_hammers(low, high, merge="LargerInput", title="Two hammers")
    expect_files(merged.tables, struck / "merged-result")

    mobility.of_hits(read).body(struck / "mobility.uff")
    (struck / "file.ron").write_text('Mobility(title: "File", source: File(file: "mobility.uff"), up_to: "5 kHz")')
    assert command("mobility", struck / "file.ron").returncode in (0, 3)
    of_file = mobility.of_file("mobility.uff", up_to="5 kHz", title="File", folder=struck)
    expect_files(of_file.tables, struck / "file-result")


def test_a_computed_mobility_is_that_of_the_command_and_of_its_body(tmp_path: Path) -> None:
    (tmp_path / "body.ron").write_text(
        f'Mobility(title: "Computed", materials: {LAW}, source: Computed(body: {TEXT}, up_to: "4 kHz", lines: 64))'
    )
    assert command("mobility", tmp_path / "body.ron").returncode in (0, 3)
    found = mobility.of_body(BODY, highest=4e3, lines=64, materials=NYLON, title="Computed")
    expect_files(found.tables, tmp_path / "body-result")
    np.testing.assert_allclose(found.mobility[1:], rodlab.rods.mobility(BODY, found.frequency_hz[1:], materials=NYLON), rtol=1e-12)
    assert found.standard_error is None


def test_arguments_of_mobilities_are_refused_with_their_place(struck: Path) -> None:
    hits = rodlab.read("hit-*.csv", channels=CHANNELS, folder=struck)
    with pytest.raises(rodlab.SheetError, match="head_mass.*has the dimension of a length"):
        mobility.of_hits(hits, head_mass="3 m")
    with pytest.raises(rodlab.SheetError, match="up_to is nan"):
        mobility.of_hits(hits, up_to=float("nan"))
    with pytest.raises(rodlab.SheetError, match="1 channels, expected a force"):
        mobility.of_hits(rodlab.read("hit-*.csv", channels={"hammer": "N"}, folder=struck))
    with pytest.raises(rodlab.Error, match="read both with the same `folder`"):
        mobility.of_two_hammers(hits, rodlab.Hits((), CHANNELS, (), {}, {}, struck / "other"))


def test_recovery_is_that_of_the_command(tmp_path: Path) -> None:
    (tmp_path / "recovery.ron").write_bytes((TEMPLATES / "recovery.ron").read_bytes())
    assert command("recovery", tmp_path / "recovery.ron").returncode in (0, 3)

    def test(stress: str, minutes: dict[int, float], errors: dict[int, float]) -> dict[str, object]:
        readings = [{"at": f"{at} min", "value": value, "standard_error": errors.get(at)} for at, value in minutes.items()]
        return {"name": stress, "load": [sheet.Constant(stress=stress, duration="30 min")], "readings": sheet.Here(readings)}

    periodic = sheet.Periodic(mean="32 MPa", amplitude="13 MPa", frequency="4 Hz", duration="30 min")
    found = rodlab.recovery(
        [
            test("45 MPa", {1: 0.0435, 5: 0.0353, 10: 0.0321, 30: 0.0278, 60: 0.0266}, {60: 0.0006}),
            test("19 MPa", {1: 0.0272, 5: 0.0269, 10: 0.0268, 30: 0.0262, 60: 0.0260}, {}),
        ],
        series_modulus="3.1 GPa ± 50 MPa",
        frequency=10e3,
        virgin_loss_factor="0.025 ± 0.0002",
        standard_error=0.0004,
        predictions=[{"name": "4 Hz about 32 MPa", "load": [periodic]}],
        title="Polyoximethylene after creep loads",
    )
    expect_files(found.tables, tmp_path / "recovery-result")
    with pytest.raises(rodlab.SheetError, match="series_modulus.*has the dimension"):
        rodlab.recovery([], series_modulus="3 kg", frequency=1e4)
