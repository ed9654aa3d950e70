"""An independent computation of the largest forces, with which granchain's stated errors are checked."""
