"""Turns a file name into a noun and a noun into a file: the public `read` and `write`.

The format is the one named, else one without a suffix of its own whose content fits, else the only one whose
content fits, else the one whose suffix it is.
"""

from __future__ import annotations

import difflib
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import ModuleType

from kreisel import discovery
from kreisel.atomic import new_folder, replacing
from kreisel.data.attitude import AttitudeHistory, Reference
from kreisel.data.checks import choice
from kreisel.data.increments import ImuIncrements
from kreisel.data.motion import Motion
from kreisel.data.recording import ImuRecording
from kreisel.data.trajectory import Poses
from kreisel.data.trial import Trial
from kreisel.files.formats import Content, Noun, ReadOptions, Topic

FOLDER = "kreisel.files.formats"
HEAD = 65536  # bytes; comments may be long
_FOLDERS_HEAD = "metadata.yaml"  # of a folder that is read like a file: a bag of ROS 2
KINDS = {
    "poses": "poses",
    "motion": "a complete motion",
    "imu": "an IMU recording",
    "increments": "IMU increments",
    "attitude": "attitude over time",
    "reference": "a reference attitude",
    "trial": "a trial (an IMU recording and a reference)",
}

_KIND_OF = {
    Poses: "poses",
    Motion: "motion",
    ImuRecording: "imu",
    ImuIncrements: "increments",
    AttitudeHistory: "attitude",
    Reference: "reference",
    Trial: "trial",
}

PathLike = str | os.PathLike[str]


def format_names(holding: type[Noun] | None = None) -> list[str]:
    """The formats by the names users type; with `holding`, those that can be written with such data in them."""
    names = [name.replace("_", "-") for name in discovery.names(FOLDER)]
    return names if holding is None else [name for name in names if holding in format_named(name).HOLDS]


def writable_names() -> list[str]:
    """The formats that can be written, by the names users type."""
    return [name for name in format_names() if format_named(name).HOLDS]


def format_named(name: str) -> ModuleType:
    """The format `name`; ValueError with the nearest name where there is none."""
    return discovery.load(FOLDER, choice("format", name, format_names()).replace("-", "_"))


def suffix(name: str) -> str:
    """What files of the format `name` end in; its own suffix where it has one, nothing for a folder."""
    module = format_named(name)
    return module.SUFFIX or ("" if _is_folder(module) else ".txt")


def read(
    path: PathLike,
    format: str | None = None,
    *,
    kind: str | None = None,
    columns: Mapping[str, str] | None = None,
    rate_hz: float | None = None,
    times: PathLike | None = None,
    topic: str | Sequence[str] = (),
) -> Content:
    """What a file holds: Poses, Motion, ImuRecording, ImuIncrements, AttitudeHistory, Reference or Trial.

    SI units, in the axes of the file.

    path : the file, or the folder of a ROS 2 bag. Other worlds than ENU/FLU are turned with `to_enu_flu` afterwards.
    format : one of `format_names()`, such as "csv"; None to tell by suffix and content.
    kind : "poses", "motion", "imu", "increments", "attitude", "reference" or "trial" to insist on one. A motion is
        taken as poses, a motion or poses as attitude, increments as the mean rates of an IMU, and of a trial the
        recording, the reference or the poses.
    columns : for csv, our name -> the file's header, its unit in brackets where the header has none:
        ``{"t": "Time [ms]", "p_x": "X [mm]"}``; "#3" is the third column.
    rate_hz, times : for files without time, the rate in Hz or a file with one stamp in seconds per row.
    topic : for ROS bags, the topic to take, such as "/imu/data", or "/tf:odom.base_link"; two of them where an IMU's
        magnetometer has to be named as well.
    Raises ValueError with file, line and column where the content is not sound, OSError where there is none.
    """
    source = Path(path)
    if kind is not None:
        choice("kind", kind, list(KINDS))
    if columns is not None:
        format = format or "csv"
    module = _format_of(source, format)
    topics = (topic,) if isinstance(topic, str) else tuple(topic)
    options = ReadOptions(columns, _rate(rate_hz), None if times is None else Path(times), kind, topics)
    _check_options(module, options)
    return _as_kind(module.read(source, options), kind, source)


def listing(path: PathLike, format: str | None = None) -> list[Topic] | None:
    """The topics of a file that holds several recordings, such as a ROS bag; None for a file of any other format."""
    module = _format_of(Path(path), format)
    topics: list[Topic] | None = module.listing(Path(path)) if "topics" in module.OPTIONS else None
    return topics


def write(path: PathLike, data: Noun, format: str | None = None) -> None:
    """Write `data` in the named format, or the one `path` ends in: the whole file or nothing.

    Raises ValueError where the format cannot hold the data, OSError where the place cannot be written.
    """
    if not isinstance(data, Noun):
        nouns = "Poses, Motion, ImuRecording, ImuIncrements, AttitudeHistory or Reference"
        raise TypeError(f"data must be {nouns}; got {type(data).__name__}.")
    module = format_to_write(path, format)
    if len(data) == 0:
        raise ValueError(f"nothing to write to {path}: the data has no rows.")
    with new_folder(path) if _is_folder(module) else replacing(path) as out:
        module.write(data, out)


def format_to_write(path: PathLike, format: str | None = None) -> ModuleType:
    """The format named, else that of the suffix of `path`; ValueError with the nearest name where there is none."""
    if not format:
        return _by_suffix(Path(path))
    # One that is only read has a word of its own to say.
    return format_named(format if format in format_names() else choice("format", format, writable_names()))


def _is_folder(module: ModuleType) -> bool:
    return getattr(module, "FOLDER", False)


def _format_of(path: Path, format: str | None) -> ModuleType:
    """The format named, or the one the content shows; the file must be there in any case."""
    head = _head(path)
    module = format_named(format) if format else detect(path, head)
    if path.is_dir() and not _is_folder(module):
        raise _no_file(path)
    return module


def detect(path: Path, head: bytes) -> ModuleType:
    """The format of a file by its content; by its suffix where the content fits none or several.

    A file of none is left to the reader of its suffix, which says what is wrong with it.
    """
    formats = {name: format_named(name) for name in format_names()}
    owner = next((m for m in formats.values() if path.suffix.lower() == m.SUFFIX), None)
    fitting = [name for name, module in formats.items() if module.sniff(head)]
    # Without a suffix of its own a format looks closer: a benchmark's trial is a MAT file as well.
    closer = [name for name in fitting if formats[name].SUFFIX is None]
    if len(closer) == 1 or len(fitting) == 1:
        return formats[(closer or fitting)[0]]
    if owner is not None:
        return owner
    found = f"it could be {' or '.join(fitting)}" if fitting else "its content fits none"
    raise ValueError(
        f"cannot tell the format of {path}: {found}. Name it (format=..., --from ...): {', '.join(formats)}."
    )


def format_name(module: ModuleType) -> str:
    """The name users type for a format module."""
    return module.__name__.rpartition(".")[2].replace("_", "-")


def _by_suffix(path: Path) -> ModuleType:
    owners = {m.SUFFIX: m for m in map(format_named, format_names()) if m.SUFFIX}
    if path.suffix.lower() in owners:
        return owners[path.suffix.lower()]
    near = difflib.get_close_matches(path.suffix.lower(), list(owners), n=1)
    hint = f" Did you mean {near[0]!r}?" if near else ""
    raise ValueError(
        f"cannot tell the format of {path} from its suffix.{hint} Use one of {', '.join(sorted(owners))}, "
        f"or name it (format=..., --to ...): {', '.join(writable_names())}."
    )


def _no_file(path: Path) -> IsADirectoryError:
    return IsADirectoryError(f"cannot read {path}: it is a folder. Give one of its files.")


def _head(path: Path) -> bytes:
    place = path / _FOLDERS_HEAD if (path / _FOLDERS_HEAD).is_file() else path
    try:
        with place.open("rb") as stream:
            return stream.read(HEAD)
    except FileNotFoundError:
        near = difflib.get_close_matches(path.name, _neighbours(path), n=1)
        hint = f" Did you mean {near[0]!r}?" if near else ""
        raise FileNotFoundError(f"cannot read {path}: there is no such file.{hint}") from None
    except IsADirectoryError:
        raise _no_file(path) from None
    except OSError as error:
        raise type(error)(f"cannot read {path}: {error.strerror}.") from None


def _neighbours(path: Path) -> list[str]:
    try:
        return [p.name for p in path.parent.iterdir()]
    except OSError:
        return []


def _rate(rate_hz: float | None) -> float | None:
    if rate_hz is not None and not 0.0 < rate_hz < float("inf"):
        raise ValueError(f"rate_hz must be positive; got {rate_hz}.")
    return rate_hz


def _check_options(module: ModuleType, options: ReadOptions) -> None:
    for name in ("columns", "rate_hz", "times", "topics"):
        if getattr(options, name) not in (None, ()) and name not in module.OPTIONS:
            asked = name.rstrip("s") if name == "topics" else name
            raise ValueError(f"{asked} does not apply to the format {format_name(module)!r}. Leave it out.")


def _as_kind(data: Content, kind: str | None, path: Path) -> Content:
    have = _KIND_OF[type(data)]
    if kind is None or have == kind:
        return data
    if isinstance(data, Motion | Poses) and data.R_NB is not None and kind == "attitude":
        return AttitudeHistory(data.t, data.R_NB, t0_ns=data.t0_ns, name=data.name)
    if isinstance(data, Motion) and kind == "poses":
        return Poses(data.t, data.p_NB, data.R_NB, data.v_NB, data.t0_ns, data.name)
    if isinstance(data, ImuIncrements) and kind == "imu":
        return data.mean_rates()
    if isinstance(data, Trial) and kind == "imu":
        return data.recording
    if isinstance(data, Trial) and kind == "reference":
        return data.reference
    if isinstance(data, Trial) and kind == "poses" and data.poses is not None:
        return data.poses
    raise ValueError(f"{path} holds {KINDS[have]}, not {KINDS[kind]}.")
