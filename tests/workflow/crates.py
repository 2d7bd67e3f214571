"""The public validator of RO-Crates, without the network.

Its profiles are part of the package roc-validator. The two JSON-LD contexts to which a crate refers by their
addresses it finds in a cache of requests, made of the files in contexts/.
"""

from pathlib import Path

from requests import Request
from requests_cache import CachedRequest, CachedResponse, CachedSession
from rocrate_validator import services
from rocrate_validator.models import Severity, ValidationSettings

CONTEXTS = {
    "https://w3id.org/ro/crate/1.1/context": "ro-crate-1.1.jsonld",
    "https://w3id.org/ro/terms/workflow-run/context": "workflow-run.jsonld",
}


def write_cache(path):
    """A cache of requests in which the contexts are."""
    with CachedSession(str(path), backend="sqlite", expire_after=-1) as session:
        for address, name in CONTEXTS.items():
            content = (Path(__file__).parent / "contexts" / name).read_bytes()
            request = CachedRequest.from_request(Request("GET", address).prepare())
            headers = {"Content-Type": "application/ld+json"}
            response = CachedResponse(
                request=request, url=address, status_code=200, headers=headers, content=content
            )
            session.cache.save_response(response)


def faults(crate, folder):
    """{message: severity} of what a crate lacks of all that the profile Workflow Run Crate requires and
    recommends, and those on which it is built. folder: for the cache."""
    write_cache(folder / "cache")
    settings = ValidationSettings(
        rocrate_uri=str(crate),
        profile_identifier="workflow-run-crate",
        requirement_severity=Severity.RECOMMENDED,
        offline=True,
        cache_path=str(folder / "cache"),
    )
    issues = services.validate(settings).get_issues()
    return {issue.message: issue.severity.name for issue in issues}
