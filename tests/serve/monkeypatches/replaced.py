"""The functions of Bokeh that `install_defaults_cache` replaces, with Bokeh's originals."""

from __future__ import annotations

import bokeh.model.util as references
from bokeh.core.has_props import HasProps
from bokeh.core.property.descriptors import PropertyDescriptor

REPLACED = ((PropertyDescriptor, "_get_default"), (PropertyDescriptor, "has_unstable_default"),
            (HasProps, "themed_values"), (HasProps, "_overridden_defaults"), (HasProps, "query_properties_with_values"),
            (references, "visit_immediate_value_references"))
#: The originals, taken before any test runs.
OWN = [(where, name, vars(where)[name]) for where, name in REPLACED]
