"""Declaration of keys, once for files and for classes: kind and meaning of each value.

    RUN = {"replicas": count("independent runs within the point's job", default=1)}
    radius: float = field(metadata=declared(positive("radius of a particle")))

A config is compared with the schemas of its keys (`require`). A class applies the check of each field when an
instance is made, by a program or from a file (`validate`). Messages, the schemas for editors, the options of
the command line and the reference page follow from the declarations. Rules that concern several keys are code
of the class.
"""

from gaspart.public import attach as _attach

__getattr__, __dir__, __all__ = _attach(__name__)
