"""Inputs in callers' containers: numbers, arrays, Series, DataFrames and DataArrays.

Series, frames and labelled arrays come back with their index, or dims and coordinates. pandas and
xarray are recognised by the names of their types: without such values they are not imported.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from fuzzyarm.inference.errors import InferenceError
from fuzzyarm.language.model.rulebase import Variable

# --- One mapping of inputs by name ---


def gathered(
    inputs: Any, named: Mapping[str, Any], variables: Sequence[Variable]
) -> tuple[dict[str, Any], Labels | None]:
    """Merge inputs passed in a container and by name; return them and the labels of the results.

    Other columns of a frame, and variables of a Dataset, are ignored. InferenceError if an input is
    given twice, or the labels of two inputs differ.
    """
    values_by_name = by_name(inputs, named, variables)
    for value in values_by_name.values():
        if type(value) is not float and _library(value):  # mostly floats, and this test is fast
            break
    else:
        return values_by_name, None
    labelled = {name: value for name, value in values_by_name.items() if _library(value)}
    libraries = {_library(value) for value in labelled.values()}
    if len(libraries) > 1:
        raise InferenceError("inputs are labelled by pandas or by xarray, not by both")
    make = _of_pandas if libraries == {"pandas"} else _of_xarray
    plain, wrap = make(labelled, values_by_name)
    return {**values_by_name, **plain}, Labels(wrap, type(inputs) if _library(inputs) else None)


def by_name(inputs: Any, named: Mapping[str, Any], variables: Sequence[Variable]) -> dict[str, Any]:
    """Return merged inputs; parameters and errors as of :func:`gathered`."""
    if inputs is None:
        return dict(named)
    names = [variable.name for variable in variables]
    if _library(inputs):
        values_by_name = {name: inputs[name] for name in names if name in inputs}
    elif isinstance(inputs, Mapping):
        values_by_name = dict(inputs)
    else:
        kind = type(inputs).__name__
        message = f"inputs are given by name (a mapping, DataFrame or Dataset), not as {kind}"
        raise InferenceError(message, hint=_call_by_name(inputs, names))
    for name, value in named.items():
        if name in values_by_name:
            raise InferenceError(f"input '{name}' is given twice")
        values_by_name[name] = value
    return values_by_name


def _call_by_name(inputs: Any, names: Sequence[str]) -> str:
    """Return positional values as arguments by name."""
    values = list(inputs) if isinstance(inputs, list | tuple) else [inputs]
    shown = [repr(v) if isinstance(v, int | float) else "…" for v in values[: len(names)]]
    shown += ["…"] * (len(names) - len(shown))
    return f"write {', '.join(map('='.join, zip(names, shown, strict=True)))}" if names else ""


def _library(value: Any) -> str:
    """Return ``pandas`` or ``xarray`` for a value labelled by one of them, else ''."""
    library = type(value).__module__.partition(".")[0]
    if library == "pandas" and hasattr(value, "index") and hasattr(value, "to_numpy"):
        return library
    return library if library == "xarray" and hasattr(value, "coords") else ""


class Labels:
    """Labels of the inputs, for the outputs."""

    def __init__(self, wrap: Callable[[str, Any], Any], container: type | None) -> None:
        self._wrap = wrap
        self._container = container

    def on(self, results: Mapping[str, Any]) -> Any:
        """Return the outputs with the labels, in the container of the inputs."""
        wrapped = {name: self._wrap(name, values) for name, values in results.items()}
        return wrapped if self._container is None else self._container(wrapped)


# --- pandas ---


def _of_pandas(
    labelled: Mapping[str, Any], inputs: Mapping[str, Any]
) -> tuple[dict[str, Any], Callable[[str, Any], Any]]:
    first, *others = labelled
    template = labelled[first]
    for name in others:
        other = labelled[name]
        same = other.ndim == template.ndim and all(
            a.equals(b) for a, b in zip(template.axes, other.axes, strict=True)
        )
        if not same:
            hint = "align them first, or give their values: .to_numpy()"
            message = f"the inputs '{first}' and '{name}' have different indexes"
            raise InferenceError(message, hint=hint)

    def wrap(name: str, values: Any) -> Any:
        if getattr(values, "shape", ()) != template.shape:
            values = _fitting(first, values, template.shape)
        if template.ndim == 1:
            return type(template)(values, index=template.index, name=name)
        return type(template)(values, index=template.index, columns=template.columns)

    return {name: _numbers(value) for name, value in labelled.items()}, wrap


def _numbers(value: Any) -> Any:
    """Return the values of a Series or a DataFrame; missing ones of nullable types as NaN."""
    dtypes = [value.dtype] if value.ndim == 1 else list(value.dtypes)
    if all(getattr(dtype, "kind", "O") in "fiub" for dtype in dtypes):
        return value.to_numpy(dtype="float64", na_value=float("nan"))
    return value.to_numpy()


def _fitting(first: str, values: Any, shape: tuple[int, ...]) -> Any:
    import numpy as np

    try:
        return np.broadcast_to(values, shape)
    except ValueError:
        broadcast = np.shape(values)
        message = (
            f"'{first}' has labels for the shape {shape}, the inputs together have {broadcast}"
        )
        raise InferenceError(message) from None


# --- xarray ---


def _of_xarray(
    labelled: Mapping[str, Any], inputs: Mapping[str, Any]
) -> tuple[dict[str, Any], Callable[[str, Any], Any]]:
    import xarray as xr

    for name, value in inputs.items():
        if name not in labelled and getattr(value, "ndim", isinstance(value, list | tuple)):
            hint = "give it as a DataArray too"
            raise InferenceError(f"the array of input '{name}' has no dims", hint=hint)
    try:
        arrays = xr.align(*labelled.values(), join="exact", copy=False)
    except ValueError as error:
        message = "the coordinates of the inputs differ"
        raise InferenceError(message, hint=str(error).partition("\n")[0]) from None
    dims = list(dict.fromkeys(dim for array in arrays for dim in array.dims))
    sizes = {dim: size for array in arrays for dim, size in array.sizes.items()}
    coords = {name: value for array in arrays for name, value in array.coords.items()}
    coords = {name: value for name, value in coords.items() if set(value.dims) <= set(dims)}
    plain = {name: _on_dims(array, dims) for name, array in zip(labelled, arrays, strict=True)}

    def wrap(name: str, values: Any) -> Any:
        import numpy as np

        whole = np.broadcast_to(values, [sizes[dim] for dim in dims]).copy()
        return xr.DataArray(whole, dims=dims, coords=coords, name=name)

    return plain, wrap


def _on_dims(array: Any, dims: Sequence[Any]) -> Any:
    """Return the values of a DataArray, with an axis of size 1 for each of `dims` that it lacks."""
    own_dims = [dim for dim in dims if dim in array.dims]
    index = tuple(slice(None) if dim in own_dims else None for dim in dims)
    return array.transpose(*own_dims).to_numpy()[index]
