"""Writing any result."""

from __future__ import annotations

from pathlib import Path

from ..orbits import Branch
from ..tables import Labelled
from .branches import save_branch
from .writing import write_file, write_result


def save(result: Labelled, path: str | Path) -> Path:
    """Write a result to an HDF5 file with labelled axes and units (README.md, "Files").

    Parameters
    ----------
    result : Run, Curve, Orbit, Branch, Diagram, Observation, Fit or any other result
        What a function of granchain returned.
    path : str or pathlib.Path
        The file; one that is there is replaced when the new one is complete.

    Returns
    -------
    pathlib.Path
        The file.

    Raises
    ------
    BadInput
        It cannot be written.

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
    if isinstance(result, Branch):
        return save_branch(result, path)
    return write_file(path, lambda file: write_result(file, result))
