"""The public validator of RO-Crates, without the network.

Its profiles are part of the package roc-validator. The two JSON-LD contexts to which a crate refers by their
addresses it finds in a cache of requests: here with the terms that our metadata use, and no others, so that
another term is undefined. Once a week CI validates an archive with the whole contexts of these addresses.
"""

import json

from requests import Request
from requests_cache import CachedRequest, CachedResponse, CachedSession
from rocrate_validator import services
from rocrate_validator.models import Severity, ValidationSettings

OF_SCHEMA = ["ComputerLanguage", "CreateAction", "CreativeWork", "Dataset", "Organization", "Person"]
OF_SCHEMA += ["SoftwareSourceCode", "about", "additionalType", "affiliation", "agent", "author"]
OF_SCHEMA += ["contentSize", "creator", "datePublished", "description", "encodingFormat", "endTime"]
OF_SCHEMA += ["exampleOfWork", "hasPart", "identifier", "instrument", "keywords", "license", "mainEntity"]
OF_SCHEMA += ["mentions", "name", "object", "programmingLanguage", "result", "startTime", "url"]
OF_SCHEMA += ["valueRequired", "version", "workExample"]
WORKFLOW = "https://bioschemas.org/ComputationalWorkflow"
CONTEXTS = {
    "https://w3id.org/ro/crate/1.1/context": {
        **{term: f"http://schema.org/{term}" for term in OF_SCHEMA},
        "File": "http://schema.org/MediaObject",
        "conformsTo": "http://purl.org/dc/terms/conformsTo",
        "ComputationalWorkflow": WORKFLOW,
        "FormalParameter": "https://bioschemas.org/FormalParameter",
        "input": f"{WORKFLOW}#input",
        "output": f"{WORKFLOW}#output",
    },
    "https://w3id.org/ro/terms/workflow-run/context": {
        "sha256": "https://w3id.org/ro/terms/workflow-run#sha256"
    },
}


def write_cache(path):
    """A cache of requests in which the contexts are."""
    with CachedSession(str(path), backend="sqlite", expire_after=-1) as session:
        for address, terms in CONTEXTS.items():
            request = CachedRequest.from_request(Request("GET", address).prepare())
            response = CachedResponse(
                request=request,
                url=address,
                status_code=200,
                headers={"Content-Type": "application/ld+json"},
                content=json.dumps({"@context": terms}).encode(),
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
