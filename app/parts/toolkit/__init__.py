"""What parts and pages are made of: the base class of components; elements, controls and small drawings in the
browser.
"""
