#!/usr/bin/env bash
# Tests of lib.sh: when the page has to be built.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=deploy/lib.sh
. deploy/lib.sh

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir -p web/src web/dist web/node_modules

# expect YES_OR_NO WHAT
expect() {
    local found=no
    if page_is_current; then
        found=yes
    fi
    [ "$found" = "$1" ] || die "$2: current is $found, expected $1"
}

echo 'let a' >web/src/a.ts
echo '{}' >web/package-lock.json
touch -d '1 hour ago' web/src/a.ts web/src web/package-lock.json
expect no 'no page is built'
touch web/dist/index.html
expect yes 'the page is newer than its sources'
touch -d '1 minute' web/node_modules/x web/dist/assets
expect yes 'what is fetched and built does not count'
touch -d '1 minute' web/src/a.ts
expect no 'a source is newer'
touch -d '1 hour ago' web/src/a.ts
expect yes 'the source is older again'
rm web/src/a.ts
touch -d '1 minute' web/src
expect no 'a source is gone'
echo 'lib.sh: 6 cases passed'
