"""Turns IMU recordings into attitude by one of our filters: `kreisel estimate`."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from kreisel.cli.batch import derived, expanded, over_files
from kreisel.cli.filters import add_filter_arguments, chosen_filter, tuning_help
from kreisel.cli.inputs import add_input_arguments, check_units, read_content, world
from kreisel.cli.outputs import check_format, summary_stream
from kreisel.cli.reports import add_report_arguments, described, print_json, tell_plan
from kreisel.cli.values import UsageError, one_of
from kreisel.data.attitude import AttitudeHistory
from kreisel.data.facts import clock_of
from kreisel.data.frames import from_enu_flu, to_enu_flu
from kreisel.data.increments import ImuIncrements
from kreisel.data.recording import ImuRecording
from kreisel.data.trial import Trial
from kreisel.files.doors import format_names, write

HELP = "attitude from IMU data, by one of the filters"

SCHEMA = "kreisel.estimate/1"

_EXAMPLES = """\
examples:
  kreisel estimate imu.csv -o attitude.tum
  kreisel estimate trial.mat -o attitude.npz --mode 6
  kreisel estimate flight.mcap --topic /imu/data_raw -o attitude.tum
  kreisel estimate imu.csv -o attitude.csv --filter mekf --smooth
  kreisel estimate log.csv --frame ned-frd --declination-deg 3.5 --set mag_time=30
  kreisel estimate trial.mat --set published.weight_accel=0.02 --set published.exact=true
  kreisel estimate 'recordings/*.csv' -o attitudes/ --to npz

Without -o the summary is all that is made. TUM files hold the attitude alone; csv, npz and mat also gyro bias,
acceleration and flags. What the filter assumes of the sensors is in its tuning: --set help lists it.
"""


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    add_input_arguments(parser, many=True)
    add_filter_arguments(parser)
    parser.add_argument(
        "--smooth", action="store_true", help="look at the whole recording, not only back (--filter mekf)"
    )
    parser.add_argument(
        "--trust-units", action="store_true", help="estimate even where the numbers look like g or deg/s"
    )
    parser.add_argument("-o", "--output", metavar="OUT", help="file, or for several inputs folder, to write")
    known = ", ".join(format_names(AttitudeHistory))
    parser.add_argument(
        "--to",
        metavar="FORMAT",
        type=one_of(lambda: format_names(AttitudeHistory)),
        help=f"{known} (default: by OUT's suffix, or tum in a folder)",
    )
    parser.add_argument(
        "--to-frame", metavar="WORLD", type=world, help="world of the output (default: that of the input)"
    )
    parser.add_argument(
        "--picture", metavar="PICTURE", help="draw the attitude: .png, .svg or .pdf; one input"
    )
    add_report_arguments(parser, dry_run=True)
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """Read, check, estimate, write, sum up."""
    if "help" in args.set:
        print(tuning_help(args.filter))
        return 0
    estimated, paths = _estimator(args), expanded(args.input)
    outputs = dict(zip(paths, _outputs(args, paths), strict=True))
    if args.dry_run:
        return _plan(args, outputs)

    def one(path: str) -> dict[str, Any]:
        content = read_content(args, path)
        recording = _recording(path, content, args)
        attitude = estimated(recording)
        output = outputs[path]
        if output is not None:
            if output != Path(args.output):
                output.parent.mkdir(parents=True, exist_ok=True)
            write(output, from_enu_flu(attitude, args.to_frame or args.frame), args.to)
        if args.picture is not None:
            _draw(attitude, args.picture)
        return _summary(path, output, recording, attitude, is_trial=isinstance(content, Trial))

    batch = over_files(paths, one, "smoothing" if args.smooth else "estimating")
    if args.json:
        print_json(
            {"schema": SCHEMA, "filter": _described(args), "files": batch.done, "failed": batch.failed}
        )
    elif batch.done:
        print("\n".join(_told(args, batch.done)), file=summary_stream(args.output or ""))
    return batch.code


def _plan(args: Namespace, outputs: Mapping[str, Path | None]) -> int:
    def checked(path: str) -> tuple[str, str]:
        return path, described(_recording(path, read_content(args, path), args))

    batch = over_files(list(outputs), checked, "reading")
    writes = [outputs[path] for path, _ in batch.done]
    tell_plan(args, dict(batch.done), [*filter(None, writes), *([args.picture] if args.picture else [])])
    return batch.code


def _estimator(args: Namespace) -> Callable[[ImuRecording], AttitudeHistory]:
    """What makes an attitude of a recording: the filter asked for, smoothed where that was asked for too."""
    from functools import partial

    from kreisel.estimate.filters import SmoothingFilter
    from kreisel.estimate.run import run
    from kreisel.estimate.smooth import smooth

    filter = chosen_filter(args)
    if args.smooth and not isinstance(filter, SmoothingFilter):
        raise UsageError(
            f"--smooth needs a filter that keeps a covariance: --filter mekf; got {args.filter}."
        )
    return partial(smooth if args.smooth else run, filter)


def _draw(attitude: AttitudeHistory, picture: str) -> None:
    from kreisel import show

    show.save(show.plot_attitude(attitude), picture)


def _outputs(args: Namespace, paths: Sequence[str]) -> list[Path | None]:
    """Where the attitude of each input goes: a file, or files named like the inputs in a folder."""
    if args.picture is not None and len(paths) > 1:
        raise UsageError(f"--picture is for one input; got {len(paths)}.")
    if args.output is None:
        return [None] * len(paths)
    outputs = derived(paths, args.output, f".{args.to or 'tum'}")
    check_format(str(outputs[0]), args.to)
    return list(outputs)


def _recording(path: str, content: Any, args: Namespace) -> ImuRecording:
    """The IMU's part in our axes; units that cannot be are refused unless they are trusted."""
    data = content.recording if isinstance(content, Trial) else content
    if not isinstance(data, ImuRecording):
        cure = " to take their mean rates" if isinstance(data, ImuIncrements) else " if it has both"
        raise ValueError(f"{path} holds {type(data).__name__}, not an IMU recording. Say --kind imu{cure}.")
    recording = to_enu_flu(data, args.frame)
    check_units(recording, path, args.trust_units)
    return recording


def _summary(
    path: str, output: Path | None, recording: ImuRecording, attitude: AttitudeHistory, is_trial: bool
) -> dict[str, Any]:
    clock = clock_of(attitude.t, attitude.t0_ns)
    shares = {name: getattr(attitude, name) for name in ("rest", "disturbed", "held")}
    bias = attitude.gyro_bias
    return {
        "file": path,
        "output": None if output is None else str(output),
        "samples": clock.rows,
        "span_s": clock.span,
        "rate_hz": clock.rate_hz if clock.rows > 1 else None,
        "magnetometer": recording.mag_uT is not None,
        **{f"{name}_share": None if flag is None else float(np.mean(flag)) for name, flag in shares.items()},
        "gyro_bias_deg_s": None if bias is None else np.degrees(bias[-1]).tolist(),
        "has_reference": is_trial,
    }


def _described(args: Namespace) -> dict[str, Any]:
    return {
        "name": args.filter,
        "mode": args.mode,
        "smooth": args.smooth,
        "set": args.set,
        "declination_deg": args.declination_deg or 0.0,
    }


def _told(args: Namespace, files: Sequence[dict[str, Any]]) -> list[str]:
    """The summary, with what to do next."""
    from kreisel.cli.tables import plain

    north = "true" if args.declination_deg is not None else "magnetic"
    tuning = "".join(f", {pair}" for pair in args.set)
    header = [
        "recording",
        "samples",
        "span, s",
        "rate, Hz",
        "at rest",
        "disturbed",
        "held",
        "gyro bias, deg/s",
    ]
    smooth = ", smoothed" if args.smooth else ""
    lines = [f"{args.filter}, mode {args.mode or 'auto'}{smooth}{tuning}; north is {north} north", ""]
    lines += [*plain(header, [_row(file) for file in files]), ""]
    if args.output is None:
        lines.append("nothing written: -o attitude.tum keeps the attitude")
    else:
        lines.append(
            f"written: {f'{len(files)} files in {args.output}' if len(files) > 1 else files[0]['output']}"
        )
    return [*lines, "next: " + _next(files[0])]


def _row(file: dict[str, Any]) -> list[str]:
    shares = [file[f"{name}_share"] for name in ("rest", "disturbed", "held")]
    if not file["magnetometer"]:
        shares[1] = None
    bias = file["gyro_bias_deg_s"]
    return [
        file["file"],
        str(file["samples"]),
        f"{file['span_s']:.4g}",
        "-" if file["rate_hz"] is None else f"{file['rate_hz']:.4g}",
        *("-" if share is None else f"{100.0 * share:.3g} %" for share in shares),
        "-" if bias is None else " ".join(f"{x:+.3f}" for x in bias),
    ]


def _next(file: dict[str, Any]) -> str:
    truth = file["file"] if file["has_reference"] else "TRUTH"
    return f"kreisel evaluate {truth} {file['output'] or 'attitude.tum'} -o report/"
