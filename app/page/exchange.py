"""What leaves and enters the page: share links, saved pictures, the visitor's measurements."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from granchain_core import BadInput
from granchain_core.experiment import read_measured_csv
from granchain_core.store import save

from ..pages.curve.page import Curves
from .layout import Views
from .pictures import Pictures
from .session import Session

_LARGEST_CSV = 2_000_000


class Exchange:
    """Actions of the page that deal with links and files."""

    def __init__(self, session: Session, views: Views, curves: Curves, pictures: Pictures) -> None:
        self._session = session
        self._views = views
        self._curves = curves
        self._pictures = pictures
        self.actions: dict[str, Callable[[dict[str, Any]], None]] = {
            "share": self._share, "save": self._save, "csv": self._csv,
            "csv-too-large": self._too_large, "csv-remove": self._remove,
        }

    def _share(self, _: dict[str, Any]) -> None:
        self._views.header.tell(type="link", query=self._session.link)

    def _save(self, _: dict[str, Any]) -> None:
        run = self._pictures.run()
        if run is None:
            raise BadInput("There is no picture to save yet; wait for the first one.")
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "picture.h5"
            save(run, path)
            content = path.read_bytes()
        scene = run.scene
        self._views.header.tell(type="file", name=f"{scene.name}-{scene.f:g}Hz.h5", content=content)

    def _csv(self, message: dict[str, Any]) -> None:
        text = message.get("text")
        if not isinstance(text, str):
            raise BadInput("The measurement must be the text of a CSV file: frequency, force, optional error.")
        if len(text) > _LARGEST_CSV:
            self._too_large(message)
        measured = read_measured_csv(text)
        self._curves.measured(measured)
        name = str(message.get("name", "data"))[:60]
        self._views.corner.display(understood=f"{name}: {measured.understood}")

    def _too_large(self, _: dict[str, Any]) -> None:
        raise BadInput("The measurement is larger than 2 MB; a curve of frequency and force needs a few kB.")

    def _remove(self, _: dict[str, Any]) -> None:
        self._curves.measured(None)
        self._views.corner.display(understood="")
