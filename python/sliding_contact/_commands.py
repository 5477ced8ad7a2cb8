"""The command line: one table of commands, from which parser, help, completion and manual page are made.

An option is an argument of the method of `Scene` that its command calls, under the same name, so what is refused is said in the same words.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import sys
import time
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Optional, Sequence, Union

from ._errors import Error, Interrupted, SceneNote, writing
from ._numbers import number
from .results import Simulation, StepFailed
from .scene import Scene, scenes

SHELLS = ("bash", "zsh", "fish")
NOT_READ = 141  # exit status after a closed pipe, as in shells


@dataclass(frozen=True)
class Option:
    """An argument of a command; one whose flags have no dash is positional."""

    flags: tuple[str, ...]
    help: str
    value: str = ""  #: what stands for the value in the help; empty: a switch
    repeated: bool = False
    several: bool = False  #: one or more of a positional one
    default: Optional[str] = None
    choices: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """What it means, with its default."""
        return self.help if self.default is None else f"{self.help} [default: {self.default}]"

    def add_to(self, parser: argparse.ArgumentParser) -> None:
        settings: dict[str, Any] = {"help": self.text}
        positional = not self.flags[0].startswith("-")
        if not self.value and not positional:
            parser.add_argument(*self.flags, action="store_true", **settings)
            return
        if self.choices:
            settings["choices"] = self.choices
        if self.several:
            settings["nargs"] = "+"
        if self.repeated:
            settings.update(action="append", default=[])
        elif self.default is not None:
            settings["default"] = self.default
            if positional:
                settings["nargs"] = "?"
        if not positional:
            settings["metavar"] = self.value
        parser.add_argument(*self.flags, **settings)


Arguments = argparse.Namespace

SCENE = Option(("scene",), "scene file, or name of a shipped scene (`sliding-contact scenes`)")
SET = Option(("-s", "--set"), 'another value of a variable, as punch.width="40 mm"; may be repeated', "KEY=VALUE", repeated=True)
JSON = Option(("--json",), "print JSON instead of a table")
PLOT = Option(("-p", "--plot"), "draw into this file (.svg, .pdf or .png); needs matplotlib", "FILE")
INPUTS = Option(("-i", "--inputs"), "inputs over time (CSV or Parquet): time [s], sliding_velocity [km/h], normal_load [kN], or any input with its unit", "FILE.csv")
COLUMN = Option(("--column",), "what a column of another name is, as COF=friction_coefficient; may be repeated", "HEADER=VARIABLE", repeated=True)
STRICT = Option(("--strict",), "refuse columns that are not known instead of leaving them out")
CELLS = Option(("--cells",), "cells of the contact line; by default the scene's", "N")
COLD = Option(("--cold",), "without heat")


def _scene(arguments: Arguments) -> Scene:
    return Scene(arguments.scene, arguments.set)


def _reading(arguments: Arguments) -> dict[str, Any]:
    """How columns are read, as arguments of `Scene`."""
    for text in arguments.column:
        if "=" not in text:
            raise Error(f'column = {text!r} must be HEADER=VARIABLE, as "COF=friction_coefficient"')
    return {"columns": dict(text.rsplit("=", 1) for text in arguments.column), "strict": arguments.strict}


def _print(arguments: Arguments, result: Any) -> None:
    """Prints a result, and draws it where a file is named."""
    if getattr(arguments, "plot", None) is not None:
        result.plot(arguments.plot)
    print(json.dumps(result.record, indent=2) if arguments.json else result)


class Progress:
    """What is done, on the error stream, after the first second: a line that changes on a terminal, elsewhere one a minute."""

    def __init__(self) -> None:
        self.is_terminal = sys.stderr.isatty()
        self.next = time.monotonic() + 1.0

    def __enter__(self) -> "Progress":
        return self

    def __exit__(self, *_error: object) -> None:
        if self.is_terminal:
            print("\r\033[K", end="", file=sys.stderr, flush=True)

    def __call__(self, done: Union[float, str]) -> None:
        if time.monotonic() < self.next:
            return
        self.next = time.monotonic() + (0.1 if self.is_terminal else 60.0)
        line = done if isinstance(done, str) else f"{100.0 * done:.0f} %"
        print(f"\r\033[K{line}" if self.is_terminal else line, end="" if self.is_terminal else "\n", file=sys.stderr, flush=True)


def _print_so_far(arguments: Arguments, work: Callable[[Progress], Any]) -> Any:
    """Prints the result of work and returns it, at Ctrl-C what there is of it."""
    try:
        with Progress() as progress:
            result = work(progress)
    except Interrupted as stopped:
        _print(arguments, stopped.result)
        raise Interrupted(stopped.reason, None) from None
    _print(arguments, result)
    return result


def said(text: object) -> str:
    """A message of the package, with the option for the argument."""
    return str(text).replace('columns={"HEADER": "VARIABLE"}', '--column "HEADER=VARIABLE"').replace('"HEADER": ""', '"HEADER="').replace("columns: ", "--column: ")


def kind(category: type[Warning]) -> str:
    return "note" if issubclass(category, SceneNote) else "warning"


def _told(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


def _write(result: Simulation, path: str) -> None:
    """Every input and output over the time, in SI units, as `cargo fmu simulate -o` writes them."""
    with writing(path), open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["time [s]", *(f"{name} [{unit}]" for name, unit in result.units.items())])
        writer.writerows(zip(*(map(repr, values.tolist()) for values in (result.time, *result.values()))))


def _is_same(one: str, other: str) -> bool:
    """Whether both name one file that exists."""
    return os.path.exists(one) and os.path.exists(other) and os.path.samefile(one, other)


def _simulate(arguments: Arguments) -> None:
    output = arguments.output
    if output is not None and Path(output).suffix.lower() != ".csv":
        raise Error(f"output = {output!r} must end in .csv")
    for name, written in (("output", output), ("plot", arguments.plot)):
        for read in (arguments.scene, arguments.inputs, arguments.measured):
            if written is not None and read is not None and _is_same(written, read):
                raise Error(f"{name} = {written!r} would replace a file that is read")
    times = [time for times in arguments.at for time in times.split(",")]
    reading = _reading(arguments)
    scene = _scene(arguments)
    try:
        with Progress() as progress:
            result = scene.simulate(arguments.inputs, measured=arguments.measured, step=arguments.step, at=times, progress=progress, **reading)
    except StepFailed as failed:
        if output is None or failed.result is None:
            raise
        _write(failed.result, output)
        raise Error(f"{failed}; the rows before it are in {output}") from failed
    except Interrupted as stopped:
        if output is not None:
            _write(stopped.result, output)
        rows = f"the rows up to there are in {output}" if output is not None else "--output keeps the rows"
        raise Interrupted(f"{stopped.reason}; {rows}", None) from None
    if output is not None:
        _write(result, output)
    if arguments.plot is not None:
        result.plot(arguments.plot, measured=arguments.measured, **reading)
    print(json.dumps(result.record, indent=2) if arguments.json else result)


def _plan(arguments: Arguments) -> None:
    scene, reading = _scene(arguments), _reading(arguments)
    result = _print_so_far(arguments, lambda progress: scene.plan(arguments.inputs, tolerance=arguments.tolerance, progress=progress, **reading))
    if getattr(result, "unmet", None) is not None:
        raise Error(result.unmet)


def _steady(arguments: Arguments) -> None:
    _print(arguments, _scene(arguments).steady(cells=arguments.cells, return_speed=arguments.return_speed, cold=arguments.cold))


def _cycles(arguments: Arguments) -> None:
    scene = _scene(arguments)
    given = {"tolerance": arguments.tolerance, "cells": arguments.cells, "cold": arguments.cold}
    _print_so_far(arguments, lambda progress: scene.cycles(arguments.cycles, progress=progress, **given))


def _fit(arguments: Arguments) -> None:
    parameters = [name for name in arguments.parameters.split(",") if name]
    confidence = number("confidence", arguments.confidence)
    try:
        with Progress() as progress:
            fit = _scene(arguments).fit(arguments.records, parameters, confidence, progress=progress, **_reading(arguments))
    except Interrupted as stopped:
        raise Interrupted(f"{stopped}; as {' '.join(f'--set {name}={value:.6g}' for name, value in stopped.result.items())}", None) from None
    if arguments.plot is not None:
        fit.plot(arguments.plot)
    print(fit)


def _package(arguments: Arguments) -> None:
    scene = _scene(arguments)
    print(scene.package(f"SlidingContact.{scene.name}.fmu" if arguments.output is None else arguments.output))


def _scenes(_: Arguments) -> None:
    for name in scenes():
        print(f"{name}: {Scene.load(name).description}")


def _completion(arguments: Arguments) -> None:
    print(completion(arguments.shell))


def _man(_: Arguments) -> None:
    print(manual())


@dataclass(frozen=True)
class Command:
    """A command: what it does in one line, its arguments, and the function that does it."""

    name: str
    help: str
    options: tuple[Option, ...]
    run: Callable[[Arguments], None]


COMMANDS = (
    Command(
        "simulate",
        "simulate a scene along inputs of your own: table, CSV, figure, deviation from a measured record",
        (
            SCENE,
            INPUTS,
            SET,
            Option(("--step",), 'longest communication step, in seconds or as "20 ms"', "TIME"),
            Option(("--at",), 'times of the profiles over the contact, as 0,10,"2 min"', "TIMES", repeated=True),
            Option(("-m", "--measured"), "measured record (CSV or Parquet), drawn over the curves of the same names", "FILE.csv"),
            Option(("-o", "--output"), "write every input and output over the time, in SI units", "FILE.csv"),
            COLUMN,
            STRICT,
            PLOT,
            JSON,
        ),
        _simulate,
    ),
    Command(
        "plan",
        "print the level that solver.fidelity = auto takes; with inputs, error and cost of every level on them",
        (SCENE, INPUTS, SET, Option(("--tolerance",), "relative tolerance, where the scene has none", "NUMBER"), COLUMN, STRICT, JSON),
        _plan,
    ),
    Command(
        "steady",
        "compute the steady state under nominal load and sliding, without time integration",
        (SCENE, SET, CELLS, Option(("--return-speed",), "speed of the backward half-stroke, m/s", "NUMBER"), COLD, PLOT, JSON),
        _steady,
    ),
    Command(
        "cycles",
        "advance a reciprocating scene over many cycles at nominal load and speed",
        (
            SCENE,
            SET,
            Option(("--cycles",), "number of cycles", "N", default="1e6"),
            Option(("--tolerance",), "largest estimated error of a jump", "NUMBER", default="1e-3"),
            CELLS,
            COLD,
            PLOT,
            JSON,
        ),
        _cycles,
    ),
    Command(
        "fit",
        "fit parameters to end values or histories of tests, with confidence intervals; needs scipy",
        (
            Option(("records",), "end values of tests (load [N], speed [m/s], distance [m], volume [mm3]) or histories (time [s], ...), as CSV", several=True),
            Option(("--scene",), "scene of the tests", "SCENE", default="pin_on_disk"),
            SET,
            Option(("--parameters",), "what is fitted, with commas", "NAMES", default="punch.wear_coefficient,punch.wear_pressure_exponent"),
            Option(("--confidence",), "probability that the intervals hold the values", "NUMBER", default="0.95"),
            COLUMN,
            STRICT,
            PLOT,
        ),
        _fit,
    ),
    Command(
        "package",
        "write the FMU of a scene (FMI 2.0 for co-simulation), for the platform of this package",
        (SCENE, SET, Option(("-o", "--output"), "file to write [default: SlidingContact.NAME.fmu]", "FILE.fmu")),
        _package,
    ),
    Command("scenes", "list the shipped scenes", (), _scenes),
    Command(
        "completion",
        "print the completion of this command for a shell, to be read by it when it starts",
        (Option(("shell",), "shell", "SHELL", choices=SHELLS),),
        _completion,
    ),
    Command("man", "print the manual page of this command, to be read by `man -l -`", (), _man),
)
PROGRAM = "sliding-contact"
ABOUT = "wear and heat of two bodies in sliding contact"


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}."


def parser() -> argparse.ArgumentParser:
    from . import __version__

    own = argparse.ArgumentParser(PROGRAM, description=_sentence(ABOUT), allow_abbrev=False)
    own.add_argument("--version", action="version", version=f"{PROGRAM} {__version__}")
    commands = own.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for command in COMMANDS:
        sub = commands.add_parser(command.name, help=command.help, description=_sentence(command.help), allow_abbrev=False)
        for option in command.options:
            option.add_to(sub)
        sub.set_defaults(run=command.run)
    return own


def _flags(command: Command) -> list[str]:
    return [flag for option in command.options for flag in option.flags if flag.startswith("--")] + ["--help"]


def completion(shell: str) -> str:
    """Completion of commands, options, shipped scenes and files."""
    names = " ".join(command.name for command in COMMANDS)
    known = " ".join(scenes())

    def quoted(text: str) -> str:
        return "'" + text.replace("'", "\\'") + "'"

    if shell == "fish":
        lines = [f"complete -c {PROGRAM} -n __fish_use_subcommand -f -a {command.name} -d {quoted(command.help)}" for command in COMMANDS]
        for command in COMMANDS:
            seen = f"-n '__fish_seen_subcommand_from {command.name}'"
            if SCENE in command.options:
                lines.append(f"complete -c {PROGRAM} {seen} -a '{known}'")
            for option in command.options:
                flags = " ".join(f"-l {flag[2:]}" if flag.startswith("--") else f"-s {flag[1:]}" for flag in option.flags if flag.startswith("-"))
                if flags:
                    lines.append(f"complete -c {PROGRAM} {seen} {flags} -d {quoted(option.help)}" + (" -r" if option.value else ""))
                elif option.choices:
                    lines.append(f"complete -c {PROGRAM} {seen} -f -a '{' '.join(option.choices)}'")
        return "\n".join(lines)
    cases = []
    for command in COMMANDS:
        words = [*_flags(command), *(choice for option in command.options for choice in option.choices)]
        cases.append(f'    {command.name}) words="{" ".join(words)}{" " + known if SCENE in command.options else ""}" ;;')
    lines = [
        f"_{PROGRAM.replace('-', '_')}() {{",
        f'  local words="{names}" own="${{COMP_WORDS[COMP_CWORD]}}"',
        '  [ "$COMP_CWORD" -gt 1 ] && case "${COMP_WORDS[1]}" in',
        *cases,
        "  esac",
        '  COMPREPLY=($(compgen -W "$words" -- "$own"))',
        '  [ "$COMP_CWORD" -gt 1 ] && COMPREPLY+=($(compgen -f -- "$own"))',
        "}",
        f"complete -o filenames -F _{PROGRAM.replace('-', '_')} {PROGRAM}",
    ]
    return "\n".join((["autoload -U +X bashcompinit && bashcompinit"] if shell == "zsh" else []) + lines)


def manual() -> str:
    """The manual page in the language of man(7)."""
    from . import __version__

    def quoted(text: str) -> str:
        return text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")

    lines = [f'.TH {PROGRAM.upper()} 1 "" "{PROGRAM} {__version__}"', ".SH NAME", f"{quoted(PROGRAM)} \\- {ABOUT}", ".SH SYNOPSIS"]
    lines += [f".B {quoted(PROGRAM)}", r"\fICOMMAND\fR [\fIOPTION\fR]...", ".SH COMMANDS"]
    for command in COMMANDS:
        lines += [f".SS {command.name}", quoted(_sentence(command.help))]
        for option in command.options:
            value = f" \\fI{quoted(option.value)}\\fR" if option.value and option.flags[0].startswith("-") else ""
            lines += [".TP", f"\\fB{quoted(', '.join(option.flags))}\\fR{value}", quoted(option.text)]
    return "\n".join(lines)


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Runs the command line and returns its exit status."""
    given = parser().parse_args(arguments)
    with warnings.catch_warnings():
        # Each once, without the line of the package that raised it.
        warnings.simplefilter("once")
        warnings.showwarning = lambda message, category, *_: _told(f"{kind(category)}: {said(message)}")
        try:
            given.run(given)
            sys.stdout.flush()
        except BrokenPipeError:
            # What is left to be written has no reader either.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            return NOT_READ
        except KeyboardInterrupt as stopped:
            _told(str(stopped) or "interrupted")
            return 130
        except (Error, ImportError, OSError) as error:
            print(f"error: {said(error)}", file=sys.stderr)
            return 1
    return 0
