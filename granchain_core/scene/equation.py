"""The equation of motion on screen, built from the same facts that pick the compiled kernel."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .description import Scene

_DAMPING = {
    "linear": r"D\,\dot\delta_j\,H(\delta_j)",
    "tsuji": r"D\,(\delta_j/\delta_r)_+^{1/4}\,\dot\delta_j",
    "kuwabara-kono": r"D\,(\delta_j/\delta_r)_+^{1/2}\,\dot\delta_j",
}


def latex(scene: Scene) -> str:
    """Motion, contact force, overlap and driver of `scene` (Zhang et al. 2016, eqs. 1, 3 and 5), active terms only."""
    masses = len(set(scene.beads)) > 1
    stiffness = "K_j" if masses or scene.wall_factor != 1.0 else "K"
    motion = ("m_i" if masses else "m") + r"\,\ddot u_i = F_{i-1} - F_i"
    if scene.k > 0:
        motion += r" - k\,u_i"
    force = stiffness + r"\,[\delta_j]_+^{3/2}"
    if scene.has_dissipation:
        force += " + " + _DAMPING[scene.dissipation]
        if scene.tension == "cut":
            force = r"\max\left(0,\; " + force + r"\right)"
    overlap = r"u_j - u_{j+1}" + (r" + (F_0/" + stiffness + ")^{2/3}" if scene.F0 > 0 else "")
    return (motion + r",\qquad F_j = " + force + r",\qquad \delta_j = " + overlap
            + r",\qquad u_0 = A_0\sin 2\pi f t,\quad u_{N+1} = 0")
