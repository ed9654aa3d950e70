"""The stored cases: two parameter sets in SI units, and their variations."""

from dataclasses import replace

from ref_scene import Scene

SEC2 = Scene(
    name="sec2", mass=28.84e-3, young=193e9, poisson=0.3, radius=9.525e-3, damping=100.0, amplitude=5e-7,
    frequency=340.0, periods=20, beads=11, kappa=0.0, wall=1.0,
)  # fmt: skip

RIG = Scene(
    name="rig", mass=67.355e-3, young=210e9, poisson=0.3, radius=12.7e-3, damping=35.4, amplitude=7e-6,
    frequency=60.0, periods=20, beads=11, kappa=0.001, wall=2**0.5,
)  # fmt: skip

BASES = {"sec2": SEC2, "rig": RIG}


def stored_cases() -> list[Scene]:
    """Return all cases of reference.npz."""
    out = []
    for f in (340.0, 500.0, 1130.0):
        out.append(replace(SEC2, name=f"sec2-{f:.0f}", frequency=f))
        out.append(replace(SEC2, name=f"sec2-{f:.0f}-founded", frequency=f, kappa=0.001))
    out.append(replace(RIG, name="rig-60"))
    short = replace(SEC2, periods=5)
    out += [
        replace(short, name="sec2-340-tsuji", law="tsuji"),
        replace(short, name="sec2-340-kuwabara-kono", law="kuwabara-kono"),
        replace(short, name="sec2-340-none", law="none", damping=0.0),
        replace(short, name="sec2-340-cut", tension="cut"),
        replace(short, name="sec2-340-preload", preload=5.0),
        replace(short, name="sec2-340-preload-light", preload=0.5),
        replace(short, name="sec2-340-rigid-wall", wall=2 * 2**0.5),
    ]
    return out
