# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of a case, given as dictionaries, as TOML text."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .errors import BadInput


def value(given: Any, key: str) -> str:
    """A value as TOML on one line."""
    if isinstance(given, (bool, np.bool_)):
        return "true" if given else "false"
    if isinstance(given, (int, np.integer)):
        return str(int(given))
    if isinstance(given, (float, np.floating)):
        number = float(given)
        return repr(number) if math.isfinite(number) else str(number)
    if isinstance(given, (str, os.PathLike)):
        return json.dumps(os.fspath(given), ensure_ascii=False)
    if isinstance(given, np.ma.MaskedArray) and np.any(given.mask):
        raise BadInput("masked entries", "every number is used", "Fill them, or leave them out", key)
    if isinstance(given, np.ndarray) and given.ndim == 0:
        return value(given.item(), key)
    if isinstance(given, Mapping):
        entries = (f"{json.dumps(str(k))} = {value(v, f'{key}.{k}')}" for k, v in given.items() if v is not None)
        return "{ " + ", ".join(entries) + " }"
    if isinstance(given, (Sequence, np.ndarray)):
        return "[" + ", ".join(value(v, f"{key}.{k}") for k, v in enumerate(given)) + "]"
    raise BadInput(f"a value of type {type(given).__name__}",
                   "a case holds numbers, text, true, false, lists and tables", "Give one of these", key)


def document(tables: Mapping[str, Any]) -> str:
    """The tables of a case, one a line."""
    tables = {"schema": "equidem/1", **tables}
    return "".join(f"{json.dumps(name)} = {value(given, name)}\n"
                   for name, given in tables.items() if given is not None)
