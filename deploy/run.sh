#!/usr/bin/env bash
# Builds Tyndall and serves its page at http://127.0.0.1:8080.
#
#   deploy/run.sh [OPTIONS OF `tyndall serve`]
#
# Works on a fresh Debian 12/13 or Ubuntu 22.04/24.04 that has Rust: installs
# what is missing (and says so), builds the page and the server, starts it.
# Safe to run again; then only what changed is built.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=deploy/lib.sh
. deploy/lib.sh

require_rust
ensure_system_packages
ensure_node

if page_is_current; then
    say 'the page is built already (web/dist)'
else
    say 'building the page (web/)'
    npm_packages web || die 'the packages of the page could not be fetched: see the message of npm above (network?)'
    (cd web && npm run --silent build) || die 'the page did not build: see the message above'
fi

say 'building the server (release profile, several minutes the first time)'
fetch_crates
cargo build --release --locked -p tyndall || die 'the server did not build: see the message above'

ensure_runtime_dir
say 'starting; stop with Ctrl-C'
exec target/release/tyndall serve "$@"
