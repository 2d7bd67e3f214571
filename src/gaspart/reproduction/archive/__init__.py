"""The archive of a finished run: a Workflow Run RO-Crate, and its verification.

A zip file of the project's sources, the config, the locked environment, figures, captions, claims and the
data that these are made of; of trajectories the digests, or on request the files. It has the layout of the
project's folder, so that, unpacked, it can be run. `ro-crate-metadata.json` describes it by the profile
Workflow Run Crate 0.5, and `manifest-sha256.txt` has the digest of every file.
"""
