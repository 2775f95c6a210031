"""Predicted forces, compared with the files of the command and with momentum."""

from pathlib import Path

import numpy as np
import pytest
import rodlab
from rodlab import force, sheet
from same_as_command import command, expect_files

MATERIALS = {
    "nylon": {"density": "1150 kg/m3", "law": sheet.ConstantQ(modulus="2.6 GPa", loss_factor="0.094", at="3 kHz")},
    "steel": {"density": "7780 kg/m3", "law": sheet.Elastic(modulus="206 GPa")},
}
CONE = sheet.Chain(elements=[sheet.Cone(material="nylon", near="75 mm", far="30 mm", length="400 mm")])
ROD = sheet.LongRod(material="steel", diameter="10 mm")


def test_a_force_is_that_of_the_command(cone: Path) -> None:
    assert command("force", cone / "force.ron").returncode == 0
    found = force.predict(CONE, ROD, velocity="0.93 m/s ± 1 %", duration=4e-3, materials=MATERIALS)
    expect_files(found.tables, cone / "force-result")
    assert found.standard_error is not None
    import matplotlib

    matplotlib.use("Agg")
    assert found.plot().get_ylabel() == "force (N)"


def test_two_equal_elastic_rods_exchange_their_momentum() -> None:
    """Checks the impact of two equal rods: F = Z V / 2 for the time 2 L / c, so that the impulse is the momentum of the first rod."""
    alike = sheet.Chain(elements=[sheet.Rod(material="steel", diameter="10 mm", length="500 mm")])
    steel = {"steel": MATERIALS["steel"]}
    found = force.predict(alike, alike, velocity=2.0, duration=1e-3, materials=steel)
    mass = 7780 * np.pi * 0.005**2 * 0.5
    impulse = np.trapezoid(found.force, found.time)
    # tolerance: the limitation to 10 kHz, and the ringing of its filter beyond the ends of the history
    assert impulse == pytest.approx(mass * 2.0, rel=5e-3)
    assert found.standard_error is None


def test_a_body_that_is_none_is_refused_with_its_place() -> None:
    with pytest.raises(rodlab.SheetError, match="material") as caught:
        force.predict(CONE, sheet.LongRod(material="brass", diameter="10 mm"), velocity=1, duration=1e-3, materials=MATERIALS)
    assert caught.value.field is not None
    with pytest.raises(rodlab.SheetError, match="`-1.0 m/s`|is not above 0"):
        force.predict(CONE, ROD, velocity=-1, duration=1e-3, materials=MATERIALS)
