"""Campaigns of many sheets, in this process or on a Dask cluster."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, cast

from . import _rodlab
from ._errors import Error
from ._jobs import Progress

if TYPE_CHECKING:
    from distributed import Client

T = TypeVar("T")


@dataclass(frozen=True)
class Campaign:
    """Result of a campaign, the run of many sheets.

    Attributes
    ----------
    folder : Path
        Folder that contains a folder for each test, and ``summary.csv``, ``quantities.csv``, ``summary.json``, ``index.html``.
    tests : tuple of dict
        One entry per test, in the order of the names, with ``test``, ``job``, ``title``, ``status``, ``warnings``, ``headline``, ``quantities``.
    """

    folder: Path
    tests: tuple[dict[str, Any], ...]

    def count(self, standing: str) -> int:
        """Returns the number of tests with this standing: ``answered``, ``in doubt``, ``not allowed``, ``wrong input``."""
        return sum(test["status"] == standing for test in self.tests)


def campaign(
    sheets: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    out: str | os.PathLike[str],
    client: Client | None = None,
    *,
    resume: bool = False,
    jobs: int | None = None,
    retries: int = 2,
    progress: Progress | None = None,
) -> Campaign:
    """Runs many sheets in parallel and writes one summary. The files are those of ``rodlab batch``, byte for byte.

    Parameters
    ----------
    sheets : path, pattern, or list of them
        Sheets, folders of sheets, or patterns such as ``"campaign/*.ron"``.
    out : path
        Folder that receives a folder for each test, and the summary. Workers on other machines must see sheets, records and this folder
        under the same paths.
    client : distributed.Client, optional
        Cluster that runs the tests, one task per sheet; the key of a task is the hash of its sheet. A test whose worker dies is repeated.
        Without a client, the tests run in this process.
    resume : bool
        True to leave out the tests that already have a complete result from the same sheet, files and software.
    jobs : int, optional
        Number of tests at a time in this process; by default the number of processors.
    retries : int
        Number of times that a task is repeated after an exception, for example because a folder cannot be written.
    progress : callable, optional
        ``progress(step, done, of)``.

    Raises
    ------
    ReadError
        A path or pattern matches no sheet. A wrong sheet raises no exception: its test has the standing ``wrong input``.
    WriteError
        The summary cannot be written.
    KeyboardInterrupt
        Finished tests are kept, and ``resume=True`` continues with the others.
    """
    places = [sheets] if isinstance(sheets, (str, os.PathLike)) else list(sheets)
    names = [os.fspath(place) for place in places]
    if not names:
        raise Error("sheets is empty, expected a sheet, a folder or a pattern")
    if client is not None:
        _on_cluster(client, names, Path(out), resume, retries, progress)
        # with `resume`, the results of the workers are checked against their sheets and files, and give the same rows as a campaign in one process
        resume, progress = True, None
    told = json.loads(_rodlab.batch(names, out, resume=resume, jobs=jobs, progress=progress))
    return Campaign(Path(out), tuple(told["tests"]))


def map(function: Callable[[int], T], seeds: Iterable[int], client: Client | None = None) -> list[T]:
    """Returns ``[function(seed) for seed in seeds]``, computed on the workers of `client` if there is one.

    Each call gets only its own seed; the results are therefore the same on any number of workers. With a client, the function and its
    results must be picklable; a call whose worker dies is repeated.
    """
    numbers = list(seeds)
    if client is None:
        return [function(seed) for seed in numbers]
    futures = client.map(function, numbers, pure=False)
    try:
        return cast(list[T], client.gather(futures))
    finally:
        client.cancel(futures)


def _on_cluster(
    client: Client, places: list[str], out: Path, resume: bool, retries: int, progress: Progress | None
) -> None:
    """Runs every test on the workers of `client`."""
    from hashlib import sha256

    from distributed import as_completed

    folder = str(out.resolve())
    tests = [(name, sheet.resolve()) for name, sheet in _rodlab.tests_of(places)]
    if not tests:
        return
    keys = [
        f"rodlab-{sha256(path.read_bytes()).hexdigest()}-{sha256(f'{folder}/{name}'.encode()).hexdigest()[:16]}"
        for name, path in tests
    ]
    names, paths = zip(*((name, str(path)) for name, path in tests), strict=True)
    count = len(tests)
    waiting = set(client.map(_one, names, paths, [folder] * count, [resume] * count, key=keys, retries=retries, pure=False))
    done = 0
    try:
        for batch in as_completed(list(waiting), with_results=True).batches():
            # a finished result is in its folder and is not lost if the worker dies later
            for future, _ in batch:
                waiting.discard(future)
                future.release()
                done += 1
                if progress is not None:
                    progress("tests", done, count)
    except BaseException:
        client.cancel(list(waiting))
        raise


def _one(name: str, sheet: str, out: str, resume: bool) -> str:
    """Runs one test, as a task of the cluster."""
    return _rodlab.one_test(name, sheet, out, resume)
