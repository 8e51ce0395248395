#!/usr/bin/env bash
# Tries a running server's HTTP interface with requests made from its own description, right and wrong ones.
#
#   pip install schemathesis==4.32.5
#   deploy/check_api.sh http://127.0.0.1:8080 [OPTION...]      options of schemathesis run
#
# Not part of deploy/test.sh, as it takes minutes. Left out: the stream of events, which ends with its job
# only, and that whatever fits the schema is accepted, as scenes have rules that no schema can say.
set -euo pipefail

server=${1:?the address of a server, such as http://127.0.0.1:8080}
shift
exec schemathesis run "$server/openapi.json" \
    --exclude-path '/v1/jobs/{id}/events' --exclude-checks positive_data_acceptance \
    --max-examples 40 --request-timeout 15 "$@"
