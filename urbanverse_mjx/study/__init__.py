"""User studies of scenes: a static page for participants, the analysis of their answers, and tests of layouts that need
no people."""

from .agreement import fleiss_kappa
from .analysis import analyse
from .answers import Answer, read_answers
from .layouts import StreetLayout, compare, layout_of_graph, layout_of_scene
from .page import write_page
from .plan import Material, StudyPlan, Trial, plan_study

__all__ = [
    "Answer",
    "Material",
    "StreetLayout",
    "StudyPlan",
    "Trial",
    "analyse",
    "compare",
    "fleiss_kappa",
    "layout_of_graph",
    "layout_of_scene",
    "plan_study",
    "read_answers",
    "write_page",
]
