"""Every plot is a function from a result and a theme to a Bokeh figure, for the page, a file or a notebook.

Each plot has its own module with a function of the same name; the figures of the paper are in paper/. `theme.THEMES`
has the themes, and `file.html_of` makes a page that needs no server and no network. Next to a plot's function are
those for the data that a page adds as a computation proceeds: `branches.BranchRows`, `parameter_map.cell_rows`. The
dashboard has its own drawing code for two plots, because they follow every knob and are updated in place: the main
picture (app/parts/time_figures; `motion` for files) and the resonance curve (app/curve/view.py; `curve` for files).
"""
