"""Tables in, tables out, by Arrow's PyCapsule interface."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from atm._atm import fuse

if TYPE_CHECKING:
    from os import PathLike

    from atm._atm import Rig

_COLUMNS = ("t", "sensor", "range", "x", "y", "yaw")


def fuse_table(table: Any, *, rig: Rig | str | PathLike[str], **options: Any) -> Any:
    """Turn a table of readings into a table of echoes.

    For frames of any library, and for mapping over a fleet's logs with Spark, Ray or Dask.

    Parameters
    ----------
    table : object with ``__arrow_c_stream__`` or ``__arrow_c_array__``, or pyarrow.Table
        Readings in order of time: the columns ``t`` (float seconds, int nanoseconds, or timestamps), ``sensor`` (strings,
        dictionary-encoded ones too, or ints as in :func:`fuse`), ``range``, ``x``, ``y`` (metres) and ``yaw`` (radians). Further
        columns are ignored. Null in ``range`` is a reading without an echo; elsewhere it is refused.
    rig : Rig or str or os.PathLike
        The sensors, as in :func:`fuse`.
    **options
        Options of :func:`fuse`, `sensor_index` aside.

    Returns
    -------
    pyarrow.Table
        The fields of :func:`fuse` as columns; ``t`` of the type it had.

    Raises
    ------
    ImportError
        pyarrow is missing: it comes with ``pip install atm-py[arrow]``.
    ValueError, TypeError
        A column is missing, or as :func:`fuse`.

    Notes
    -----
    Columns of one chunk without nulls are read in place where they are float64.

    Examples
    --------
    >>> import atm, pyarrow as pa
    >>> readings = pa.table({"t": [0.0, 0.1], "sensor": ["0", "0"], "range": [2.5, None],
    ...                      "x": [0.0, 0.1], "y": [0.0, 0.0], "yaw": [0.0, 0.0]})
    >>> atm.fuse_table(readings, rig="nomad200")["kind"].to_pylist()
    ['center']
    """
    try:
        import pyarrow as pa  # type: ignore[import-untyped, import-not-found, unused-ignore]
    except ImportError as error:
        raise ImportError("fuse_table needs pyarrow: pip install 'atm-py[arrow]'") from error

    readings = pa.table(table)
    for name in _COLUMNS:
        if readings.column_names.count(name) != 1:
            count = readings.column_names.count(name)
            raise ValueError(f"table: {count} columns {name!r}, expected one; there are {readings.column_names}")
    time_type = readings.schema.field("t").type
    if pa.types.is_timestamp(time_type):
        options["t_unit"] = "ns"
    arrays = {name: _array(readings[name], name) for name in _COLUMNS}
    echoes = fuse(
        arrays["t"], arrays["sensor"], arrays["range"], arrays["x"], arrays["y"], arrays["yaw"], rig=rig, **options
    )
    columns = {name: pa.array(np.ascontiguousarray(echoes[name])) for name in echoes.dtype.names or ()}
    if pa.types.is_timestamp(time_type):
        nanoseconds = pa.timestamp("ns", tz=time_type.tz)
        columns["t"] = columns["t"].cast(nanoseconds)
    return pa.table(columns)


def _array(column: Any, name: str) -> np.ndarray[Any, Any]:
    """One column as numpy has it, in place where it can be."""
    try:
        import pyarrow as pa  # type: ignore[import-untyped, import-not-found, unused-ignore]
    except ImportError as error:
        raise ImportError("fuse_table needs pyarrow: pip install 'atm-py[arrow]'") from error
    import pyarrow.compute as pc  # type: ignore[import-untyped, import-not-found, unused-ignore]

    if pa.types.is_timestamp(column.type):
        column = column.cast(pa.timestamp("ns", tz=column.type.tz)).cast(pa.int64())
    if column.null_count and name == "range":
        column = pc.fill_null(column.cast(pa.float64()), float("nan"))
    elif column.null_count:
        index = pc.index(pc.is_null(column), True).as_py()
        raise ValueError(f"{name}[{index}]: is null")
    if pa.types.is_dictionary(column.type):
        column = column.unify_dictionaries()
    whole = column.chunk(0) if column.num_chunks == 1 else column.combine_chunks()
    if isinstance(whole, pa.DictionaryArray):
        decoded: np.ndarray[Any, Any] = np.asarray(whole.dictionary.to_pylist())[whole.indices.to_numpy()]
        return decoded
    items: np.ndarray[Any, Any] = whole.to_numpy(zero_copy_only=False)
    return items
