"""Turns a command line into a call of one command, and its mistakes into one readable line.

Exit codes: 0 done, 1 bad data, 2 usage, 3 a requested limit was missed, 130 interrupted.
"""

from __future__ import annotations

import argparse
import os
import re
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, NoReturn

from kreisel import __version__, discovery
from kreisel.cli.notes import complain, quiet, sentence, warnings_as_notes
from kreisel.cli.values import UsageError

COMMANDS = "kreisel.cli.commands"

_EPILOG = """\
try it:
  kreisel demo                            the whole loop on a built-in path
  kreisel info poses.csv                  what is in a file
  kreisel simulate poses.csv -o out/      IMU data of your own path
  kreisel run scenario.toml -o out/       a whole study from one file
  kreisel estimate imu.csv -o att.tum     attitude from IMU data
  kreisel evaluate truth.csv att.tum      errors of that attitude
"""


class _Parser(argparse.ArgumentParser):
    """argparse with one-line errors that suggest the nearest option or command."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        # "-0.1,0,0" is a lever arm, not an option.
        self._negative_number_matcher = re.compile(r"^-[.\d].*$")

        self._typed: list[str] = []

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """As argparse does it, with the arguments kept for `error` to look at."""
        self._typed = list(sys.argv[1:] if args is None else args)
        return super().parse_known_args(args, namespace)

    def error(self, message: str) -> NoReturn:
        """Say in one line what is wrong, or what was meant."""
        refused = sys.exception()
        if refused is not None and isinstance(refused.__context__, UsageError):
            raise UsageError(_about(refused, refused.__context__)) from None
        import difflib

        words = self._words()
        typed = [a for a in self._typed if a not in words]
        # A path that happens to resemble an option is no typing mistake: only bare words are compared.
        near = [
            f"{a!r} - did you mean {m[0]!r}?"
            for a in typed
            if "unrecognized" in message or "invalid choice" in message
            if (m := difflib.get_close_matches(a.split("=")[0], words, n=1, cutoff=0.7))
        ]
        sys.stderr.write(f"{self.prog}: {near[0] if near else message}\nSee: {self.prog} --help\n")
        raise SystemExit(2)

    def _words(self) -> list[str]:
        """Options and commands, those of the commands too: argparse lets this parser speak for them."""
        words = [option for action in self._actions for option in action.option_strings]
        for action in self._actions:
            if isinstance(action, argparse._SubParsersAction):
                words += [*action.choices, *(w for sub in action.choices.values() for w in sub._words())]
        return words


def _about(refused: BaseException, error: UsageError) -> str:
    """The sentence about a value that an option refused, beginning with the option."""
    name = (getattr(refused, "argument_name", None) or "").rpartition("/")[2]
    text = str(error).strip()
    if text.startswith("-"):
        return text
    return f"{name} {text}" if text.startswith(("must ", "takes ")) else f"{name}: {text}"


def build_parser(command: str | None = None) -> argparse.ArgumentParser:
    """The command line, ready to run `command`: no other is imported, the help needs none."""
    parser = _Parser(
        prog="kreisel",
        description="From a trajectory to inertial sensor data, and back to attitude.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"kreisel {__version__}")
    subparsers = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name in discovery.names(COMMANDS):
        line = discovery.constant(COMMANDS, name, "HELP")
        sub = subparsers.add_parser(
            name,
            help=line,
            description=line[:1].upper() + line[1:] + ".",
            formatter_class=argparse.RawDescriptionHelpFormatter,
            allow_abbrev=False,
        )
        if name == command:
            configure(sub, command)
    return parser


def configure(parser: argparse.ArgumentParser, command: str) -> None:
    """Add the arguments of `command`, those that all have included."""
    module = discovery.load(COMMANDS, command)
    module.configure(parser)
    parser.add_argument("--quiet", action="store_true", help="say nothing but errors, and what --json prints")
    parser.set_defaults(run=module.run)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    if not arguments:
        build_parser().print_help()
        return 2
    command = next((word for word in arguments if not word.startswith("-")), None)
    try:
        # Around the parser too: it imports the command, and with it most of the package.
        with _notes_in_one_line():
            args = build_parser(command).parse_args(arguments)
            code = _run(args)
        sys.stdout.flush()
        return code
    except KeyboardInterrupt:
        return _complain("interrupted; nothing half-written was left behind", 130)
    except BrokenPipeError:
        # The reader (such as `head`) has gone; what is still in the buffer must not raise at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except UsageError as error:
        return _complain(str(error), 2)
    except (ValueError, TypeError, OSError) as error:
        return _complain(sentence(error), 1)


def _run(args: argparse.Namespace) -> int:
    if not args.quiet:
        return int(args.run(args))
    with quiet(data_on_stdout=getattr(args, "json", False) or getattr(args, "data_on_stdout", False)):
        return int(args.run(args))


@contextmanager
def _notes_in_one_line() -> Iterator[None]:
    """Inside, a warning of ours is one line on stderr; those of others keep the form they have in Python."""
    with warnings.catch_warnings():
        warnings.showwarning = warnings_as_notes(warnings.showwarning)
        yield


def _complain(text: str, code: int) -> int:
    complain(text)
    return code


if __name__ == "__main__":
    raise SystemExit(main())
