"""The share link, and files of the picture on the screen."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from granchain_core import BadInput, Run
from granchain_core.experiment import Measured, Series
from granchain_core.store import save

from ..curve.controller import CurveController
from ..serve.computing.worker_pools import FILES
from ..session.export import EXPORTS, TEXTS, ExportedPicture
from ..session.host import PageHost
from ..session.message_checks import check_choice
from ..session.page import Actions
from ..session.task import Job, Task, report_nothing
from .layout import Views
from .main_picture import MainPicture

_NONE = "There is no picture to save yet; wait for the first one."
_LIVE_IS_NO_SCRIPT = ("Only a settled picture can be exported as a script; a live run depends on when each knob moved. "
                      "Choose “settled”, or save the run as HDF5.")


class Exports:
    """Sends the share link and exported files; the files are written in the background."""

    def __init__(self, host: PageHost, views: Views, curves: CurveController, pictures: MainPicture) -> None:
        self._host = host
        self._views = views
        self._curves = curves
        self._pictures = pictures
        self._saving = Task(host, FILES, report_nothing, "Saving the picture", report_to_host=True)
        self.actions: Actions = {"share": self._share, "export": self._export}

    def _share(self, _: dict[str, Any]) -> None:
        """Send the link, and name the pins that do not fit into it."""
        self._views.header.send(type="link", query=self._host.session.link)
        if sentence := self._host.session.pins_left_out:
            raise BadInput(sentence)

    def _export(self, message: dict[str, Any]) -> None:
        what = check_choice("file to save", message.get("what", "hdf5"), EXPORTS)
        run = self._pictures.shown_run()
        if run is None:
            raise BadInput(_NONE)
        if what == "hdf5":
            self._write(".h5", partial(_hdf5, run, self._host.session.measured))
        else:
            end, text = TEXTS[what]
            picture = self._exported_picture(run, what)
            self._write(end, lambda: text(picture).encode())

    def _exported_picture(self, run: Run, what: str) -> ExportedPicture:
        session = self._host.session
        if what in ("script", "notebook"):
            if session.mode == "live":
                raise BadInput(_LIVE_IS_NO_SCRIPT)
            if session.settled is None or not session.settled.final or run.scene != session.scene:
                raise BadInput("The picture is still being computed; save it when the status line no longer says "
                               "“preview”.")
        curves = self._curves.complete(session.scene)
        if what == "curve" and not curves:
            raise BadInput("No resonance curve is complete yet; wait until its progress bar disappears.")
        return ExportedPicture(run, session.initial_state, curves, session.link)

    def _write(self, end: str, content: Callable[[], bytes]) -> None:
        scene = self._host.session.scene
        name = f"{scene.name}-{scene.f:g}Hz{end}"

        def work(job: Job) -> None:
            """Write the file in a worker thread."""
            job.next_tick(self._views.header.send, type="file", name=name, content=content())

        self._saving.start(work)


def _hdf5(run: Run, measured: Measured | Series | None) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.h5"
        save(run, path, measured)
        return path.read_bytes()
