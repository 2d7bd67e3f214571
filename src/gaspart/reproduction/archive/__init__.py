"""The archive of a finished run: a Workflow Run RO-Crate, and its verification.

The archive is a zip file. It has the project's sources, the config, the locked environment, figures,
captions, claims, and the data from which the figures and claims are made. It has the digests of the
trajectories or, on request, the trajectories themselves. Its layout is the layout of the project's folder, so
that the unpacked archive can be run. `ro-crate-metadata.json` describes the archive by the profile Workflow
Run Crate 0.5. `manifest-sha256.txt` has the digest of every file.
"""
