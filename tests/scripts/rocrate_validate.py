"""Validates a bundle with roc-validator, without a network: `rocrate_validate.py BUNDLE.zip`. Prints what is wrong; exit code 1 if anything is.

The validator asks w3id.org for the JSON-LD context. Its requests are answered here with the context that the package `rocrate` brings, which is that of RO-Crate 1.3: every
term of our metadata is the same in 1.2.
"""

import importlib.resources
import sys

import requests
from rocrate_validator import services
from rocrate_validator.models import Severity, ValidationSettings

CONTEXT = "https://w3id.org/ro/crate/1.2/context"


def answer(_adapter, request, **_options):
    """Stands for the network: the context and nothing else."""
    if request.url != CONTEXT:
        raise requests.ConnectionError(f"no network: {request.url}")
    response = requests.Response()
    response.status_code = 200
    response.url, response.request = request.url, request
    response.headers["Content-Type"] = "application/ld+json"
    response._content = importlib.resources.files("rocrate").joinpath("data/ro-crate.jsonld").read_bytes()
    return response


def main():
    requests.adapters.HTTPAdapter.send = answer
    settings = ValidationSettings(
        rocrate_uri=sys.argv[1],
        profile_identifier="ro-crate-1.2",
        requirement_severity=Severity.REQUIRED if len(sys.argv) < 3 else Severity[sys.argv[2]],
        no_cache=True,
    )
    result = services.validate(settings)
    for issue in result.get_issues():
        print(f"{issue.severity.name}: {issue.message} ({issue.violatingEntity})")
    sys.exit(1 if result.has_issues() else 0)


main()
