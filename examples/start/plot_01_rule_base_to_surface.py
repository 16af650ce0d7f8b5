"""
What does one cell of the table do?
===================================

A rule base is a table of words. Its control surface shows the numbers that follow from them: load a
table, look at its surface, change one cell, and look again.
"""

# %%
# Load a rule base that comes with fuzzytrack. The inputs are the error of a prediction and
# its change; the outputs are the stiffness and the damping of the filter.
import fuzzytrack as ft
from fuzzytrack.fuzzy.rule_edits import set_cell
from fuzzytrack.fuzzy.saving import dumps_rulebase

rules = ft.load_rulebase("stiffness-damping")
text = dumps_rulebase(rules)
print(text[text.index("rules:") :])

# %%
# The words are fuzzy sets. They are narrow near zero, to distinguish small errors.
ft.plot_memberships(rules)

# %%
# From words to numbers: along E = ze every cell is L-L, large stiffness and large damping, which
# gives the ridge.
ft.plot_surface(rules)

# %%
# Now one cell: where there is no error and no change of it, write Z-Z instead of L-L. Only the text
# of that cell changes.
edited = ft.loads_rulebase(set_cell(text, {"E": "ze", "dE": "ze"}, "Z-Z"))
for name in ("before", "after"):
    system = ft.FuzzySystem(rules if name == "before" else edited)
    values = system(E=0.0, dE=0.0)
    print(f"{name:6}  stiffness {values['stiffness']:.3f}  damping {values['damping']:.3f}")

# %%
# The ridge has a notch, as wide as the sets of that cell and no wider.
ft.plot_surface(edited, style="contour")
# sphinx_gallery_thumbnail_number = 2
