"""Sources to cite for a scene: the software, the model's paper, and the sources of its damping law and effects."""

from __future__ import annotations

from ..version import __version__
from .description import Description
from .effects import effects_of
from .laws import LAWS

_SOFTWARE = f"The granchain authors. granchain: driven granular chains, simulated to a stated accuracy, {__version__}."
_PAPER = ("Y. Zhang, D. Pozharskiy, D. M. McFarland, P. G. Kevrekidis, I. G. Kevrekidis, A. F. Vakakis. Experimental "
          "Study of Nonlinear Resonances and Anti-resonances in a Forced, Ordered Granular Chain. arXiv:1606.09305 "
          "(2016).")
_HERTZ = "H. Hertz. Ueber die Berührung fester elastischer Körper. J. reine angew. Math. 92, 156–171 (1882)."
_NESTERENKO = ("V. F. Nesterenko. Propagation of nonlinear compression pulses in granular media. J. Appl. Mech. Tech. "
               "Phys. 24, 733–743 (1983).")
_DIMERS = ("K. R. Jayaprakash, Y. Starosvetsky, A. F. Vakakis. New family of solitary waves in granular dimer chains "
           "with no precompression. Phys. Rev. E 83, 036606 (2011).")
_TRAINS = ("S. Job, F. Melo, A. Sokolow, S. Sen. Solitary wave trains in granular chains: experiments, theory and "
           "simulations. Granular Matter 10, 13–20 (2007).")
_IMPURITY = ("E. Hascoët, H. J. Herrmann. Shocks in non-loaded bead chains with impurities. Eur. Phys. J. B 14, "
             "183–190 (2000).")
_TAPER = "S. Sen, F. S. Manciu, M. Manciu. Thermalizing an impulse. Physica A 299, 551–558 (2001)."
_PRECOMPRESSED = "V. F. Nesterenko. Dynamics of Heterogeneous Materials. Springer, New York (2001)."
_DIODE = ("N. Boechler, G. Theocharis, C. Daraio. Bifurcation-based acoustic switching and rectification. Nature "
          "Materials 10, 665–668 (2011).")
_BREATHERS = ("C. Chong, F. Li, J. Yang, M. O. Williams, I. G. Kevrekidis, P. G. Kevrekidis, C. Daraio. Damped-driven "
              "granular chains: an ideal playground for dark breathers and multibreathers. Phys. Rev. E 89, 032924 "
              "(2014).")


def citations(scene: Description) -> list[tuple[str, str]]:
    """Return subjects and the sources to cite for them: the model and the effects of a scene."""
    sources = [("software", _SOFTWARE), ("model", _PAPER), ("contact", _HERTZ)]
    if scene.has_dissipation and LAWS[scene.dissipation].source:
        sources.append((f"{scene.dissipation} damping", LAWS[scene.dissipation].source))
    sources += [(effect.title, effect.source) for effect in effects_of(scene) if effect.source]
    if not scene.is_driven and scene.F0 == 0.0:
        sources.append(("solitary wave", _NESTERENKO))
    if scene.dimer != 1.0:
        sources.append(("dimers", _DIMERS))
    if scene.taper != 1.0:
        sources.append(("tapered chains", _TAPER))
    if scene.F0 > 0.0:
        sources.append(("precompressed chains", _PRECOMPRESSED))
    impurity = scene.impurity != 1.0 and scene.site <= scene.N
    if not scene.is_driven and scene.striker > 1.0 and scene.end == "first":  # otherwise the heavy bead is at the wall
        sources.append(("pulse trains", _TRAINS))
    if not scene.is_driven and impurity:
        sources.append(("impurities", _IMPURITY))
    if scene.is_driven and scene.F0 > 0.0 and impurity:
        sources.append(("acoustic diode", _DIODE))
    if scene.name == "breather":
        sources.append(("dark breathers", _BREATHERS))
    return sources
