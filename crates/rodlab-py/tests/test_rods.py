"""Forward physics, compared with closed forms."""

import numpy as np
import pytest
import rodlab
from rodlab import rods, sheet

STEEL = {"density": "7780 kg/m3", "law": sheet.Elastic(modulus="206 GPa")}
NYLON = {"density": "1150 kg/m3", "law": sheet.ConstantQ(modulus="2.6 GPa", loss_factor="0.094", at="3 kHz")}
FREQUENCY = np.array([100.0, 1234.5, 9000.0])
OMEGA = 2 * np.pi * FREQUENCY
AREA = np.pi * 0.005**2
ROD = sheet.Chain(elements=[sheet.Rod(material="steel", diameter="10 mm", length="0.7 m")])


def test_waves_of_an_elastic_material_run_at_the_speed_of_bars() -> None:
    expected = 1j * OMEGA / np.sqrt(206e9 / 7780)
    np.testing.assert_allclose(rods.propagation_coefficient(STEEL, FREQUENCY), expected, rtol=1e-14)


def test_a_constant_loss_factor_damps_in_closed_form() -> None:
    """Compares with gamma^2 = -rho omega^2 / E (Ödeen 1993, paper B), for E = |E| (i omega / omega_0)^(2 atan(loss factor) / pi)."""
    modulus = 2.6e9 * (1j * FREQUENCY / 3e3) ** (2 * np.arctan(0.094) / np.pi)
    expected = 1j * OMEGA * np.sqrt(1150 / modulus)
    np.testing.assert_allclose(rods.propagation_coefficient(NYLON, FREQUENCY), expected, rtol=1e-13)


def test_a_uniform_rod_has_the_printed_matrix_and_mobility() -> None:
    gamma_length = 0.7j * OMEGA / np.sqrt(206e9 / 7780)
    impedance = AREA * np.sqrt(206e9 * 7780)
    matrices = rods.transition_matrix(ROD, FREQUENCY, materials={"steel": STEEL})
    assert matrices.shape == (3, 2, 2)
    # tolerance: rounding of arguments of up to 8 rad
    np.testing.assert_allclose(matrices[:, 0, 0], np.cosh(gamma_length), rtol=1e-12)
    np.testing.assert_allclose(abs(matrices[:, 0, 1]), impedance * abs(np.sinh(gamma_length)), rtol=1e-12)
    np.testing.assert_allclose(np.linalg.det(matrices), 1, rtol=1e-12)
    # v/F = coth(gamma L)/Z for a free rod
    found = rods.mobility(ROD, FREQUENCY, materials={"steel": STEEL})
    np.testing.assert_allclose(found, 1 / (impedance * np.tanh(gamma_length)), rtol=1e-11)


def test_lumps_have_the_mobilities_of_mechanics() -> None:
    np.testing.assert_allclose(rods.mobility(sheet.RigidMass("2 kg"), FREQUENCY), 1 / (2j * OMEGA), rtol=1e-14)
    endless = rods.mobility(sheet.LongRod(material="steel", diameter="10 mm"), FREQUENCY, materials={"steel": STEEL})
    np.testing.assert_allclose(endless, 1 / (AREA * np.sqrt(206e9 * 7780)), rtol=1e-13)


def test_bodies_and_frequencies_that_are_none_are_refused() -> None:
    with pytest.raises(rodlab.Error, match="a lump, expected a `Chain`"):
        rods.transition_matrix(sheet.RigidMass("2 kg"), FREQUENCY)
    with pytest.raises(rodlab.SheetError, match="`steel`, expected a material"):
        rods.mobility(ROD, FREQUENCY)
    for bad in ([], [[1.0]], ["1 Hz"], [np.nan], [-1.0], [1j], None):
        with pytest.raises(rodlab.SheetError, match="frequency_hz"):
            rods.mobility(ROD, bad, materials={"steel": STEEL})  # type: ignore[arg-type]
    with pytest.raises(rodlab.Error, match="0"):
        rods.mobility(ROD, [0.0], materials={"steel": STEEL})
