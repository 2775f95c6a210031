"""Extension module on which the package is built; it is not a public interface."""

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeAlias, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Hit",
    "Outcome",
    "batch",
    "check",
    "command",
    "convert",
    "frequency_response",
    "init",
    "inspect",
    "load",
    "mobility",
    "one_test",
    "propagation_coefficient",
    "run_sheet",
    "run_text",
    "tests_of",
    "transition_matrix",
]

_Path: TypeAlias = str | os.PathLike[str]
_Progress: TypeAlias = Callable[[str, int, int], object]
_Column: TypeAlias = tuple[str, str, str, NDArray[np.float64] | NDArray[np.bool_] | list[str]]

@final
class Outcome:
    @property
    def json(self) -> str: ...
    @property
    def sheet(self) -> tuple[str, str]: ...
    @property
    def files(self) -> list[Path]: ...
    def tables(self) -> list[tuple[str, str, list[_Column]]]: ...
    def attachments(self) -> list[tuple[str, bytes]]: ...
    def report(self) -> str: ...

@final
class Hit:
    @property
    def name(self) -> str: ...
    @property
    def accepted(self) -> bool: ...
    @property
    def reasons(self) -> list[str]: ...
    @property
    def samples(self) -> NDArray[np.float64]: ...
    @property
    def sampling_rate_hz(self) -> float: ...
    @property
    def start_time(self) -> float: ...

def run_sheet(
    path: _Path,
    *,
    job: str | None = None,
    out: _Path | None = None,
    write: bool = True,
    progress: _Progress | None = None,
) -> Outcome: ...
def run_text(
    text: str, folder: _Path, *, out: _Path | None = None, progress: _Progress | None = None
) -> Outcome: ...
def check(path: _Path) -> tuple[str, str]: ...
def inspect(path: _Path) -> str: ...
def convert(
    input: _Path,
    output: _Path,
    *,
    tolerant: bool = False,
    lossless: bool = False,
    binary: bool = False,
    force: bool = False,
    sampling_rate: str | None = None,
) -> str: ...
def init(job: str, path: _Path, rig: str | None = None) -> None: ...
def command(words: Sequence[str]) -> int: ...
def tests_of(places: Sequence[str]) -> list[tuple[str, Path]]: ...
def batch(
    places: Sequence[str],
    out: _Path,
    *,
    resume: bool = False,
    jobs: int | None = None,
    progress: _Progress | None = None,
) -> str: ...
def one_test(name: str, sheet: _Path, out: _Path, resume: bool) -> str: ...
def load(text: str, folder: _Path) -> tuple[list[Hit], list[tuple[str, str]], list[str]]: ...
def frequency_response(
    input: NDArray[np.float64],
    output: NDArray[np.float64],
    sampling_rate_hz: float,
    *,
    estimator: str,
    window: str,
) -> tuple[
    NDArray[np.float64],
    NDArray[np.complex128],
    NDArray[np.float64] | None,
    NDArray[np.float64] | None,
    NDArray[np.float64] | None,
    NDArray[np.float64] | None,
    list[bool],
]: ...
def mobility(text: str, frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]: ...
def transition_matrix(text: str, frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]: ...
def propagation_coefficient(text: str, name: str, frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]: ...
