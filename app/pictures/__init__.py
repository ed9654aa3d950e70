"""Every picture as a function from a result to a Bokeh figure: the same for the page, a file and a notebook."""
