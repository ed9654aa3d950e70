"""Every picture as a function from a result and a theme to a Bokeh figure: for the page, a file and a notebook.

accuracy, branches, check, curve, diagram, multipliers, naive_forces, observation, observer, section: one module each,
with a function of that name. `theme.THEMES` has the themes; `file.page_of` makes a page that needs no server and no
network. What a page adds to a figure as a computation goes on comes from functions beside it: `branches.BranchRows`,
`diagram.cell_rows`. The dashboard's own resonance curve is redrawn while a knob moves; it is in
app/pages/curve/view.py.
"""
