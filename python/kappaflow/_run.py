"""Runs that `kappaflow run` and `kappaflow track` have written."""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Callable, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, Generic, TypeVar, overload
from xml.etree import ElementTree

import numpy as np

from kappaflow._meshes import Mesh, Particles
from kappaflow._vtp import read_pieces, read_vtp
from kappaflow.errors import InvalidInput, IoError

Item = TypeVar("Item")


class Frames(Sequence[Item], Generic[Item]):
    """The frames of a series, each read from its file when it is asked for, and not kept."""

    def __init__(self, files: list[Path], read: Callable[[Path], Item]) -> None:
        self._files = files
        self._read = read

    def __len__(self) -> int:
        """How many there are."""
        return len(self._files)

    @overload
    def __getitem__(self, frame: int) -> Item: ...
    @overload
    def __getitem__(self, frame: slice) -> Frames[Item]: ...
    def __getitem__(self, frame: int | slice) -> Item | Frames[Item]:
        """The frame of that number, or a part of the series. Raises IoError where its file cannot be read."""
        if isinstance(frame, slice):
            return Frames(self._files[frame], self._read)
        return self._read(self._files[frame])


class Run:
    """A run folder (docs/outputs.md), also while the run goes on: what was complete when read_run() looked."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder)
        """Where it lies."""
        self.record = _record(self.folder)
        """What run.json holds: scene, options, threads, sigma [m], threshold and more."""
        series = _series(self.folder / "particles.pvd")
        self.times: np.ndarray[Any, np.dtype[np.float64]] = np.array([time for time, _ in series])
        """Of the frames [s]."""
        self.particles: Frames[Particles] = Frames([file for _, file in series], _read_particles)
        """Of each frame."""

    def __len__(self) -> int:
        """How many frames there are."""
        return len(self.times)

    @property
    def methods(self) -> list[str]:
        """The velocity methods, each of which has a surface."""
        return list(self.record["methods"])

    def meshes(self, method: str | None = None) -> Frames[Mesh]:
        """The surface of a velocity method, the first one's unless given, in each frame. Raises InvalidInput where there is
        none."""
        method = self.methods[0] if method is None else method
        if method not in self.methods:
            raise InvalidInput(f'{self.folder} has no surface tracked with "{method}"')
        files = [file for _, file in _series(self.folder / f"surface-{method}.pvd")]
        return Frames(files[:len(self)], _read_mesh)

    @property
    def walls(self) -> Frames[Mesh] | None:
        """The walls and rigid bodies in each frame; `mesh.arrays` is empty. None where there are none."""
        moving, still = self.folder / "boundary.pvd", self.folder / "boundary.vtp"
        if moving.exists():
            return Frames([file for _, file in _series(moving)][:len(self)], _read_mesh)
        return Frames([still] * len(self), _read_mesh) if still.exists() else None

    @cached_property
    def metrics(self) -> Any:
        """metrics.csv, a row a frame and method: a pandas.DataFrame where pandas is installed, else a dict of numpy arrays by
        column. Numbers that there are not are nan."""
        return _table(self.folder / "metrics.csv")

    @cached_property
    def pieces(self) -> Any:
        """pieces.csv likewise, a row a frame, method and connected piece."""
        return _table(self.folder / "pieces.csv")

    @cached_property
    def timings(self) -> Any:
        """timings.csv likewise."""
        return _table(self.folder / "timings.csv")


def read_run(folder: str | os.PathLike[str]) -> Run:
    """A run folder of `kappaflow run` or `kappaflow track`; frames are read when they are asked for.

    Raises IoError where it is none."""
    return Run(folder)


def _text(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8")
    except OSError as error:
        raise IoError(f"{file}: {error.strerror}") from None


def _record(folder: Path) -> dict[str, Any]:
    file = folder / "run.json"
    try:
        record = json.loads(_text(file))
        if not isinstance(record["methods"], list):
            raise TypeError
    except (ValueError, KeyError, TypeError):
        raise IoError(f"{file}: is not the record of a run") from None
    return record  # type: ignore[no-any-return]


def _series(file: Path) -> list[tuple[float, Path]]:
    """Times and files of a .pvd file, which lists complete frames only; none where it is not there yet."""
    if not file.exists():
        return []
    try:
        entries = ElementTree.fromstring(_text(file)).iter("DataSet")
        return [(float(entry.attrib["timestep"]), file.parent / entry.attrib["file"]) for entry in entries]
    except (ElementTree.ParseError, KeyError, ValueError):
        raise IoError(f"{file}: is damaged") from None


def _read_particles(file: Path) -> Particles:
    data = read_pieces(file)
    return Particles(float(data.fields["TimeValue"][0]), data.positions, data.arrays)


def _read_mesh(file: Path) -> Mesh:
    data = read_vtp(file)
    time = float(data.fields["TimeValue"][0]) if "TimeValue" in data.fields else 0.0
    return Mesh(time, data.positions, data.arrays, data.triangles)


def _table(file: Path) -> Any:
    try:
        import pandas  # type: ignore[import-untyped, unused-ignore]
    except ImportError:
        rows = list(csv.reader(_text(file).splitlines()))
        return {name: _column([row[c] for row in rows[1:]]) for c, name in enumerate(rows[0])}
    if not file.exists():
        raise IoError(f"{file}: No such file or directory")
    return pandas.read_csv(file)


def _column(cells: list[str]) -> np.ndarray[Any, Any]:
    for kind in (np.int64, np.float64):
        try:
            return np.array([cell or "nan" for cell in cells]).astype(kind)
        except ValueError:
            pass
    return np.array(cells)
