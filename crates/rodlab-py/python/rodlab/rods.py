"""Forward physics: waves in rods of known materials, and in bodies made of such rods (Ödeen 1993, papers A, B, E).

Bodies and materials are described as in a sheet: ``sheet.Chain(elements=[sheet.Rod(material="nylon", diameter="10 mm", length="1 m")])`` and
``{"nylon": {"density": "1150 kg/m3", "law": sheet.Elastic(modulus="3 GPa")}}``. Uncertainties are not propagated here; only
the values are used. The time factor is exp(+iωt).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _rodlab
from ._errors import SheetError
from ._sheet import Part, text_of

__all__ = ["Materials", "mobility", "propagation_coefficient", "transition_matrix"]

Materials = Mapping[str, Mapping[str, Any]]


def mobility(body: Part, frequency_hz: ArrayLike, *, materials: Materials | None = None) -> NDArray[np.complex128]:
    """Returns the mobility v/F of the impact face in s/kg; the termination of the body is included (Ödeen 1993, paper E, eq. A13).

    Parameters
    ----------
    body : Part
        ``sheet.Chain``, ``sheet.LongRod``, ``sheet.RigidMass`` or ``sheet.Impedance``.
    frequency_hz : array_like, shape (n,)
        Frequencies in Hz; above 0 Hz for a free body, whose mobility has a pole at 0 Hz.
    materials : mapping
        Materials by name.

    Returns
    -------
    array of complex, shape (n,)

    Raises
    ------
    SheetError
        The body, a material or the frequencies are wrong.
    """
    return _rodlab.mobility(_text(body, materials), _frequencies(frequency_hz))


def transition_matrix(body: Part, frequency_hz: ArrayLike, *, materials: Materials | None = None) -> NDArray[np.complex128]:
    """Returns the transition matrices of the state (N, v), the Fourier transforms of normal force (in N s) and velocity (in m), from the impact face
    to the other end of a chain (Ödeen 1993, paper E, eqs. A2-A4, A10).

    Parameters
    ----------
    body : Part
        ``sheet.Chain``; its termination is not part of the matrix.
    frequency_hz : array_like, shape (n,)

    Returns
    -------
    array of complex, shape (n, 2, 2)

    Raises
    ------
    SheetError
        The body, a material or the frequencies are wrong.
    Error
        An entry exceeds the range of floating-point numbers: the chain is too long for its damping.
    """
    return _rodlab.transition_matrix(_text(body, materials), _frequencies(frequency_hz))


def propagation_coefficient(material: Mapping[str, Any], frequency_hz: ArrayLike) -> NDArray[np.complex128]:
    """Returns the propagation coefficient α + ik of a material in 1/m: damping coefficient and wave number (Ödeen 1993, paper B, eq. 3).

    Parameters
    ----------
    material : mapping
        ``{"density": "7780 kg/m3", "law": sheet.Elastic(modulus="206 GPa")}``.
    frequency_hz : array_like, shape (n,)

    Returns
    -------
    array of complex, shape (n,)

    Raises
    ------
    SheetError
        The material or the frequencies are wrong.
    """
    text = _text(Part("RigidMass", ("1 kg",)), {"material": material})
    return _rodlab.propagation_coefficient(text, "material", _frequencies(frequency_hz))


def _text(body: Part, materials: Materials | None) -> str:
    """Returns a sheet with the body for the extension module, which ignores velocity and duration."""
    rest = (("second", Part("RigidMass", ("1 kg",))), ("velocity", "1 m/s"), ("duration", "1 s"))
    problem = Part("Impact", (), (("first", body), *rest))
    return text_of(Part("Force", (), (("title", ""), ("materials", materials or {}), ("problem", problem))))


def _frequencies(values: ArrayLike) -> NDArray[np.float64]:
    array = np.asarray(values)
    if array.dtype.kind not in "iuf" or array.ndim != 1 or array.size == 0:
        found = f"has the type {array.dtype} and the shape {array.shape}"
        raise SheetError(f"frequency_hz {found}, expected real numbers of the shape (n,)", field="frequency_hz")
    wrong = np.flatnonzero(~(np.isfinite(array) & (array >= 0)))
    if wrong.size:
        at = int(wrong[0])
        raise SheetError(f"frequency_hz[{at}] is {array[at]}, expected a finite number from 0 Hz", field="frequency_hz")
    return array.astype(np.float64, copy=False)
