"""The page on which a gas runs, for the first screen of the report."""

from _job import job

with job(snakemake):
    from gaspart.cli.new import templates
    from gaspart.errors import SceneError
    from gaspart.rendering.play import play
    from gaspart.scene.scene import Scene
    from gaspart.yaml_text import parse_yaml

    opening = snakemake.params.opening
    if opening not in templates():
        raise SceneError("opening", opening, "must be a scene of `gaspart new --list`")
    scene = Scene.from_dict(parse_yaml(templates()[opening].text))
    play(scene).save(snakemake.output[0], overwrite=True)
