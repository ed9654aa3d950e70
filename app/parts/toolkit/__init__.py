"""What parts and pages are made of: the base class of components, elements, controls, small drawings."""
