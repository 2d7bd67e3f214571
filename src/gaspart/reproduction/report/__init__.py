"""The report: one page of all figures, their claims and what they show.

`caption.py` divides a caption into its finding, how to read the figure, and the rest; `strip.py` places
claims on an axis of deviations; `references.py` links citations to the list of references; `page.py` fills
the template, `workflow/report/report.html.j2`, with them.
"""
