"""What every part and page is made of: the base class of components, elements and controls."""
