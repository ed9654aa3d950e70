"""Share links, saved pictures and the visitor's own measurements."""

from __future__ import annotations

import tempfile
from functools import partial
from pathlib import Path
from typing import Any

from granchain_core import BadInput, Run
from granchain_core.experiment import Measured, read_measured_csv
from granchain_core.experiment.measured import MOST_BYTES
from granchain_core.store import save

from ..pages.curve.page import Curves
from ..serve.queues import FILES
from ..session.hooks import Actions
from ..session.host import Host
from ..session.task import Job, Task
from .layout import Views
from .main_picture import Pictures


class LinksAndFiles:
    """Actions of the page that deal with links and files; files are written and read in the background."""

    def __init__(self, host: Host, views: Views, curves: Curves, pictures: Pictures) -> None:
        self._host = host
        self._views = views
        self._curves = curves
        self._pictures = pictures
        self._saving = Task(host, FILES, _say_nothing, "Saving the picture", host.failed)
        self._reading = Task(host, FILES, _say_nothing, "Reading the measurement", host.failed)
        self.actions: Actions = {
            "share": self._share, "save": self._save, "csv": self._csv,
            "csv-too-large": self._too_large, "csv-remove": self._remove,
        }

    def close(self) -> None:
        """The visitor left."""
        self._saving.cancel()
        self._reading.cancel()

    def _share(self, _: dict[str, Any]) -> None:
        self._views.header.send(type="link", query=self._host.session.link)

    def _save(self, _: dict[str, Any]) -> None:
        run = self._pictures.run()
        if run is None:
            raise BadInput("There is no picture to save yet; wait for the first one.")
        self._saving.start(partial(self._write, run))

    def _write(self, run: Run, job: Job) -> None:
        """In a worker thread: write the file in a temporary folder and send its content."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "picture.h5"
            save(run, path)
            content = path.read_bytes()
        name = f"{run.scene.name}-{run.scene.f:g}Hz.h5"
        job.next_tick(self._views.header.send, type="file", name=name, content=content)

    def _csv(self, message: dict[str, Any]) -> None:
        text = message.get("text")
        if not isinstance(text, str):
            raise BadInput("The measurement must be the text of a CSV file: frequency, force, optional error.")
        self._reading.start(partial(self._read, str(message.get("name", "data"))[:60], text))

    def _read(self, name: str, text: str, job: Job) -> None:
        """In a worker thread: read the file. A `BadInput` names the line that cannot be read."""
        job.next_tick(self._show, name, read_measured_csv(text))

    def _show(self, name: str, measured: Measured) -> None:
        self._curves.measured(measured)
        self._views.tabs.update_state(understood=f"{name}: {measured.understood}")

    def _too_large(self, _: dict[str, Any]) -> None:
        raise BadInput(f"The measurement is larger than {MOST_BYTES / 1e6:g} MB; a curve of frequency and force needs "
                       "a few kB.")

    def _remove(self, _: dict[str, Any]) -> None:
        self._reading.cancel()
        self._curves.measured(None)
        self._views.tabs.update_state(understood="")


def _say_nothing(status: str, sentence: str) -> None:
    """Show no status: a finished file speaks for itself, and the host reports failures."""
