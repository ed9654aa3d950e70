"""`save`, which writes any result."""

from __future__ import annotations

from pathlib import Path

import h5py

from ..errors import BadInput
from ..experiment import Measured, Series
from ..orbits import Branch
from ..tables import Labelled
from .branches import write_branch
from .measured import write_measured
from .writing import write_file, write_result


def save(result: Labelled, path: str | Path, measured: Measured | Series | None = None) -> Path:
    """Write a result to an HDF5 file with labelled axes and units (docs/result-files.md).

    Parameters
    ----------
    result : Run, Curve, Orbit, Branch, ParameterMap, Observation, Fit or any other result
        A result returned by one of granchain's functions.
    path : str or pathlib.Path
        The file. An existing file is replaced once the new one is complete.
    measured : Measured or Series, optional
        A measurement to be kept with it (`granchain_core.experiment.read_experiment`), in the group `measured`.

    Returns
    -------
    pathlib.Path
        The file.

    Raises
    ------
    BadInput
        It is not a result, or the file cannot be written.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> from granchain_core import load, run, save, scene
    >>> result = run(scene("sec2").evolve(N=2, f=2000.0), periods=0, record=1, samples=8)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     again = load(save(result, pathlib.Path(folder) / "run.h5"))
    >>> bool((again.displacement == result.displacement).all())
    True
    """
    if not isinstance(result, Labelled):
        raise BadInput("`save` writes a result of granchain, for example of `run`, not a value of type "
                       f"{type(result).__name__}.")

    def write(file: h5py.File) -> None:
        if isinstance(result, Branch):
            write_branch(file, result)
        else:
            write_result(file, result)
        if measured is not None:
            write_measured(file, measured)

    return write_file(path, write)
