# SPDX-License-Identifier: GPL-3.0-or-later
"""Arguments as arrays of the type and shape that the compiled part reads."""

from __future__ import annotations

import operator
from typing import Any

import numpy as np
import numpy.typing as npt

from .errors import BadInput

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int32]
_LARGEST = 2**63 - 1  # of the whole numbers of the compiled part


def _shown(shape: tuple[int | None, ...]) -> str:
    return "(" + ", ".join("n" if s is None else str(s) for s in shape) + ("," if len(shape) == 1 else "") + ")"


def _check_shape(name: str, array: npt.NDArray[Any], shapes: tuple[tuple[int | None, ...], ...]) -> None:
    for shape in shapes:
        if array.ndim == len(shape) and all(s is None or s == n for s, n in zip(shape, array.shape)):
            return
    raise BadInput(f"{name} has the shape {array.shape}", f"it must be {' or '.join(map(_shown, shapes))}",
                   "Reshape it")


def _check_mask(name: str, value: Any) -> None:
    if isinstance(value, np.ma.MaskedArray) and np.any(value.mask):
        raise BadInput(f"{name} has masked entries", "every number is used", "Fill them, or leave them out")


def whole(name: str, value: Any, least: int, most: int = _LARGEST) -> int:
    """A whole number of a range."""
    try:
        number = operator.index(value)
    except TypeError:
        number = least - 1
    if not least <= number <= most:
        upto = f"{least} or more" if number < least and most == _LARGEST else f"from {least} to {most}"
        raise BadInput(f"{name} = {value!r}", f"it is a whole number, {upto}", f"Give {upto}", name)
    return number


def share(name: str, value: Any) -> float:
    """A number from 0 to 1."""
    number = float(floats(name, value, ()))
    if not 0 <= number <= 1:
        raise BadInput(f"{name} = {number:g}", "it is a share of the sum of two radii", "Give 0 to 1", name)
    return number


def floats(name: str, value: npt.ArrayLike, *shapes: tuple[int | None, ...]) -> Floats:
    """An array of finite numbers with one of the shapes, in which None stands for any number."""
    _check_mask(name, value)
    try:
        if np.asarray(value).dtype.kind not in "iufO":
            raise TypeError(f"numbers are real, and its type is {np.asarray(value).dtype}")
        array = np.asarray(value, dtype=np.float64, order="C")
    except (TypeError, ValueError) as error:
        raise BadInput(f"{name} is no array of numbers", str(error), "Give numbers") from None
    _check_shape(name, array, shapes)
    if not np.isfinite(array).all():
        first = tuple(int(k) for k in np.argwhere(~np.isfinite(array))[0])
        raise BadInput(f"{name} holds {array[first]} at {list(first)}", "every number must be finite", "Correct it")
    return array


def integers(name: str, value: npt.ArrayLike, *shapes: tuple[int | None, ...]) -> Integers:
    """An array of whole numbers with one of the shapes."""
    _check_mask(name, value)
    array = np.asarray(value)
    if array.size == 0:
        array = array.astype(np.int32)
    if array.dtype.kind not in "iu":
        raise BadInput(f"{name} holds no whole numbers", f"its type is {array.dtype}", "Give the numbers of discs")
    _check_shape(name, array, shapes)
    if array.size > 0 and (array.max() > np.iinfo(np.int32).max or array.min() < np.iinfo(np.int32).min):
        raise BadInput(f"{name} holds a number beyond 32 bits", "discs are numbered by 32 bits", "Correct it")
    return np.ascontiguousarray(array, dtype=np.int32)
