"""Declarations of keys of files and of fields of classes: kind and meaning of each value.

    RUN = {"replicas": count("independent runs within the point's job", default=1)}
    radius: float = field(metadata=declared(positive("radius of a particle")))

The function `require` compares a config with the schemas of its keys. When an instance of a class is created,
in Python code or from a file, the class applies the check of each field (`validate`). Messages, the schemas
for editors, the options of the command line and the reference page are derived from the declarations. Rules
that involve several keys are not declared, but implemented in the class.
"""

from gaspart.public import attach as _attach

__getattr__, __dir__, __all__ = _attach(__name__)
