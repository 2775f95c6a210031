"""Frequency responses, with coherence and errors.

:func:`h1`, :func:`h2` and :func:`hv` compute them from arrays, :func:`of_hits` from hits in files, as ``rodlab frf`` does.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _rodlab
from ._errors import Error, SheetError
from ._jobs import Progress, run_part
from ._records import Hits
from ._result import Result
from ._sheet import Part, number

if TYPE_CHECKING:
    import matplotlib.axes
    import pandas

__all__ = ["FrequencyResponse", "h1", "h2", "hv", "of_hits"]


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """Frequency response. All arrays have the shape (n_lines,), start at 0 Hz and are read-only.

    Attributes
    ----------
    estimator : str
        ``H1``, ``H2`` or ``Hv``.
    frequency_hz : array of float
    values : array of complex
        Unit of the output divided by unit of the input, time factor exp(+iωt); NaN on lines that are not valid.
    coherence : array of float, or None for one hit
    variance : array of float, or None for one hit
        E|δH|², which is twice the variance of the real part or of the imaginary part.
    magnitude_error, phase_error : array of float, or None for one hit
        Standard errors of \\|H\\| relative to \\|H\\|, and of the phase in rad (Bendat and Piersol, *Random Data*).
    valid : array of bool
        True for a line at which the response is determined.
    n_averages : int
    """

    estimator: str
    frequency_hz: NDArray[np.float64] = field(repr=False)
    values: NDArray[np.complex128] = field(repr=False)
    coherence: NDArray[np.float64] | None = field(repr=False)
    variance: NDArray[np.float64] | None = field(repr=False)
    magnitude_error: NDArray[np.float64] | None = field(repr=False)
    phase_error: NDArray[np.float64] | None = field(repr=False)
    valid: NDArray[np.bool_] = field(repr=False)
    n_averages: int

    def columns(self) -> dict[str, NDArray[Any]]:
        """Returns the arrays that are not None, by their names."""
        names = ("frequency_hz", "values", "coherence", "variance", "magnitude_error", "phase_error", "valid")
        return {name: getattr(self, name) for name in names if getattr(self, name) is not None}

    def to_pandas(self) -> pandas.DataFrame:
        """Returns a data frame with a row for each line; its `attrs` have `units` (by column) and `estimator`."""
        import pandas

        columns = self.columns()
        units = {name: {"frequency_hz": "Hz", "phase_error": "rad"}.get(name, "") for name in columns}
        frame = pandas.DataFrame(columns)
        frame.attrs.update(units=units, estimator=self.estimator)
        return frame

    def plot(self, ax: Sequence[matplotlib.axes.Axes] | None = None) -> Sequence[matplotlib.axes.Axes]:
        """Draws magnitude, phase and coherence against frequency on three axes, without invalid lines; returns the axes."""
        from ._plot import frequency_response

        return frequency_response(self, ax)


def h1(input: ArrayLike, output: ArrayLike, *, sampling_rate_hz: float, window: str = "rectangular") -> FrequencyResponse:
    """Returns the frequency response H1 = G_xy/G_xx, for noise on the output.

    Parameters
    ----------
    input, output : array_like, shape (n_hits, n_samples) or (n_samples,)
        Histories of x and y, real numbers of any type.
    sampling_rate_hz : float
        Sampling rate in Hz.
    window : str
        ``rectangular`` (for hits that decay within the record), ``hann``, ``hamming``, ``blackman-harris`` or ``flat top``.

    Returns
    -------
    FrequencyResponse
        Response on n_samples // 2 + 1 lines. A single hit gives neither coherence nor errors.

    Raises
    ------
    Error
        Arrays are empty, differ in shape, are not real, or contain NaN or infinite numbers.
    """
    return _estimate("H1", input, output, sampling_rate_hz, window)


def h2(input: ArrayLike, output: ArrayLike, *, sampling_rate_hz: float, window: str = "rectangular") -> FrequencyResponse:
    """Returns the frequency response H2 = G_yy/G_yx, for noise on the input; parameters as for :func:`h1`."""
    return _estimate("H2", input, output, sampling_rate_hz, window)


def hv(input: ArrayLike, output: ArrayLike, *, sampling_rate_hz: float, window: str = "rectangular") -> FrequencyResponse:
    """Returns the frequency response Hv = sqrt(H1 H2), for the same relative noise on both channels; parameters as for :func:`h1`."""
    return _estimate("Hv", input, output, sampling_rate_hz, window)


def of_hits(
    hits: Hits,
    *,
    input: str | None = None,
    outputs: Sequence[str] | None = None,
    estimator: str | None = None,
    window: Part | None = None,
    band: tuple[str, str] | None = None,
    kind: str | None = None,
    silent: str | None = None,
    title: str = "Frequency responses",
    progress: Progress | None = None,
    **fields: Mapping[str, Any] | Part | str,
) -> Result:
    """Returns the frequency responses of accepted hits, as ``rodlab frf`` does.

    Parameters
    ----------
    hits : Hits
        Hits from :func:`rodlab.read`.
    input : str, optional
        Channel in the denominator; by default the first.
    outputs : list of str, optional
        Channels in the numerator; by default all others.
    estimator : str, optional
        ``H1`` (default), ``H2``, ``Hv`` or ``Hs``.
    window : Part, optional
        Window such as ``sheet.Hann()``; by default rectangular.
    band : pair of str, optional
        Lowest and highest frequency, such as ``("20 Hz", "10 kHz")``.
    kind : str, optional
        ``Receptance``, ``Mobility``, ``Accelerance``, ``DynamicStiffness``, ``Impedance`` or ``DynamicMass``; by default as measured.
    silent : str, optional
        Time before a hit in which the channels are at rest.
    **fields
        Any other field of the sheet, such as ``exponential_window=sheet.EndWeight(weight="1 %")``.

    Raises
    ------
    SheetError, ReadError
        An argument or a file is wrong.
    NotAllowed
        The hits do not allow a response.
    """
    stated: dict[str, Any] = {
        "title": title,
        "records": hits._records,
        "hits": hits._hits,
        "input": hits.channels[0] if input is None else input,
        "outputs": outputs,
        "estimator": None if estimator is None else Part(estimator),
        "window": window,
        "band": None if band is None else {"from": band[0], "to": band[1]},
        "kind": None if kind is None else Part(kind),
        "silent": silent,
    }
    sheet = Part("Frf", (), tuple((stated | fields).items()))
    return run_part(sheet, hits._folder, of=Result, progress=progress).require()


def _estimate(estimator: str, input: ArrayLike, output: ArrayLike, sampling_rate_hz: float, window: str) -> FrequencyResponse:
    x, y = _histories(input, "input"), _histories(output, "output")
    rate = number(sampling_rate_hz, "Hz", "sampling_rate_hz")
    found = _rodlab.frequency_response(x, y, rate, estimator=estimator, window=window)
    frequency, values, coherence, variance, magnitude, phase, valid = found
    lines = np.array(valid, dtype=np.bool_)
    for array in (frequency, values, coherence, variance, magnitude, phase, lines):
        if array is not None:
            array.flags.writeable = False
    return FrequencyResponse(estimator, frequency, values, coherence, variance, magnitude, phase, lines, len(x))


def _histories(values: ArrayLike, name: str) -> NDArray[np.float64]:
    array = np.asarray(values)
    if array.dtype.kind not in "biuf":
        raise Error(f"{name} has the type {array.dtype}, expected real numbers")
    if array.ndim not in (1, 2) or array.size == 0:
        raise SheetError(f"{name} has the shape {array.shape}, expected (n_hits, n_samples) or (n_samples,)", field=name)
    return np.atleast_2d(array).astype(np.float64, copy=False)
