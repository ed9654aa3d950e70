"""The output of --explain: effects compiled in, absent effects, the method and why it is used, the machine."""

from __future__ import annotations

from granchain_core.integrate.fixed import chain_width
from granchain_core.integrate.methods import METHODS, method_for, setting_of
from granchain_core.integrate.scaling import scale_chain, slots_of
from granchain_core.kernels.batch_size import machine
from granchain_core.precompile.warm import structure
from granchain_core.scene import Scene


def explanation(scene: Scene, method: str | None, samples: int) -> str:
    """Describe the kernel's slots, the method and the machine of a run; `samples` per period may set its steps."""
    scaled = scale_chain(scene)
    slots = slots_of(scene, account=True)
    present = [f"{title} ({kind})" for _, title, kind in slots if kind is not None]
    absent = [title for _, title, kind in slots if kind is None]
    setting = method_for(scene.accuracy, scene.cuts_tension) if method is None else setting_of(method, scene.accuracy)
    chosen = METHODS[setting.method]
    why = "asked for by --method" if method else f"chosen for an accuracy of {scene.accuracy:g}"
    resolution = (f"tolerance per step {setting.tolerance:.1e}" if chosen.error_control
                else f"{setting.steps_per_period(scaled, samples)} steps per period")
    return "\n".join((
        f"compiled in: {', '.join(present)}",
        f"absent, with no code and no array: {', '.join(absent) if absent else 'nothing'}",
        f"structure: {structure(scene)}",
        *(["steps: scalar code, because a run keeps the energy account; pictures and curves use vectors"]
          if chain_width(scaled) and not chosen.error_control else []),
        f"method: {chosen.title}, {why}; first {resolution}, finer until the stated error is at most that accuracy",
        f"restrictions: {chosen.restrictions}; reference: {chosen.reference}",
        f"machine: {machine()}",
    ))
