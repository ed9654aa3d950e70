"""Quantities of a measurement, their units in SI, and the words that denote them in headers."""

from __future__ import annotations

import math
import re

from ..inputs.text import number_in

#: Standard gravity [m/s²], and so a kilogram-force [N] (BIPM, The International System of Units, 2019).
_GRAVITY = 9.80665
#: Pound-force [N]: 0.45359237 kg times standard gravity.
_POUND = 4.4482216152605
#: Units by dimension, the SI unit first, with the factor to SI.
UNITS: dict[str, dict[str, float]] = {
    "frequency": {"Hz": 1.0, "kHz": 1e3, "MHz": 1e6, "rad/s": 1.0 / (2.0 * math.pi), "rpm": 1.0 / 60.0},
    "time": {"s": 1.0, "ms": 1e-3, "µs": 1e-6},
    "force": {"N": 1.0, "mN": 1e-3, "µN": 1e-6, "kN": 1e3, "lbf": _POUND, "kgf": _GRAVITY},
    "velocity": {"m/s": 1.0, "mm/s": 1e-3, "µm/s": 1e-6, "cm/s": 1e-2},
    "displacement": {"m": 1.0, "mm": 1e-3, "µm": 1e-6, "nm": 1e-9, "cm": 1e-2},
    "acceleration": {"m/s²": 1.0, "mm/s²": 1e-3, "g": _GRAVITY},
}
#: Units of voltage: a column in volts needs the sensitivity of its sensor.
VOLTS = {"V": 1.0, "mV": 1e-3}
#: Quantities in a file, with the dimension of each. A curve's force is the largest output force.
QUANTITIES = {"frequency": "frequency", "force": "force", "error": "force", "time": "time", "velocity": "velocity",
              "displacement": "displacement", "acceleration": "acceleration", "input_force": "force",
              "output_force": "force"}
#: Short names of quantities in options.
SHORT = {"f": "frequency", "F": "force", "t": "time", "v": "velocity", "u": "displacement", "A0": "displacement",
         "a": "acceleration", "Fin": "input_force", "Fout": "output_force", "sigma": "error"}
_NAMES = {
    "frequency": "f freq frequency drive_frequency driving_frequency excitation_frequency frequenz fréquence frequence",
    "force": "force peak_force max_force maximum_force max_output_force largest_output_force transmitted_force "
             "max_transmitted_force maximum_transmitted_force kraft",
    "error": "error err uncertainty sigma std sd stdev standard_deviation force_error error_force force_std force_sd "
             "std_force fehler",
    "time": "t time zeit temps",
    "velocity": "v v0 velocity speed shaker_velocity geschwindigkeit vitesse",
    "displacement": "a0 u0 amplitude displacement shaker_displacement drive_displacement weg auslenkung",
    "acceleration": "acceleration accel shaker_acceleration beschleunigung",
    "input_force": "input_force in_force force_in f_in fin max_input_force",
    "output_force": "output_force out_force force_out f_out fout",
}
#: Names of quantities if the unit is one of force; in a shaker's file, "input" and "output" may mean anything else.
_OF_FORCE = {"input": "input_force", "in": "input_force", "output": "output_force", "out": "output_force"}
_QUANTITY = {name: quantity for quantity, names in _NAMES.items() for name in names.split()}
_ALIASES = {
    "hz": "Hz", "HZ": "Hz", "hertz": "Hz", "1/s": "Hz", "s-1": "Hz", "khz": "kHz", "KHz": "kHz", "RPM": "rpm",
    "sec": "s", "seconds": "s", "msec": "ms", "us": "µs", "n": "N", "newton": "N", "newtons": "N", "mn": "mN",
    "kn": "kN", "un": "µN", "uN": "µN", "volt": "V", "volts": "V", "m_s": "m/s", "ms-1": "m/s", "mm_s": "mm/s",
    "mms-1": "mm/s", "cm_s": "cm/s", "um_s": "µm/s", "um/s": "µm/s", "µm_s": "µm/s", "um": "µm", "micron": "µm",
    "microns": "µm", "m/s2": "m/s²", "m/s^2": "m/s²", "m_s2": "m/s²", "ms-2": "m/s²", "mm/s2": "mm/s²", "gn": "g",
    "g_n": "g",
}
_SENSITIVITY = re.compile(r"([0-9.eE+-]+)\s*(m?V)\s*/\s*(.+)")


def unit_named(text: str) -> str | None:
    """Return the unit that a text denotes, spelled as in `UNITS` or `VOLTS`; None if it is none of them.

    Case matters: mN is not MN, and an unknown unit is never taken for a similar one.
    """
    plain = re.sub(r"[\s·*]", "", text.replace("μ", "µ").replace("⁻¹", "-1").replace("⁻²", "-2").replace("^2", "2"))
    plain = plain.strip(".")
    known = {**VOLTS, **{unit: 1.0 for units in UNITS.values() for unit in units}}
    return plain if plain in known else _ALIASES.get(plain)


def dimension_of(unit: str) -> str:
    """Return the dimension of a unit, "voltage" for volts."""
    return next((name for name, units in UNITS.items() if unit in units), "voltage")


def factor_of(quantity: str, unit: str, column: str | None = None) -> float | None:
    """Return the factor that converts a column's numbers to SI; None if `unit` is not a unit of the quantity.

    A sensitivity such as 2.248V/kN is accepted as a unit too, for a column in volts or in the unit `column` (e.g. mV).
    """
    factor = UNITS[QUANTITIES[quantity]].get(unit_named(unit) or "")
    sensitivity = _SENSITIVITY.fullmatch(unit.strip())
    if factor is not None or sensitivity is None:
        return factor
    size, volt = number_in(sensitivity[1]), column if column in VOLTS else sensitivity[2]
    per = UNITS[QUANTITIES[quantity]].get(unit_named(sensitivity[3]) or "")
    if size is None or size <= 0.0 or per is None:
        return None
    return VOLTS[volt] / (size * VOLTS[sensitivity[2]]) * per


def heading(title: str) -> tuple[str | None, str | None, str]:
    """Return a column's quantity and unit from its title (None if the title does not give them), and its bare name.

    Understood: "Frequency (kHz)", "F [mN]", "f / Hz", "force, N", "time_ms", "velocity in mm/s", "Hz".
    """
    text = title.strip().strip('"').strip()
    if unit_named(text) is not None and _word(text) not in ("v", "n"):
        return None, unit_named(text), ""
    for pattern in (r"(.*?)\s*[(\[{<]\s*([^()\[\]{}<>]*?)\s*[)\]}>]\s*", r"(.*?)\s*,\s*([^,]+)", r"(.*?)\s+in\s+(\S.*)",
                    r"(.*?)\s*/\s*(\S.*)", r"(.*)[_\s]([^_\s]+[_/][^_\s]+)", r"(.*)[_\s]([^_\s]+)"):
        match = re.fullmatch(pattern, text)
        unit = unit_named(match[2]) if match else None
        if match and unit is not None and match[1]:
            return _quantity(match[1], unit), unit, _word(match[1])
    strange = bracketed_unit(text)
    if strange is not None:
        bare = text[: text.rfind(strange) - 1].strip()
        return "force" if bare == "F" else _quantity(bare, None), None, _word(bare)
    return _quantity(text, None), None, _word(text)


def bracketed_unit(title: str) -> str | None:
    """Return the text in brackets at the end of a title, whether or not it is a known unit."""
    match = re.fullmatch(r".*[(\[]\s*([^()\[\]]+?)\s*[)\]]\s*", title.strip())
    return match[1] if match else None


def _word(text: str) -> str:
    return re.sub(r"[^a-zàâéèêîôûäöüß0-9µ]+", "_", text.lower()).strip("_")


def _quantity(name: str, unit: str | None) -> str | None:
    """Return the quantity that a name denotes; a unit's dimension decides between f and F, or contradicts the name."""
    bare = name.strip()
    dimension = None if unit is None else dimension_of(unit)
    if bare in ("f", "F"):
        if dimension in ("frequency", "force", "voltage"):
            return "force" if dimension == "voltage" else dimension
        return "frequency" if bare == "f" and unit is None else None
    if len(bare) == 1 and bare.isupper():  # T may be a temperature, V a voltage
        return None
    word = _word(bare)
    known = {**_QUANTITY, **_OF_FORCE} if dimension == "force" else _QUANTITY
    quantity = known.get(word) or known.get(re.sub(r"_?\d+$", "", word))
    if quantity is None or dimension in (None, "voltage", QUANTITIES[quantity]):
        return quantity
    return dimension if word == "amplitude" and dimension in ("velocity", "acceleration", "force") else None
