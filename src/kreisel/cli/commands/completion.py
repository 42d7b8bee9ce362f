"""Turns the parser of every command into a script that completes them at the prompt: `kreisel completion`."""

from __future__ import annotations

import re
import shlex
from argparse import Action, ArgumentParser, Namespace
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from kreisel import discovery
from kreisel.cli.main import COMMANDS
from kreisel.cli.main import configure as configured

HELP = "a script that completes commands, options and files at the prompt of bash, zsh or fish"

_EXAMPLES = """\
bash, in ~/.bashrc:               source <(kreisel completion bash)
zsh, in ~/.zshrc after compinit:  source <(kreisel completion zsh)
fish, once:                       kreisel completion fish > ~/.config/fish/completions/kreisel.fish
"""

_INSTALL = {line.split(",")[0]: re.split(r": {2,}", line)[1] for line in _EXAMPLES.splitlines()}

# Metavars of what lies on the disk.
_FILES = {
    *("FILE", "FOLDER", "DIR", "IN", "OUT", "PICTURE", "SENSOR"),
    *("DEGC|FILE", "REAL", "POSES", "TRUTH", "ESTIMATE", "SCENARIO", "TRIAL"),
}

# Words that an option takes where its command checks them, and not argparse.
_WORDS = {
    "--mode": ("auto", "9", "6", "gyro"),
    "--method": ("auto", "spline", "smooth"),
    "--minimum": ("jerk", "snap"),
    "--orientation": ("tangent", "transport", "level"),
    "--score": ("total", "heading", "inclination"),
}


class _Argument(NamedTuple):
    """What a command takes, and what may stand in its place."""

    names: tuple[str, ...]  # none for what is known by its place
    help: str
    takes: bool  # a value after the name
    words: tuple[str, ...]
    files: bool


_Commands = dict[str, tuple[str, list[_Argument]]]


def configure(parser: ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("shell", choices=("bash", "zsh", "fish"), help="the shell to complete in")
    parser.epilog = _EXAMPLES


def run(args: Namespace) -> int:
    """Print the script."""
    commands = {
        name: (discovery.constant(COMMANDS, name, "HELP"), _arguments(name))
        for name in discovery.names(COMMANDS)
    }
    script = {"bash": _bash, "zsh": _zsh, "fish": _fish}[args.shell]
    lines = list(script(commands))
    # zsh knows a file of completions by its first line.
    lines.insert(1, f"# Completes kreisel. To install: {_INSTALL[args.shell]}")
    print("\n".join(lines))
    return 0


def _arguments(command: str) -> list[_Argument]:
    parser = ArgumentParser(prog=command)
    configured(parser, command)
    return [_argument(action) for action in parser._actions]


def _argument(action: Action) -> _Argument:
    takes = action.nargs != 0
    words = tuple(map(str, action.choices or ())) or _known(action)
    text = " ".join((action.help or "").replace("%%", "%").split())
    files = action.metavar in _FILES or (action.dest == "sensor" and not action.choices)
    return _Argument(tuple(action.option_strings), text, takes, words, takes and files)


def _known(action: Action) -> tuple[str, ...]:
    """The names of ours that stand for the metavar of an argument."""
    from kreisel.cli import courses, filters
    from kreisel.data.frames import WORLDS
    from kreisel.files import doors
    from kreisel.simulate import presets

    name = action.option_strings[-1] if action.option_strings else action.dest
    vocabulary: dict[str, Sequence[str]] = {
        **_WORDS,
        **dict.fromkeys(("--frame", "--to-frame"), tuple(WORLDS)),
        **dict.fromkeys(("--from", "--to", "--imu-format"), tuple(doors.format_names())),
        **dict.fromkeys(("--sensor", "sensor"), tuple(presets.names())),
        "--kind": tuple(doors.KINDS),
        "--as": tuple(courses.KINDS),
        "--filter": [plug_in.replace("_", "-") for plug_in in discovery.names(filters.FILTERS)],
    }
    return tuple(vocabulary.get(name, ()))


def _places(arguments: Sequence[_Argument]) -> _Argument:
    """What may stand anywhere in a command, all its places together."""
    places = [argument for argument in arguments if not argument.names]
    words = tuple(word for place in places for word in place.words)
    return _Argument((), "", True, words, any(place.files for place in places))


def _bash(commands: _Commands) -> Iterator[str]:
    yield "# bash"
    yield from _BASH_HEAD
    yield '    case "$command $previous" in'
    for name, (_, arguments) in commands.items():
        for argument in arguments:
            if argument.takes and argument.names:
                pattern = "|".join(f'"{name} {option}"' for option in argument.names)
                yield f"        {pattern}) {_bash_offer(argument.words, argument.files)}; return ;;"
    yield "    esac"
    yield '    case "$command" in'
    yield f'        "") {_bash_offer((*commands, "--help", "--version"), False)} ;;'
    for name, (_, arguments) in commands.items():
        options = tuple(option for argument in arguments for option in argument.names)
        place = _places(arguments)
        yield f"        {name})"
        yield f'            if [[ "$current" == -* ]]; then {_bash_offer(options, False)}'
        yield f"            else {_bash_offer(place.words, place.files)}; fi ;;"
    yield "    esac"
    yield "}"
    yield "complete -F _kreisel kreisel"


_BASH_HEAD = r"""
_kreisel_offer() {
    # $1: words; $2: 1 where files fit too
    local IFS=$' \t\n'
    COMPREPLY=($(compgen -W "$1" -- "$current"))
    if [[ "$2" == 1 ]]; then
        compopt -o filenames 2>/dev/null
        IFS=$'\n'
        COMPREPLY+=($(compgen -f -- "$current"))
    fi
}
_kreisel() {
    local current="${COMP_WORDS[COMP_CWORD]}" previous="${COMP_WORDS[COMP_CWORD-1]}" command="" word
    # --frame=ned arrives as three words.
    [[ "$current" == "=" ]] && current=""
    [[ "$previous" == "=" ]] && previous="${COMP_WORDS[COMP_CWORD-2]}"
    [[ "${COMP_WORDS[COMP_CWORD]}" == "=" ]] && previous="${COMP_WORDS[COMP_CWORD-1]}"
    for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
        if [[ "$word" != -* ]]; then command="$word"; break; fi
    done
    COMPREPLY=()""".splitlines()[1:]


def _bash_offer(words: Sequence[str], files: bool) -> str:
    return f"_kreisel_offer {shlex.quote(' '.join(words))} {int(files)}"


def _zsh(commands: _Commands) -> Iterator[str]:
    yield "#compdef kreisel"
    yield "_kreisel() {"
    yield "    local -a commands=("
    for name, (text, _) in commands.items():
        yield f"        {shlex.quote(f'{name}:{text}')}"
    yield "    )"
    yield "    if (( CURRENT == 2 )); then"
    yield "        _describe -t commands command commands"
    yield "        _arguments '--help[how to use it]' '--version[of kreisel]'"
    yield "        return"
    yield "    fi"
    yield "    local command=${words[2]}"
    yield "    shift words; (( CURRENT-- ))"
    yield '    case "$command" in'
    for name, (_, arguments) in commands.items():
        yield f"        {name}) _arguments \\"
        for argument in arguments:
            for option in argument.names:
                yield f"            {shlex.quote(_zsh_option(option, argument))} \\"
        yield f"            {shlex.quote('*:argument:' + _zsh_offer(_places(arguments)))} ;;"
    yield "    esac"
    yield "}"
    # Sourced it has to be made known; found in a folder of completions it is called.
    yield 'if [[ "${funcstack[1]}" == _kreisel ]]; then _kreisel "$@"; else compdef _kreisel kreisel; fi'


def _zsh_option(option: str, argument: _Argument) -> str:
    text = re.sub(r"([\[\]:\\])", r"\\\1", argument.help)
    return f"*{option}[{text}]" + (f":value:{_zsh_offer(argument)}" if argument.takes else "")


def _zsh_offer(argument: _Argument) -> str:
    words = f"compadd -- {' '.join(map(shlex.quote, argument.words))}"
    if argument.words and argument.files:
        return f"{{ {words}; _files }}"
    return f"{{ {words} }}" if argument.words else "_files" if argument.files else " "


def _fish(commands: _Commands) -> Iterator[str]:
    yield "# fish"
    yield "complete -c kreisel -f"
    first = "__fish_use_subcommand"
    yield f"complete -c kreisel -n {first} -l help -s h -d 'how to use it'"
    yield f"complete -c kreisel -n {first} -l version -d 'of kreisel'"
    for name, (text, arguments) in commands.items():
        yield f"complete -c kreisel -n {first} -a {name} -d {_fish_text(text)}"
        within = f"complete -c kreisel -n '__fish_seen_subcommand_from {name}'"
        for argument in arguments:
            if argument.names:
                yield f"{within} {_fish_option(argument)} -d {_fish_text(argument.help)}"
        place = _places(arguments)
        if place.words:
            yield f"{within} -a {_fish_text(' '.join(place.words))}"
        if place.files:
            yield f"{within} -F"


def _fish_option(argument: _Argument) -> str:
    names = " ".join(("-l " if n.startswith("--") else "-s ") + n.lstrip("-") for n in argument.names)
    words = f" -a {_fish_text(' '.join(argument.words))}" if argument.words else ""
    return names + words + (" -r" if argument.takes else "") + (" -F" if argument.files else "")


def _fish_text(text: str) -> str:
    # Unlike other shells fish knows two escapes between single quotes.
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"
