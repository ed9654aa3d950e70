"""Every plot as a function from a result and a theme to a Bokeh figure: for the page, a file and a notebook.

One module for each plot, with a function of its name; the figures of the paper are in paper/. `theme.THEMES` has
the themes; `file.html_of` makes a page that needs no server and no network. What a page adds to a figure as a
computation goes on comes from functions beside it: `branches.BranchRows`, `parameter_map.cell_rows`. The dashboard
draws two plots itself, because they follow every knob and are updated in place: the main picture
(app/parts/time_figures; `motion` for files) and the resonance curve (app/curve/view.py; `curve` for files).
"""
