"""The paper's comparison, measured again: ``pondhop bench paper``.

In reading order:

- `printed`: what the paper prints, number by number.
- `methods`: which planners take part and what a farm is expected to cost them.
- `scope`: on which farms, and how many of them a planner gets that is slow.
- `study`: the runs that this asks for, and their execution; whatever stops it, a later start goes on from there.
- `tables`: the rows of the tables, and their CSV files.
- `maps`, `charts`: the pictures, light and dark.
- `wording`: the tables as Markdown, and numbers as words.
- `page`: the Markdown page from `report.md.jinja`, and the same as one HTML file that needs no other.
"""
