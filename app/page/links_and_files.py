"""Share links and saved pictures; the visitor's own measurements are in measurement.py."""

from __future__ import annotations

import tempfile
from functools import partial
from pathlib import Path
from typing import Any

from granchain_core import BadInput, Run
from granchain_core.store import save

from ..pages.curve.page import Curves
from ..serve.queues import FILES
from ..session.hooks import Actions
from ..session.host import Host
from ..session.task import Job, Task
from .layout import Views
from .main_picture import Pictures
from .measurement import Measurement


class LinksAndFiles:
    """Actions of the page that deal with links and files; files are written in the background."""

    def __init__(self, host: Host, views: Views, curves: Curves, pictures: Pictures) -> None:
        self._host = host
        self._views = views
        self._pictures = pictures
        self._saving = Task(host, FILES, _say_nothing, "Saving the picture", host.failed)
        self._measurement = Measurement(host, views.tabs, curves)
        self.actions: Actions = {"share": self._share, "save": self._save, **self._measurement.actions}

    def close(self) -> None:
        """The visitor left."""
        self._saving.cancel()
        self._measurement.close()

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


def _say_nothing(status: str, sentence: str) -> None:
    """Show no status: a finished file speaks for itself, and the host reports failures."""
