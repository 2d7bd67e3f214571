"""Declarations of keys for files and for classes: kind and meaning of each value.

    RUN = {"replicas": count("independent runs within the point's job", default=1)}
    radius: float = field(metadata=declared(positive("radius of a particle")))

A config is compared with the schemas of its keys (`require`). When an instance of a class is made, by a
program or from a file, the class applies the check of each field (`validate`). Messages, the schemas for
editors, the options of the command line and the reference page are derived from the declarations. Rules that
concern several keys are implemented in the class.
"""

from gaspart.public import attach as _attach

__getattr__, __dir__, __all__ = _attach(__name__)
