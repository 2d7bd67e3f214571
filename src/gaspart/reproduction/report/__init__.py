"""The report: one page with all figures, their claims and captions.

`page.py` divides a caption into its finding, the instructions to read the figure, and details. It places
claims on an axis of deviations, and fills the template `workflow/report/report.html.j2`. `explore.py` has the
choices of a reader on the page, and links citations to the list of references.
"""
