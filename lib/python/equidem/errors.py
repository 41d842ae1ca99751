# SPDX-License-Identifier: GPL-3.0-or-later
"""Exceptions. Each is a sentence: the problem, why it is one, and what to do."""

from __future__ import annotations

import functools
import re


class _Sentence(BaseException):
    """An error with the parts of its sentence.

    Attributes
    ----------
    problem, why, remedy, where : str
        `where` is "file:line: key" or the key, or empty.
    """

    def __init__(self, problem: str, why: str = "", remedy: str = "", where: str = "") -> None:
        problem, why, remedy = map(in_python, (problem, why, remedy))
        where = without_memory_names(where)
        self.problem, self.why, self.remedy, self.where = problem, why, remedy, where
        text = (f"{where}: " if where else "") + problem + (f" ({why})" if why else "") + "."
        stop = "" if remedy.endswith((".", "?", "!")) else "."
        super().__init__(text + (f" {remedy}{stop}" if remedy else ""))

    def __reduce__(self) -> tuple[type, tuple[str, str, str, str]]:
        return type(self), (self.problem, self.why, self.remedy, self.where)


def without_memory_names(text: str) -> str:
    """Without the names of cases and assemblies in memory: "case#3:2: springs.kT" is "springs.kT"."""
    return text if "#" not in text else re.sub(r"(--set [\w.]+=\")?\b(case|assembly)#\d+(:\d+)*\"?(: |$)", "", text)


_OPTION = re.compile(r"(?<![\w'\"-])--(?:set (?P<taken>[\w.]+)=none|accept (?P<accepted>(?!with)[a-z]\w*)|"
                     r"(?P<name>[a-z]+(?:-[a-z]+)*)(?P<value> [A-Z]+\b)?)")


@functools.cache
def _flags() -> frozenset[str]:
    from . import _core  # which imports this module
    return frozenset(_core.flags_of_verbs())


def in_python(text: str) -> str:
    """With arguments in place of options of the command line: "pass --overwrite" is "pass overwrite=True"."""
    def argument(option: re.Match[str]) -> str:
        if option["taken"]:
            return f'set("{option["taken"]}", None)'
        if option["accepted"]:
            return f'accept="{option["accepted"]}"'
        name = option["name"]
        return name.replace("-", "_") + (option["value"] or "=True" * (name in _flags())).replace(" ", "=")

    return _OPTION.sub(argument, text)


class EquidemError(Exception):
    """Base of BadInput and ComputationFailed."""


class BadInput(_Sentence, EquidemError, ValueError):
    """The input cannot be used as it is. A ValueError."""


class ComputationFailed(_Sentence, EquidemError, RuntimeError):
    """The input was accepted, but no trustworthy answer exists or was reached. A RuntimeError."""


class Interrupted(_Sentence, KeyboardInterrupt):
    """The user pressed Ctrl-C. A KeyboardInterrupt."""
