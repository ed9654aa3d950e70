"""A request for a curve: one object for the computation, its checkpoints and the finished file."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

from ...execution.checkpoints import digest_of
from ...scene import Amplitude, Scene
from .curve import Curve
from .resonance_curve import resonance_curve


@dataclass(frozen=True)
class CurveRequest:
    """The arguments of `resonance_curve` that change the points of a curve.

    A new field enters the digest and the computation automatically; its default must reproduce earlier curves.
    """

    scene: Scene
    frequencies: tuple[float, ...]
    start: str = "rest"
    amplitude: Amplitude | None = None

    @classmethod
    def answered_by(cls, curve: Curve) -> CurveRequest:
        """The request that a curve answers."""
        settings = {field.name: getattr(curve, field.name) for field in fields(cls) if field.name != "frequencies"}
        return cls(frequencies=tuple(curve.column("frequency").tolist()), **settings)

    @property
    def digest(self) -> str:
        """Hash of all fields; the scene's own frequency is ignored, and later fields are left out at their defaults."""
        hashed: dict[str, Any] = {
            "scene": self.scene.evolve(f=self.frequencies[0]).digest, "frequencies": self.frequencies,
            "start": self.start}
        if self.amplitude is not None:
            hashed["amplitudes"] = [self.amplitude.at(f) for f in self.frequencies]
        others = {field.name: getattr(self, field.name) for field in fields(self)
                  if field.name not in ("scene", "frequencies", "start", "amplitude")
                  and getattr(self, field.name) != field.default}
        return digest_of({**hashed, **others})

    def compute(self, **how: Any) -> Curve:
        """The curve; `how` are the arguments of `resonance_curve` that do not change it."""
        return resonance_curve(**{field.name: getattr(self, field.name) for field in fields(self)}, **how)
