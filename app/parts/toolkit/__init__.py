"""Building blocks of parts and pages: the base class of components, elements, controls and small drawings."""
